"""Draw a simulated sweep with known hidden causes.

    hidden = draw(["hysteresis"], seed=3, bench="hard")
    hidden.write_csv("sweep.csv")

The same arguments give the same sweep on every machine. Independent of the simulator under test:
numpy and the standard library only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from . import baseline as baselines
from . import noise as noises
from . import protocols, structures
from .baseline import Injected, Setting
from .catalogue import CAUSES
from .chain import Bench, Readings, sample
from .clearance import clearance_sigma
from .motion import Array, Demands, Motion
from .noise import Noise
from .streams import stream

STRENGTHS = {"normal": (0.05, 0.15), "weak": (0.012, 0.04)}
"""Range of strengths, degrees."""
GRID_CAUSE = 0.5
"""Rounding is a cause where step / sqrt(12) exceeds this share of what is left otherwise."""


@dataclass(frozen=True)
class Hidden:
    """A sweep file's columns and what is hidden in it."""

    columns: dict[str, Array]
    """In the order of the file; shape (n,) each, NaN where a cell is empty."""
    truth: dict[str, object]

    def write_csv(self, path: str | Path) -> None:
        """Write the sweep file."""
        cells = [["" if np.isnan(v) else f"{v:.6f}" for v in values] for values in self.columns.values()]
        lines = [",".join(self.columns), *(",".join(row) for row in zip(*cells, strict=True))]
        Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def draw(
    causes: Sequence[str],
    *,
    seed: int,
    bench: str = "easy",
    strength: str = "normal",
    protocol: str | None = None,
    structure: str | None = None,
    remeasured: Motion | None = None,
    strength_deg: float | None = None,
) -> Hidden:
    """A sweep with the named causes, and with a structure outside the catalogue if one is asked for.

    `protocol` is one of protocols.PROTOCOLS, "+channels" or "-channels" appended to force vx, vy in
    or out; without it one is drawn that shows all the causes. ValueError where none does. `remeasured`
    is another motion of the same device and bench: its sweep has every column that belongs to it.
    `strength_deg` is given to every cause in place of one drawn from the range; all else stays as it is.
    """
    labels = sorted(causes)
    key = "+".join([*labels, structure or "", bench, strength])
    for name in labels:
        if name not in CAUSES:
            raise ValueError(f"cause must be one of {sorted(CAUSES)}; instead received {name!r}")
    if len(set(labels)) != len(labels):
        raise ValueError(f"causes must differ; instead received {labels}")
    if structure is not None and structure not in structures.STRUCTURES:
        raise ValueError(f"structure must be one of {sorted(structures.STRUCTURES)}; got {structure!r}")
    if bench not in ("easy", "hard") or strength not in STRENGTHS:
        raise ValueError(f"bench is easy or hard, strength normal or weak; got {bench!r}, {strength!r}")

    asked, _, forced = (protocol or "").partition("+")
    if not forced:
        asked, _, barred = asked.partition("-")
    else:
        barred = ""
    suitable = suitable_protocols(labels, structure)
    if asked:
        if asked not in protocols.PROTOCOLS:
            raise ValueError(f"protocol must be one of {sorted(protocols.PROTOCOLS)}; instead received {asked!r}")
        chosen = asked
    elif suitable:
        chosen = protocols.choose(stream(seed, key, "protocol"), suitable)
    else:
        raise ValueError(f"no protocol shows all of {labels} and {structure}")

    demands = demanded(labels, structure, bench)
    motion = protocols.drive(chosen, stream(seed, key, "motion"), bench=bench, demands=demands)
    own = baselines.choose(stream(seed, key, "baseline"), bench=bench)
    rng = stream(seed, key, "bench")
    noise = noises.choose(rng, bench=bench, repeats=motion.repeats)
    channels = bool(demands.channels or rng.random() < 0.25)
    channels = bool(forced) or (channels and not barred)
    setting = Setting(motion, own, noise, _bits(rng, bench, noise, labels), strength == "weak")

    injected = [_settle(name, stream(seed, key, "cause", name), setting, strength_deg) for name in labels]
    if structure is not None:
        one = stream(seed, key, "structure", structure)
        size = float(one.uniform(*STRENGTHS[strength]))
        injected.append(structures.plan(structure, one, size, setting))
    if remeasured is not None:
        motion = remeasured
    by_name = {entry.name: entry for entry in injected}
    bits, step = setting.output_bits, setting.word_deg
    if "output_quantisation" in by_name:
        bits = int(by_name["output_quantisation"].parameters["bits"])
        step = 360.0 / 2**bits
        # the definition asks that rounding rule over what is left otherwise
        noise = replace(noise, sigma_deg=min(noise.sigma_deg, step / np.sqrt(12.0) / (1.6 * GRID_CAUSE)))
    scale, grid = _channel_unit(rng, bench, by_name.get("adc_stuck_bit"))
    setup = Bench(motion, own, noise, bits, channels, scale, grid)
    readings = sample(setup, injected, stream(seed, key, "noise"))
    if remeasured is None:
        columns = _columns(setup, readings, demands, bench, stream(seed, key, "columns"))
    else:
        columns = _all_columns(setup, readings)

    truth: dict[str, object] = {
        "causes": [*labels, *(["unnamed"] if structure is not None else [])],
        "tolerated": _tolerated(setup, labels),
        "strength_deg": {entry.name: entry.strength_deg for entry in injected},
        "parameters": {entry.name: dict(entry.parameters) for entry in injected},
        "clearance_sigma": {entry.name: clearance_sigma(setup, injected, entry.name) for entry in injected},
        "noise_deg": noise.sigma_deg,
        "noise_kind": noise.kind,
        "noise_correlation": noise.correlation,
        "floor_deg": float(np.hypot(np.std(readings.noise_deg), step / np.sqrt(12.0))),
        "output_bits": bits,
        "baseline": own.parameters(),
        "frame": _frame(own, motion, columns),
        "protocol": chosen,
        "channels": channels,
        "bench": bench,
        "strength": strength,
        "structure": structure,
        "seed": seed,
        "rows": len(motion.time_s),
        "turns": len(motion.time_s) / (motion.points_per_turn * motion.repeats),
        "points_per_turn": motion.points_per_turn,
        "repeats": motion.repeats,
    }
    return Hidden(columns, truth)


