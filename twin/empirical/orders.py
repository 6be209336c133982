"""Unnamed lines over the shaft angle: free orders, and low orders that scale with a condition."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from twin.angles import Array, radians
from twin.effect import BoolArray, Comb, Effect, Forward, Line, Param, Parameters
from twin.found_by import order_of
from twin.motion import NOMINAL_C, RPM, Motion

Weight = Callable[[Motion, Parameters], Array]

_AT_K = Param(
    unit="K", null=100.0, lower=1e-9, upper=1e4, role="shape", doc="distance from 25 C at which the size is stated"
)
_AT_RPM = Param(unit="rpm", null=1000.0, lower=1e-9, upper=1e7, role="shape", doc="speed at which the size is stated")

_LINE_WORDS = "order {order:4} in the shaft angle (cycles per turn), amplitude {amplitude_deg} deg"
_DIRECTION_WORDS = "order {order:4} whose sign turns with the direction, amplitude {amplitude_deg} deg"
_TEMPERATURE_WORDS = (
    "order {order:4} that scales with temperature, amplitude {amplitude_deg} deg at the one farthest from 25 C"
)
_SPEED_WORDS = "order {order:4} that scales with speed, amplitude {amplitude_deg} deg at the highest one"


def _order_params(highest: float) -> dict[str, Param]:
    return {
        "order": Param(unit="1/turn", null=0.0, lower=0.0, upper=highest, doc="cycles per turn", role="shape"),
        "amplitude_deg": Param(unit="deg", null=0.0, lower=0.0, upper=90.0, doc="amplitude"),
        "phase_deg": Param(unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase", role="phase"),
    }


def _weighted(weight: Weight) -> Forward:
    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        wave = np.sin(np.asarray(values["order"]) * motion.shaft_rad + radians(values["phase_deg"]))
        return signal + radians(values["amplitude_deg"]) * weight(motion, values) * wave

    return forward


def _always(motion: Motion, values: Parameters) -> Array:
    return np.ones(len(motion))


def _direction(motion: Motion, values: Parameters) -> Array:
    return motion.direction


def _temperature(motion: Motion, values: Parameters) -> Array:
    return np.asarray((motion.temperature_c - NOMINAL_C) / np.asarray(values["at_K"]))


def _speed(motion: Motion, values: Parameters) -> Array:
    pace = motion.speed_rad_s / (RPM * np.asarray(values["at_rpm"]))
    power = np.asarray(values["power"])
    return np.asarray(
        np.where(
            power == 2.0,
            pace * np.abs(pace),
            np.where(power == -2.0, pace**2, np.where(power == -1.0, np.abs(pace), pace)),
        )
    )


def _farthest(motion: Motion) -> float:
    """Largest distance of a record's temperatures from that at which there is no drift, kelvin."""
    return max(float(np.max(np.abs(motion.temperature_c - NOMINAL_C))), 1e-9)


def _fastest(motion: Motion) -> float:
    """Highest speed of a record, rpm."""
    return max(float(np.max(np.abs(motion.speed_rad_s))) / RPM, 1e-9)


def _free_limits(motion: Motion) -> tuple[float, float]:
    return 0.55, motion.points_per_turn / 2.0


def unnamed_order(order: Array) -> BoolArray:
    """Orders (any shape) from 9 upwards, and what is not whole: below, each whole one has a cause."""
    whole = np.abs(order - np.round(order)) < 1e-9
    return np.asarray(np.where(whole, order >= 9, order > 0.55))


def _low_orders(
    orders: Sequence[int], extra: Sequence[Mapping[str, float]] = ({},)
) -> Callable[[Motion], Sequence[Mapping[str, float]]]:
    def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
        return [{"order": float(k), **more} for more in extra for k in orders if 2 * k < motion.angles_in_a_turn]

    return shapes


def _speed_shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    # Orders 0 and 2 times the signed speed are latency and xy_skew.
    fast = {"at_rpm": _fastest(motion)}
    plain = _low_orders((1, 3, 4), [{"power": 1.0, **fast}])(motion)
    bent = _low_orders((1, 2, 3, 4), [{"power": power, **fast} for power in (-1.0, 2.0, -2.0)])(motion)
    return [*plain, *bent]


def _one_pattern(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"at_K": _farthest(motion)}]


def _orders_of_temperature(motion: Motion) -> Sequence[Mapping[str, float]]:
    return _low_orders(range(3, HIGHEST_SINGLE_ORDER + 1), [{"at_K": _farthest(motion)}])(motion)


UNNAMED_ORDER = Effect(
    name="unnamed_order",
    stage="empirical",
    acts_on="angle",
    params=_order_params(1e5),
    forward=_weighted(_always),
    line=Line(param="order", clock="shaft", limits=_free_limits, within=unnamed_order),
    comb=Comb(orders=order_of),
    needs=frozenset({"one turn"}),
    repeatable=True,
    kind="order",
    words=_LINE_WORDS,
    source="Fourier component",
    signature="a line at an order that no cause sets",
)


def _pattern_params(orders: Sequence[int], times: str) -> dict[str, Param]:
    return {
        f"{wave}{k}_deg": Param(
            unit="deg", null=0.0, lower=-90.0, upper=90.0, doc=f"{wave} of order {k}, times {times}"
        )
        for k in orders
        for wave in (("cos", "sin") if k else ("cos",))
    }


def _pattern(orders: Sequence[int], weight: Weight) -> Forward:
    """A Fourier series over the shaft angle that scales with a condition."""

    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        pattern: Array = np.zeros(len(motion))
        for k in orders:
            pattern = pattern + radians(values[f"cos{k}_deg"]) * np.cos(k * motion.shaft_rad)
            if k:
                pattern = pattern + radians(values[f"sin{k}_deg"]) * np.sin(k * motion.shaft_rad)
        return signal + weight(motion, values) * pattern

    return forward


