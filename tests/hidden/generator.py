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
from .columns import all_columns, written_columns
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


@dataclass(frozen=True)
class Asked:
    """What a draw is asked for; its parts draw from streams of their own, which depend on nothing else."""

    causes: tuple[str, ...]
    structure: str | None
    bench: str
    strength: str
    seed: int

    def stream(self, *names: str) -> np.random.Generator:
        """The stream of one part of the draw."""
        key = "+".join([*self.causes, self.structure or "", self.bench, self.strength])
        return stream(self.seed, key, *names)

    def check(self) -> None:
        """Refuse what there is not. Raises ValueError."""
        for name in self.causes:
            if name not in CAUSES:
                raise ValueError(f"cause must be one of {sorted(CAUSES)}; instead received {name!r}")
        if len(set(self.causes)) != len(self.causes):
            raise ValueError(f"causes must differ; instead received {list(self.causes)}")
        if self.structure is not None and self.structure not in structures.STRUCTURES:
            raise ValueError(f"structure must be one of {sorted(structures.STRUCTURES)}; got {self.structure!r}")
        if self.bench not in ("easy", "hard") or self.strength not in STRENGTHS:
            raise ValueError(f"bench is easy or hard, strength normal or weak; got {self.bench!r}, {self.strength!r}")


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
    asked = Asked(tuple(sorted(causes)), structure, bench, strength, seed)
    asked.check()
    chosen, with_channels = _protocol(protocol or "", asked)
    demands = demanded(asked.causes, structure, bench)
    motion = protocols.drive(chosen, asked.stream("motion"), bench=bench, demands=demands)
    own = baselines.choose(asked.stream("baseline"), bench=bench)
    rng = asked.stream("bench")
    noise = noises.choose(rng, bench=bench, repeats=motion.repeats)
    channels = bool(demands.channels or rng.random() < 0.25)
    channels = channels if with_channels is None else with_channels
    setting = Setting(motion, own, noise, _bits(rng, bench, noise, asked.causes), strength == "weak")

    injected = [_settle(name, asked.stream("cause", name), setting, strength_deg) for name in asked.causes]
    if structure is not None:
        one = asked.stream("structure", structure)
        size = float(one.uniform(*STRENGTHS[strength]))
        injected.append(structures.plan(structure, one, size, setting))
    by_name = {entry.name: entry for entry in injected}
    bits = setting.output_bits
    if "output_quantisation" in by_name:
        bits = int(by_name["output_quantisation"].parameters["bits"])
        # the definition asks that rounding rule over what is left otherwise
        most = 360.0 / 2**bits / np.sqrt(12.0) / (1.6 * GRID_CAUSE)
        noise = replace(noise, sigma_deg=min(noise.sigma_deg, most))
    scale, grid = _channel_unit(rng, bench, by_name.get("adc_stuck_bit"))
    setup = Bench(motion if remeasured is None else remeasured, own, noise, bits, channels, scale, grid)
    readings = sample(setup, injected, asked.stream("noise"))
    if remeasured is None:
        columns = written_columns(setup, readings, demands, bench, asked.stream("columns"))
        columns |= {name: one.hidden[name] for one in injected for name in ("current_a",) if name in one.hidden}
    else:
        columns = all_columns(setup, readings)
    truth = _truth(asked, setup, injected, protocol=chosen, readings=readings, reference_deg=columns["reference_deg"])
    return Hidden(columns, truth)


def _protocol(named: str, asked: Asked) -> tuple[str, bool | None]:
    """The protocol, named or drawn, and whether its name forces the channels in or out."""
    name, plus, _ = named.partition("+")
    name, minus, _ = name.partition("-")
    suitable = suitable_protocols(asked.causes, asked.structure)
    if name and name not in protocols.PROTOCOLS:
        raise ValueError(f"protocol must be one of {sorted(protocols.PROTOCOLS)}; instead received {name!r}")
    if not name and not suitable:
        raise ValueError(f"no protocol shows all of {list(asked.causes)} and {asked.structure}")
    chosen = name or protocols.choose(asked.stream("protocol"), suitable)
    return chosen, True if plus else False if minus else None


def _truth(
    asked: Asked,
    setup: Bench,
    injected: list[Injected],
    *,
    protocol: str,
    readings: Readings,
    reference_deg: Array,
) -> dict[str, object]:
    """What is hidden in the sweep, and all that the bench has done."""
    motion, step = setup.motion, 360.0 / 2**setup.output_bits
    return {
        "causes": [*asked.causes, *(["unnamed"] if asked.structure is not None else [])],
        "tolerated": _tolerated(setup, asked.causes),
        "strength_deg": {entry.name: entry.strength_deg for entry in injected},
        "parameters": {entry.name: dict(entry.parameters) for entry in injected},
        "clearance_sigma": {entry.name: clearance_sigma(setup, injected, entry.name) for entry in injected},
        "noise_deg": setup.noise.sigma_deg,
        "noise_kind": setup.noise.kind,
        "noise_correlation": setup.noise.correlation,
        "floor_deg": float(np.hypot(np.std(readings.noise_deg), step / np.sqrt(12.0))),
        "output_bits": setup.output_bits,
        "baseline": setup.baseline.parameters(),
        "frame": _frame(setup.baseline, motion, reference_deg),
        "protocol": protocol,
        "channels": setup.channels,
        "bench": asked.bench,
        "strength": asked.strength,
        "structure": asked.structure,
        "seed": asked.seed,
        "rows": len(motion.time_s),
        "turns": len(motion.time_s) / (motion.points_per_turn * motion.repeats),
        "points_per_turn": motion.points_per_turn,
        "repeats": motion.repeats,
    }


def _frame(own: baselines.Baseline, motion: Motion, reference_deg: Array) -> dict[str, float]:
    """What the truth needs to be told in another convention: the scale, the first reading, the record's length."""
    return {
        "amplitude_x": own.amplitude_x,
        "first_time_s": float(motion.time_s[0]),
        "first_reference_deg": float(reference_deg[0]),
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