def _frame(own: baselines.Baseline, motion: Motion, columns: dict[str, Array]) -> dict[str, float]:
    """What the truth needs to be told in another convention: the scale, the first reading, the record's length."""
    return {
        "amplitude_x": own.amplitude_x,
        "first_time_s": float(motion.time_s[0]),
        "first_reference_deg": float(columns["reference_deg"][0]),
        "duration_s": float(np.ptp(motion.time_s)),
    }


def suitable_protocols(labels: Sequence[str], structure: str | None = None) -> tuple[str, ...]:
    """Protocols in which every cause and the structure can be seen."""
    lists = [CAUSES[name].protocols for name in labels]
    if structure is not None:
        lists.append(structures.STRUCTURES[structure].protocols)
    return tuple(one for one in protocols.PROTOCOLS if all(one in names for names in lists))


def demanded(labels: Sequence[str], structure: str | None, bench: str) -> Demands:
    """All that the causes and the structure ask of the sweep."""
    demands = Demands()
    for name in labels:
        demands |= CAUSES[name].demands
        if bench == "easy":
            demands |= CAUSES[name].easy_demands
    if structure is not None:
        demands |= structures.STRUCTURES[structure].demands
    return demands


def _settle(name: str, rng: np.random.Generator, setting: Setting, strength_deg: float | None) -> Injected:
    drawn = float(rng.uniform(*STRENGTHS["weak" if setting.weak else "normal"]))
    return CAUSES[name].plan(rng, drawn if strength_deg is None else strength_deg, setting)


def _bits(rng: np.random.Generator, bench: str, noise: Noise, labels: Sequence[str]) -> int:
    """Bits of the angle word where rounding is not the cause."""
    fine = rng.random() < 0.75
    if "cordic_truncation" in labels:
        # a coarse word would leave nothing of the set of angles to see
        return 14 if bench == "hard" else 16
    if bench == "hard":
        return 12
    small = 360.0 / 2**14 / np.sqrt(12.0) < 0.7 * GRID_CAUSE * noise.sigma_deg
    return 14 if small and not fine else 16