def _strongest(orders: Sequence[int]) -> Callable[[Parameters], Mapping[str, float]]:
    """A pattern of several orders is described by its strongest one."""

    def figures(values: Parameters) -> Mapping[str, float]:
        sizes = {k: float(np.hypot(values[f"cos{k}_deg"], values.get(f"sin{k}_deg", 0.0))) for k in orders}
        strongest = max(sizes, key=lambda k: sizes[k])
        return {"order": float(strongest), "amplitude_deg": sizes[strongest]}

    return figures


DIRECTION_ORDERS = (1, 2, 3, 4)
# Orders 1 and 2 times the temperature are the drifts of offset, gain and phase, order 0 alone that of the zero.
TEMPERATURE_ORDERS = (0, 3, 4, 5, 6)
HIGHEST_SINGLE_ORDER = 40

UNNAMED_DIRECTION = Effect(
    name="unnamed_direction",
    stage="empirical",
    acts_on="angle",
    params=_pattern_params(DIRECTION_ORDERS, "d"),
    forward=_pattern(DIRECTION_ORDERS, _direction),
    needs=frozenset({"both directions"}),
    repeatable=True,
    kind="direction",
    words=_DIRECTION_WORDS,
    figures=_strongest(DIRECTION_ORDERS),
    source="Fourier series times the direction",
    signature="a pattern over the turn whose sign turns with the direction",
)

UNNAMED_TEMPERATURE = Effect(
    name="unnamed_temperature",
    stage="empirical",
    acts_on="angle",
    params={**_pattern_params(TEMPERATURE_ORDERS, "(T - 25 C) / at_K"), "at_K": _AT_K},
    forward=_pattern(TEMPERATURE_ORDERS, _temperature),
    shapes=_one_pattern,
    needs=frozenset({"temperature_c", "two temperatures"}),
    repeatable=True,
    kind="temperature",
    words=_TEMPERATURE_WORDS,
    figures=_strongest(TEMPERATURE_ORDERS),
    source="Fourier series times (T - 25 C)",
    signature="a pattern over the turn that scales with temperature; its size is the one farthest from 25 C",
)


UNNAMED_DIRECTION_ORDER = Effect(
    name="unnamed_direction_order",
    stage="empirical",
    acts_on="angle",
    params=_order_params(HIGHEST_SINGLE_ORDER),
    forward=_weighted(_direction),
    shapes=_low_orders(range(1, HIGHEST_SINGLE_ORDER + 1)),
    needs=frozenset({"both directions"}),
    repeatable=True,
    kind="direction",
    words=_DIRECTION_WORDS,
    source="Fourier component times the direction",
    signature="one order whose sign turns with the direction",
)

UNNAMED_TEMPERATURE_ORDER = Effect(
    name="unnamed_temperature_order",
    stage="empirical",
    acts_on="angle",
    params={**_order_params(HIGHEST_SINGLE_ORDER), "at_K": _AT_K},
    forward=_weighted(_temperature),
    shapes=_orders_of_temperature,
    needs=frozenset({"temperature_c", "two temperatures"}),
    repeatable=True,
    kind="temperature",
    words=_TEMPERATURE_WORDS,
    source="Fourier component times (T - 25 C)",
    signature="one order that scales with temperature; its amplitude is the one farthest from 25 C",
)

UNNAMED_SPEED = Effect(
    name="unnamed_speed",
    stage="empirical",
    acts_on="angle",
    params={
        **_order_params(64.0),
        "at_rpm": _AT_RPM,
        "power": Param(unit="1", null=1.0, lower=-2.0, upper=2.0, role="shape", doc="1: w, -1: |w|, 2: w|w|, -2: w^2"),
    },
    forward=_weighted(_speed),
    shapes=_speed_shapes,
    # At two speeds a torque, whose response falls with the speed, and a constant order make any order that follows it.
    needs=frozenset({"moving shaft", "two speeds", "a reference|three speeds"}),
    repeatable=True,
    kind="speed",
    words=_SPEED_WORDS,
    source="Fourier component times a power of the speed",
    signature="a low order that scales with speed; its amplitude is the one at the highest speed",
)


def _moved_by_speed(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal + radians(values["amplitude_deg"]) * _speed(motion, values)


def _powers(motion: Motion) -> Sequence[Mapping[str, float]]:
    # As the signed speed goes a latency.
    return [{"power": power, "at_rpm": _fastest(motion)} for power in (-1.0, 2.0, -2.0)]


UNNAMED_SPEED_ZERO = Effect(
    name="unnamed_speed_zero",
    stage="empirical",
    # Where the zero moves with the speed it is the shaft that twists: the other errors move along.
    acts_on="shaft",
    params={
        "amplitude_deg": Param(
            unit="deg", null=0.0, lower=-90.0, upper=90.0, doc="turn of the zero at the stated speed", owner="bench"
        ),
        **{name: replace(UNNAMED_SPEED.params[name], owner="bench") for name in ("at_rpm", "power")},
    },
    forward=_moved_by_speed,
    shapes=_powers,
    needs=frozenset({"moving shaft", "two speeds", "a reference"}),
    repeatable=True,
    kind="speed",
    words="the zero moves with the speed, {amplitude_deg} deg at the highest one",
    figures=lambda values: {"order": 0.0},
    source="power of the speed",
    signature="order 0 that scales with speed; its size is the one at the highest speed",
)
