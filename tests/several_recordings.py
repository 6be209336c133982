"""``python -m tests.several_recordings``: ambiguous causes of devices that were recorded three times.

Devices are made here from definitions, without any code of the twin: a sensor over a diametral magnet, a reference, a
coupling. Each is recorded as it is, at a wider air gap with the sensor turned, and warm with the sensor turned. Every
kind is one of a class that a single sweep of angles cannot part. Right: the cause alone is named, with no rival; open:
it is named with rivals, or is a rival itself, or nothing is named; wrong: something else is named.

    python -m tests.several_recordings --draws 25 --seed 21 -o several.jsonl

Each device is kept in the file as it is done; the same command goes on where it was stopped.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis import explain
from diagnosis.explanation import Explanation
from tests.kept import Kept, share
from twin.angles import Array
from twin.sweep import Sweep

RADIUS_MM, HEIGHT_MM = 3.0, 2.5
NOISE_DEG = 0.02
STEP_DEG = 4.0


@dataclass(frozen=True)
class Setup:
    """One recording: air gap [mm], the sensor's turn [deg], temperature [C]."""

    gap_mm: float
    turned_deg: float
    temperature_c: float


@dataclass(frozen=True)
class Device:
    """Strengths [deg] of what a device and its bench have; zero where they have it not."""

    offset_deg: tuple[float, float] = (0.3, -0.2)
    gain: float = 1.008
    phase_deg: float = 0.2
    stray_deg: float = 0.0
    eccentric_deg: float = 0.0
    coupling_deg: float = 0.0
    saturation_deg: float = 0.0
    harmonic_deg: float = 0.0
    lag_deg: float = 0.0
    play_deg: float = 0.0
    direction_deg: float = 0.0


KINDS = {
    "offset and gain alone": (None, ""),
    "stray field": ("stray_field", "stray_deg"),
    "eccentric reference": ("reference_eccentricity", "eccentric_deg"),
    "coupling": ("cardan_coupling", "coupling_deg"),
    "saturation": ("saturation", "saturation_deg"),
    "magnet's fourth harmonic": ("magnet_harmonic", "harmonic_deg"),
    "hysteresis": ("hysteresis", "lag_deg"),
    "play": ("backlash", "play_deg"),
}
"""By kind the catalogue's name, and the strength that is drawn."""


VERDICTS = ("right", "open", "wrong")


def field_at(gap_mm: float) -> float:
    """Field on the axis of the diametral cylinder, up to a factor: half that of an axial one, turned round."""
    near, far = gap_mm, gap_mm + HEIGHT_MM
    return far / np.hypot(far, RADIUS_MM) - near / np.hypot(near, RADIUS_MM)


def shaft(rng: np.random.Generator) -> Array:
    """Two turns and back [deg], then two short legs in fine steps, as a bench that looks for reversals makes them."""
    there = np.arange(0.0, 720.0, STEP_DEG) + rng.uniform(0.0, STEP_DEG)
    leg = np.concatenate([np.arange(0.1, 3.0, 0.1), np.arange(3.0, 60.0, 2.0)])
    back = there[-2::-1]
    return np.concatenate([there, back, back[-1] + leg, back[-1] + leg[-1] - leg])


def lagging(shaft_deg: Array, lag_deg: float, memory_deg: float = 8.0) -> Array:
    """First-order lag of the direction, reading by reading."""
    out, state, way = np.empty(shaft_deg.size), -lag_deg, 1.0
    out[0] = state
    for k in range(1, shaft_deg.size):
        step = shaft_deg[k] - shaft_deg[k - 1]
        way = np.sign(step) or way
        state = -way * lag_deg + (state + way * lag_deg) * np.exp(-abs(step) / memory_deg)
        out[k] = state
    return out


def played(shaft_deg: Array, half_deg: float) -> Array:
    """Where the magnet stands against the shaft behind a dead zone."""
    out, at = np.empty(shaft_deg.size), shaft_deg[0] - half_deg
    for k, angle in enumerate(shaft_deg):
        at = min(max(at, angle - half_deg), angle + half_deg)
        out[k] = at - angle
    return out


