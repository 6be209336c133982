"""A design as the page shows it: one magnet in one place, through the design study's own functions.

While something is dragged :func:`at_once` tells what the error over a turn is at one temperature and speed; when it
rests, :func:`over_tolerances` gives what ``halltwin design`` writes of the same design, and :func:`error_map` the
designs around it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any

import numpy as np

from diagnosis.report.data import spectrum
from scenarios.commands.protocol import COLDEST_C, HOTTEST_C, Protocol
from scenarios.studies.design.field import Designs, cause_errors, errors_deg, in_designs, zeroed_deg
from scenarios.studies.design.space import AXES, TOLERANCES, Space
from scenarios.studies.design.study import (
    POINTS,
    Demand,
    DesignStudy,
    field_span,
    noise_deg,
    resolution_bits,
    stray_error_deg,
)
from twin.angles import Array
from twin.catalogue import find
from twin.chain import Chain
from twin.files import to_dict
from twin.limits import OutOfRangeError, require_within
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.mechanics.zero import ZERO
from twin.motion import NOMINAL_C, Motion
from twin.shown import shown
from twin.tables import from_table, to_table

ANGLES = 360
"""Angles of a turn at which the whole chain is computed while something is dragged."""
MOST_MOUNTINGS = 1000
_HIGHEST_ORDER = 12.0
_DIGITS = 5
_START = Demand(
    max_error_deg=0.5, window_mT=(30.0, 90.0), temperature_c=(-40.0, 125.0), tolerance={"off_axis": 0.3, "tilt": 1.0}
)
"""What ``halltwin design`` asks for unless told otherwise."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """One design, the temperature [C] and speed [rpm] at which it is looked at, and what it has to keep."""

    magnet: Magnet
    placement: Placement
    temperature_c: float = NOMINAL_C
    speed_rpm: float = 0.0
    demand: Demand = _START

    @property
    def designs(self) -> Designs:
        """The one design as the study takes it."""
        return Designs(self.magnet, self.placement)

    def to_dict(self) -> dict[str, Any]:
        """As the page holds it; every number, that of a default too."""
        return {
            "magnet": _numbers(self.magnet),
            "placement": _numbers(self.placement),
            "temperature_c": self.temperature_c,
            "speed_rpm": self.speed_rpm,
            "demand": {
                **{item.name: getattr(self.demand, item.name) for item in fields(Demand)},
                "tolerance": {name: self.demand.tolerance.get(name, 0.0) for name in TOLERANCES},
            },
        }


def _numbers(part: Any) -> dict[str, Any]:
    return {item.name: value for item in fields(part) if (value := getattr(part, item.name)) is not None}


def asked_at(assembly: Assembly) -> Asked:
    """The design that a twin file describes, with the usual demand."""
    return Asked(magnet=assembly.magnet, placement=assembly.placement)


def asked_of(content: Any) -> Asked:
    """The design of the page's values. Raises OutOfRangeError for an unknown name or a number out of range."""
    known = ("magnet", "placement", "temperature_c", "speed_rpm", "demand")
    if not isinstance(content, Mapping) or set(content) != set(known):
        raise OutOfRangeError(f"a design is {shown(content)}; expected {', '.join(known)}")
    for name, low, high, unit in (("temperature_c", COLDEST_C, HOTTEST_C, "C"), ("speed_rpm", 0.0, 1e5, "rpm")):
        require_within(name, _number(name, content[name]), low, high, unit)
    return Asked(
        magnet=from_table(Magnet, content["magnet"], "magnet"),
        placement=from_table(Placement, content["placement"], "placement"),
        temperature_c=float(content["temperature_c"]),
        speed_rpm=float(content["speed_rpm"]),
        demand=_demand_of(content["demand"]),
    )


