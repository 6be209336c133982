"""Draw the devices of a batch, measured one after the other on one bench.

    for columns in devices(Plan(count=200, cause="hysteresis", strength_deg=0.004), seed=3):
        ...

The same plan and seed give the same sweeps on every machine. Independent of the simulator under test: numpy and the
standard library only.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ..baseline import Baseline, Injected, Setting
from ..catalogue import CAUSES
from ..chain import Bench, sample
from ..columns import all_columns
from ..motion import Array, Layout, Leg, Motion, run
from ..noise import Noise
from ..streams import stream

LINES = ("magnet_harmonic", "drive_ripple", "motor_poles")
"""Causes that have a phase."""


@dataclass(frozen=True)
class Plan:
    """What a batch is like.

    ``phase``: "own" (each device has its own), "bench" (one, counted from the reference's zero) or "design" (one,
    counted from the sensor's). ``odd`` maps places of odd devices to a cause and its strength, or to "offset" and by
    how many spreads it is off. ``moved``: from this place on offset x is so many percent larger.
    """

    count: int
    cause: str | None = None
    strength_deg: float = 0.0
    phase: str = "own"
    spread: float = 0.2
    """Of the strength over devices, as a share of it."""
    noise: Noise = field(default_factory=lambda: Noise("white", 0.02))
    points: int = 360
    turns: int = 1
    both_ways: bool = True
    bits: int = 16
    odd: Mapping[int, tuple[str, float]] = field(default_factory=dict)
    moved: tuple[int, float] | None = None


SPREAD_PERCENT = 0.1
"""Standard deviation of either offset over devices, percent of the amplitude."""


def devices(plan: Plan, *, seed: int) -> Iterator[dict[str, Array]]:
    """The columns of each device's sweep, in the order of production."""
    for place in range(plan.count):
        yield device(plan, place, seed=seed)


def device(plan: Plan, place: int, *, seed: int) -> dict[str, Array]:
    """One of them by its place from 0; it depends on no other."""
    rng = stream(seed, "device", str(place))
    motion = _motion(plan, rng)
    own = _baseline(plan, place, stream(seed, "batch"), rng)
    causes = []
    if plan.cause is not None:
        causes.append(_shared(plan, motion, own, stream(seed, "cause"), rng))
    what, size = plan.odd.get(place, ("", 0.0))
    if what == "offset":
        own = replace(own, offset_x=own.offset_x + 0.01 * SPREAD_PERCENT * size)
    elif what:
        causes.append(CAUSES[what].plan(rng, size, _setting(plan, motion, own)))
    bench = Bench(motion, own, plan.noise, plan.bits, False, 1.0, 2.0**-15)
    return all_columns(bench, sample(bench, causes, rng))


def write(plan: Plan, folder: Path, *, seed: int) -> list[Path]:
    """A file for each device; angles alone."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for place, columns in enumerate(devices(plan, seed=seed), 1):
        path = folder / f"device_{place}.csv"
        rows = np.column_stack([columns["reference_deg"], columns["measured_deg"]])
        lines = [f"{reference:.5f},{measured:.5f}" for reference, measured in rows]
        path.write_text("\n".join(["reference_deg,measured_deg", *lines]) + "\n", encoding="utf-8")
        paths.append(path)
    return paths


def _motion(plan: Plan, rng: np.random.Generator) -> Motion:
    """One turn after the other, and back where both ways are gone; stops are met to a few thousandths of a degree."""
    legs = tuple(Leg(plan.turns, way) for way in ((1, -1) if plan.both_ways else (1,)))
    layout = Layout(points_per_turn=plan.points, start_deg=0.0, jitter_deg=0.005, legs=legs, dwell_s=0.05)
    return run("batch", layout, rng)


def _baseline(plan: Plan, place: int, batch: np.random.Generator, rng: np.random.Generator) -> Baseline:
    """Factors about the batch's mean; the sensor is mounted at any angle."""
    mean_x, mean_y = batch.uniform(-1.0, 1.0, 2)
    gain, phase, quadratic = batch.uniform((0.99, -0.5, 0.05), (1.01, 0.5, 0.2))
    off = SPREAD_PERCENT * rng.standard_normal(2)
    step = plan.moved[1] if plan.moved is not None and place >= plan.moved[0] else 0.0
    return Baseline(
        zero_deg=float(rng.uniform(0.0, 360.0)),
        offset_x=float(0.01 * (mean_x + off[0] + step)),
        offset_y=float(0.01 * (mean_y + off[1])),
        amplitude_x=1.0,
        amplitude_y=float(gain + 0.002 * rng.standard_normal()),
        phase_deg=float(phase + 0.05 * rng.standard_normal()),
        quadratic=float(0.01 * (quadratic + 0.02 * rng.standard_normal())),
    )


def _shared(
    plan: Plan, motion: Motion, own: Baseline, batch: np.random.Generator, rng: np.random.Generator
) -> Injected:
    """The cause that all devices have, at this one's own size."""
    assert plan.cause is not None
    size = plan.strength_deg * max(1.0 + plan.spread * float(rng.standard_normal()), 0.0)
    common = _mean_device()
    planned = CAUSES[plan.cause].plan(batch, size, _setting(plan, motion, common))
    if plan.cause not in LINES or plan.phase == "bench":
        return planned
    order = planned.parameters["order"]
    turned = rng.uniform(-180.0, 180.0) if plan.phase == "own" else order * own.zero_deg
    return replace(planned, parameters={**planned.parameters, "phase_deg": planned.parameters["phase_deg"] + turned})


def _mean_device() -> Baseline:
    """What the cause's parameters are settled for: a device without errors."""
    return Baseline(
        zero_deg=0.0, offset_x=0.0, offset_y=0.0, amplitude_x=1.0, amplitude_y=1.0, phase_deg=0.0, quadratic=0.0
    )


def _setting(plan: Plan, motion: Motion, own: Baseline) -> Setting:
    return Setting(motion, own, plan.noise, plan.bits, weak=False)