def recorded(device: Device, setup: Setup, first: Setup, name: str, rng: np.random.Generator) -> Sweep:
    """One recording of a device."""
    true_deg = shaft(rng)
    field = field_at(setup.gap_mm) / field_at(first.gap_mm)
    distance = (setup.gap_mm + 0.5 * HEIGHT_MM) / (first.gap_mm + 0.5 * HEIGHT_MM)
    turn, way = np.radians(true_deg), np.radians(device.direction_deg)
    moved_deg = lagging(true_deg, device.lag_deg / field) + played(true_deg, device.play_deg)
    moved_deg = moved_deg + device.coupling_deg * np.sin(2.0 * turn + way)
    moved_deg += device.harmonic_deg * distance**-4 * np.sin(4.0 * turn + way)
    own = turn + np.radians(moved_deg) + np.radians(23.0 - setup.turned_deg)
    x, y = np.cos(own), np.sin(own)
    stray = np.radians(device.stray_deg) / field * np.exp(1j * (way - np.radians(setup.turned_deg)))
    x, y = x + stray.real, y + stray.imag
    bend = 4.0 * np.radians(device.saturation_deg) * field**2
    x, y = x - bend * x**3, y - bend * y**3
    ox, oy = np.radians(device.offset_deg) / field
    lean = np.radians(device.phase_deg)
    angle = np.arctan2(device.gain * (y * np.cos(lean) + x * np.sin(lean)) + oy, x + ox)
    read = true_deg + device.eccentric_deg * np.sin(turn + way)
    noisy = np.degrees(angle) + NOISE_DEG / field * rng.standard_normal(angle.size)
    same = np.ones(angle.size)
    columns = {
        "reference_deg": read % 360.0,
        "measured_deg": noisy % 360.0,
        "temperature_c": setup.temperature_c * same,
    }
    columns |= {"direction": np.sign(np.diff(true_deg, prepend=true_deg[0] - 1.0))}
    columns |= {"air_gap_mm": setup.gap_mm * same, "mounting_deg": setup.turned_deg * same}
    return Sweep.from_columns(columns, name=name)


def devices(draws: int, seed: int) -> Iterator[tuple[int, str, str | None, list[Sweep]]]:
    """Number, kind, true cause, three recordings, for so many devices of each kind."""
    for draw in range(draws):
        for number, (kind, (cause, strength)) in enumerate(KINDS.items()):
            rng = np.random.default_rng([seed, draw, number])
            drawn = {strength: float(rng.uniform(0.08, 0.3))} if strength else {}
            device = Device(
                **drawn, direction_deg=float(rng.uniform(0.0, 360.0)), gain=float(rng.uniform(0.985, 1.015))
            )
            gap = float(rng.uniform(1.0, 2.0))
            turned = float(rng.uniform(60.0, 120.0))
            setups = [Setup(gap, 0.0, 25.0), Setup(gap * rng.uniform(1.5, 2.0), turned, 25.0), Setup(gap, turned, 60.0)]
            yield draw, kind, cause, [recorded(device, one, setups[0], f"r{k}", rng) for k, one in enumerate(setups)]


def judged(found: Explanation, truth: str | None) -> str:
    """right, open or wrong."""
    names = {cause.name for cause in found.causes}
    if truth is None:
        return "right" if not names else "wrong"
    if not names:
        return "open"
    if any(truth not in (cause.name, *cause.indistinguishable_from) for cause in found.causes):
        return "wrong"
    # A pulley or a gear stands on the shaft as the magnet does: no turn of the sensor and no gap parts these.
    alone = all(set(cause.indistinguishable_from) <= {"mechanics"} for cause in found.causes)
    return "right" if alone and names == {truth} else "open"


def _count(counts: Mapping[tuple[str, str], int], kind: str, word: str) -> int:
    """How many devices of a kind, or of all, were judged so."""
    return sum(count for (own, verdict), count in counts.items() if verdict == word and kind in (own, "all kinds"))


def main() -> None:
    """Print a line for each device, and the counts of each kind."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=25, help="devices of each of the eight kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="this kind alone")
    parser.add_argument("-o", "--output", type=Path, help="keeps each device as it is done (JSON lines)")
    options = parser.parse_args()
    kept, counts = Kept.read(options.output), Counter[tuple[str, str]]()
    for draw, kind, truth, sweeps in devices(options.draws, options.seed):
        if options.only not in ("", kind):
            continue
        name = f"{kind} {draw} of seed {options.seed}"
        if name not in kept.lines:
            found = explain(sweeps)
            named = ", ".join(f"{c.name} ({'/'.join(c.indistinguishable_from) or '-'})" for c in found.causes)
            kept.add(name, {"kind": kind, "verdict": judged(found, truth), "named": named})
        told = kept.lines[name]
        counts[kind, told["verdict"]] += 1
        print(f"{told['verdict']:6} {name:40} {told['named'] or 'nothing'}", flush=True)
    for kind in [*dict.fromkeys(kind for kind, _ in counts), "all kinds"]:
        own = Counter({word: _count(counts, kind, word) for word in VERDICTS})
        print(f"{kind:26} " + ", ".join(f"{word} {share(n, own.total())}" for word, n in own.items()))


if __name__ == "__main__":
    main()