def _demand_of(content: Any) -> Demand:
    """What a design has to keep. Raises OutOfRangeError."""
    names = [item.name for item in fields(Demand)]
    if not isinstance(content, Mapping) or set(content) != set(names):
        raise OutOfRangeError(f"demand is {shown(content)}; expected {', '.join(names)}")
    tolerance = content["tolerance"]
    if not isinstance(tolerance, Mapping) or not set(tolerance) <= set(TOLERANCES):
        raise OutOfRangeError(f"tolerance is {shown(tolerance)}; expected some of {', '.join(TOLERANCES)}")
    for name, value in tolerance.items():
        require_within(f"tolerance {name}", _number(name, value), 0.0, 100.0, TOLERANCES[name])
    require_within("max_error_deg", _number("max_error_deg", content["max_error_deg"]), 1e-6, 180.0, "deg")
    require_within("mountings", _number("mountings", content["mountings"]), 1, MOST_MOUNTINGS, whole=True)
    require_within("min_yield", _number("min_yield", content["min_yield"]), 0.0, 1.0)
    return Demand(
        max_error_deg=float(content["max_error_deg"]),
        window_mT=_span("window_mT", content["window_mT"], 0.0, 2000.0, "mT"),
        temperature_c=_span("demand.temperature_c", content["temperature_c"], COLDEST_C, HOTTEST_C, "C"),
        tolerance={name: float(value) for name, value in tolerance.items() if value > 0.0},
        mountings=int(content["mountings"]),
        min_yield=float(content["min_yield"]),
    )


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise OutOfRangeError(f"{name} is {shown(value)}; expected a number")
    return float(value)


def _span(name: str, value: Any, lower: float, upper: float, unit: str) -> tuple[float, float]:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise OutOfRangeError(f"{name} is {shown(value)}; expected two numbers, low and high")
    low, high = (_number(name, end) for end in value)
    require_within(name, [low, high], lower, upper, unit)
    if low > high:
        raise OutOfRangeError(f"{name} is {low:g} to {high:g} {unit}; expected the lower one first")
    return low, high


def at_once(chain: Chain, asked: Asked) -> dict[str, Any]:
    """The design at one temperature and speed, at 360 angles there and back: what follows the pointer."""
    designs = asked.designs
    own = in_designs(chain, designs)
    motion = _turns(asked, points=ANGLES, also_c=NOMINAL_C)
    here = motion.temperature_c == asked.temperature_c
    # One run for both the channels and what is read of them: the hand waits for it.
    *steps, last = own.steps(motion)
    channels = next(step.before for step in steps if step.key == "after channels")[0][:, here]
    error = zeroed_deg(own.error(motion, last.after[..., 0, :]), motion)[0][here]
    turn = _turns(asked, points=ANGLES, both_directions=False)
    field_mT = designs.channels(np.broadcast_to(turn.shaft_rad, (2, ANGLES)), turn)[0] * designs.nominal_mT[0]
    size_mT = np.hypot(*field_mT)
    low = size_mT.min(keepdims=True)
    noise = noise_deg(chain, low)
    order, amplitude = spectrum(_turns(asked, points=ANGLES), error, np.ones(error.size, dtype=bool), _HIGHEST_ORDER)
    whole = np.isclose(order, np.round(order))
    return {
        "forward_deg": _rounded(error[:ANGLES]),
        "backward_deg": _rounded(error[ANGLES:][::-1]),
        "orders": {"order": np.round(order[whole]).tolist(), "amplitude_deg": _rounded(amplitude[whole])},
        "field": {"x_mT": _rounded(field_mT[0]), "y_mT": _rounded(field_mT[1]), "size_mT": _rounded(size_mT)},
        "signals": dict(zip(("x", "y"), map(_rounded, channels[:, :ANGLES]), strict=True)),
        "figures": {
            "error_deg": _largest(error),
            "rms_deg": float(np.sqrt(np.mean(error**2))),
            "field_mT": float(designs.nominal_mT[0]),
            "field_low_mT": float(low[0]),
            "field_high_mT": float(size_mT.max()),
            "noise_deg": float(noise[0]),
            "resolution_bits": float(resolution_bits(noise)[0]) if noise[0] > 0.0 else None,
            "stray_error_deg": float(stray_error_deg(low)[0]),
        },
    }