def _tolerated(setup: Bench, labels: Sequence[str]) -> list[str]:
    """Names that are right to give and right to leave out."""
    rounding = 360.0 / 2**setup.output_bits / np.sqrt(12.0)
    near = rounding > 0.8 * GRID_CAUSE * setup.noise.sigma_deg
    return ["output_quantisation"] if near and "output_quantisation" not in labels else []


def _channel_unit(rng: np.random.Generator, bench: str, stuck: Injected | None) -> tuple[float, float]:
    """Recorded unit over nominal amplitude, and its step."""
    if stuck is not None:
        # what is recorded are the codes of that converter, as they are or as multiples of the amplitude
        step = float(2.0 * stuck.hidden["full_scale"][0] / 2.0 ** stuck.hidden["bits"][0])
        return (1.0, step) if bench == "easy" or rng.random() < 0.5 else (1.0 / step, 1.0)
    if bench == "easy" or rng.random() < 0.5:
        return 1.0, 2.0**-15
    unit = int(rng.integers(0, 3))
    # volts at 16 bits, counts of a 16-bit converter, millitesla in microtesla
    return ((1.65, 3.3 / 2**16), (24000.0, 1.0), (48.0, 1e-3))[unit]


def _all_columns(setup: Bench, readings: Readings) -> dict[str, Array]:
    """Every column that the motion has something to say in."""
    motion = setup.motion
    columns = {"time_s": motion.time_s, "reference_deg": readings.reference_deg, "measured_deg": readings.word_deg}
    columns |= {"direction": motion.direction, "turn": motion.turn.astype(float)}
    if motion.moving:
        columns["speed_rpm"] = motion.speed_rpm
    if np.ptp(motion.temperature_c) > 0:
        columns["temperature_c"] = motion.temperature_c
    return columns | ({"vx": readings.x, "vy": readings.y} if setup.channels else {})


def _columns(
    setup: Bench, readings: Readings, demands: Demands, bench: str, rng: np.random.Generator
) -> dict[str, Array]:
    """The columns a bench of this kind writes down; redundant ones are left out at times."""
    motion = setup.motion
    hard = bench == "hard"
    omit = 0.5 if hard else 0.1
    columns: dict[str, Array] = {}
    if motion.moving or demands.time_column or not hard or rng.random() < 0.8:
        columns["time_s"] = motion.time_s
    wrapped = rng.random() < (0.6 if hard else 0.8)
    read = readings.reference_deg
    columns["reference_deg"] = np.mod(read, 360.0) if wrapped else read
    signed = hard and rng.random() < 0.3
    word = readings.word_deg
    columns["measured_deg"] = np.where(word >= 180.0, word - 360.0, word) if signed else word

    both = bool(np.ptp(motion.direction) > 0)
    several = len(np.unique(np.abs(motion.speed_rpm))) > 1
    if both and not rng.random() < omit:
        columns["direction"] = motion.direction
    if motion.moving and not rng.random() < omit * (1.0 if several else 1.5):
        columns["speed_rpm"] = motion.speed_rpm
    heated = bool(np.ptp(motion.temperature_c) > 0)
    if demands.turn_column or heated or rng.random() < (0.25 if hard else 0.3):
        columns["turn"] = motion.turn.astype(float)
    if heated:
        columns["temperature_c"] = motion.temperature_c
    elif hard and rng.random() < 0.2:
        # a warm room: slow, small, and nothing to do with the readings
        share = np.linspace(0.0, 1.0, len(motion.time_s))
        columns["temperature_c"] = np.round(22.0 + 3.0 * rng.random() + rng.uniform(-1.5, 1.5) * share, 1)
    if hard and "temperature_c" in columns:
        warm = columns["temperature_c"].copy()
        if heated and rng.random() < 0.5:
            warm = np.round(warm + 0.15 * rng.standard_normal(len(warm)), 1)
        if rng.random() < 0.6:
            warm[rng.random(len(warm)) < rng.uniform(0.01, 0.1)] = np.nan
        columns["temperature_c"] = warm
    if setup.channels:
        columns["vx"], columns["vy"] = readings.x, readings.y
    return columns