def _turns(asked: Asked, *, points: int, also_c: float | None = None, both_directions: bool = True) -> Motion:
    """A turn, there and back, at the temperature looked at, and at that of the calibration beside it."""
    temperatures = {asked.temperature_c} | (set() if also_c is None else {also_c})
    return _motion(
        Protocol(
            points=points,
            both_directions=both_directions,
            temperatures_c=tuple(sorted(temperatures)),
            speeds_rpm=(asked.speed_rpm,),
        )
    )


def _over_temperature(asked: Asked) -> Motion:
    """A turn there and back at each temperature asked for, as the study has it, at the speed that is looked at."""
    return _motion(
        Protocol(
            points=POINTS,
            both_directions=True,
            temperatures_c=asked.demand.temperatures,
            speeds_rpm=(asked.speed_rpm,),
        )
    )


@lru_cache(maxsize=16)
def _motion(protocol: Protocol) -> Motion:
    """The protocol's motion: what is dragged is mostly none of it."""
    return protocol.motion()


def alone(chain: Chain, asked: Asked) -> dict[str, float]:
    """The largest error [deg] of each cause alone, over the temperatures asked for."""
    return {name: _largest(error) for name, error in cause_errors(chain, asked.designs, _over_temperature(asked))}


def study_of(chain: Chain, demand: Demand) -> DesignStudy:
    """The study that ``halltwin design`` would make of one design."""
    return DesignStudy(
        twin=to_dict(chain), space=Space(axes=dict.fromkeys(AXES, (0.0,))), demand=demand, chunk=1, seed=0
    )


def over_tolerances(study: DesignStudy, asked: Asked) -> dict[str, Any]:
    """What the study tells of the design: over temperature and mountings, and what is left without each cause."""
    designs, motion = asked.designs, _over_temperature(asked)
    figures = study.figures(designs, np.array([0]))
    return {
        "figures": {name: float(column[0]) for name, column in figures.items()},
        "alone_deg": alone(study.chain, asked),
        "all_deg": _largest(errors_deg(study.chain, designs, motion)),
        "without_deg": {name: _largest(error) for name, error in taken_out(study.chain, designs, motion)},
    }


def taken_out(chain: Chain, designs: Designs, motion: Motion) -> Iterator[tuple[str, Array]]:
    """Each cause, and the error (designs, n) [deg] that is left where it is taken out and all else stays."""
    placed = designs.placement
    ideal = Placement(**{name: value for name, value in _numbers(placed).items() if name == "air_gap_mm"})
    yield "field", errors_deg(chain, Designs(designs.magnet, ideal), motion)
    for name in [part.name for part in chain.described]:
        yield name, errors_deg(replace(chain, parts=chain.parts.without(name)), designs, motion)
    for key, params in chain.values.items():
        effect = find(key, chain.effects)
        if effect is ZERO or effect.footprint == "spread" or effect.is_null(params):
            continue
        yield key, errors_deg(chain.without(key), designs, motion)


def error_map(chain: Chain, asked: Asked, sizes_mm: Array, gaps_mm: Array) -> dict[str, Any]:
    """Error and field of magnets (sizes,) at air gaps (gaps,), all else as in the design: largest over temperature."""
    designs = _around(asked, sizes_mm, gaps_mm)
    error = np.max(np.abs(errors_deg(chain, designs, asked.demand.motion(POINTS))), axis=1)
    return _mapped(asked, sizes_mm, gaps_mm, designs, error_deg=error)


def yield_map(study: DesignStudy, asked: Asked, sizes_mm: Array, gaps_mm: Array) -> dict[str, Any]:
    """Share of mountings that keep error and window, of magnets (sizes,) at air gaps (gaps,), all mounted alike.

    The same mountings are drawn for each: neighbours differ by what they are, not by the draw.
    """
    designs = _around(asked, sizes_mm, gaps_mm)
    share = study.over_mountings(designs, np.zeros(sizes_mm.size * gaps_mm.size, dtype=np.int64))["yield"]
    return _mapped(asked, sizes_mm, gaps_mm, designs, **{"yield": share})


def _around(asked: Asked, sizes_mm: Array, gaps_mm: Array) -> Designs:
    """Magnets of these sizes at these air gaps (gaps x sizes,), all else as in the design."""
    size, gap = (part.ravel() for part in np.meshgrid(sizes_mm, gaps_mm))
    sized: dict[str, Any] = dict.fromkeys(sizes_of(asked.magnet), size)
    return Designs(replace(asked.magnet, **sized), replace(asked.placement, air_gap_mm=gap))


def _mapped(asked: Asked, sizes_mm: Array, gaps_mm: Array, designs: Designs, **columns: Array) -> dict[str, Any]:
    """Columns of designs as a map (gaps, sizes), with the span of the field."""
    low, high = field_span(designs, asked.demand)
    shape = (gaps_mm.size, sizes_mm.size)
    shown_as_map = {**columns, "field_low_mT": low, "field_high_mT": high}
    return {
        "size_mm": _rounded(sizes_mm),
        "air_gap_mm": _rounded(gaps_mm),
        **{name: _rounded(column.reshape(shape)) for name, column in shown_as_map.items()},
    }


def sizes_of(magnet: Magnet) -> tuple[str, ...]:
    """The numbers that one size of a magnet stands for: its diameter, or both sides of a block."""
    return ("length_mm", "width_mm") if magnet.shape == "block" else ("diameter_mm",)


def command_of(asked: Asked, *, sensor: str) -> str | None:
    """The command line that computes the same design; None where its options cannot say how it is mounted."""
    import shlex

    magnet, placed, demand = asked.magnet, to_table(asked.placement), asked.demand
    side = magnet.length_mm if magnet.shape == "block" else magnet.diameter_mm
    options = {
        "off-axis": placed.pop("sensor_x_mm", 0.0),
        "tilt": placed.pop("sensor_tilt_y_deg", 0.0),
        "magnet-off-axis": placed.pop("magnet_x_mm", 0.0),
        "magnet-tilt": placed.pop("magnet_tilt_y_deg", 0.0),
        "stray": placed.pop("stray_x_mT", 0.0),
    }
    placed.pop("air_gap_mm", None)
    uneven_block = magnet.shape == "block" and magnet.length_mm != magnet.width_mm
    if placed or uneven_block or magnet.percent_per_K is not None:
        return None
    size = {"diameter": side, "height": magnet.height_mm, "air-gap": asked.placement.air_gap_mm}
    words = ["halltwin", "design", "--twin", sensor, "--shape", magnet.shape, "--grade", magnet.grade]
    words += [f"--{name}={value!r}" for name, value in {**size, **options}.items() if value or name in size]
    words += [] if magnet.remanence_T is None else [f"--remanence={magnet.remanence_T!r}"]
    words += [f"--bore={magnet.bore_mm!r}"] if magnet.shape == "ring" else []
    tolerance = ", ".join(f"{name}={value!r}{TOLERANCES[name]}" for name, value in demand.tolerance.items())
    words += [f"--max-error={demand.max_error_deg!r}", f"--tolerance={tolerance}"]
    words += ["--window={!r}:{!r}".format(*demand.window_mT), "--temperature={!r}:{!r}".format(*demand.temperature_c)]
    words += [f"--mountings={demand.mountings}", f"--min-yield={demand.min_yield!r}"]
    return shlex.join(words)


def _rounded(values: Array) -> Any:
    """Values for the page's pictures, to as many digits as anyone sees."""
    return np.round(values, _DIGITS).tolist()


def _largest(error: Array) -> float:
    return float(np.max(np.abs(error)))
