"""Judge what is said of batches: weak causes that all devices share, nothing where there is nothing, and odd devices.

A single device's limit is the strength at which ``explain`` names a cause on half of the devices; it is measured first,
for each cause. Batches then have a quarter of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis import explain
from diagnosis.population.looks import looked_at_sweeps
from diagnosis.population.population import Population
from diagnosis.population.template import template_of
from twin.sweep import Sweep

from ...kept import Kept
from ..noise import Noise
from ..streams import derived_seed, stream
from .generator import Plan, device, devices

COUNT = 200
CAUSES = ("hysteresis", "magnet_harmonic", "drive_ripple", "saturation")
SHARES = {"magnet_harmonic": "own", "drive_ripple": "bench"}
"""From where the phase is counted of causes that have one."""
NOISES = {"white": Noise("white", 0.02), "ar1": Noise("ar1", 0.02, 0.8), "pink": Noise("pink", 0.02)}
STRENGTHS_DEG = tuple(float(value) for value in 0.002 * 2.0 ** (0.5 * np.arange(12)))
"""Strengths that the limit is looked for among, half an octave apart: 0.002 to 0.09 deg."""
ODD = ("hysteresis", "magnet_harmonic", "saturation", "drive_ripple", "offset")
ODD_STRENGTH_DEG = (0.05, 0.15)
ODD_SPREADS = 10.0


@dataclass(frozen=True)
class Trial:
    """One batch: its plan and seed, under a name that tells it from all others."""

    name: str
    plan: Plan
    seed: int


def sweeps_of(plan: Plan, *, seed: int) -> list[Sweep]:
    """The devices of a batch as sweeps, angles alone."""
    return [_sweep(columns, place) for place, columns in enumerate(devices(plan, seed=seed))]


def population(plan: Plan, *, seed: int) -> Population:
    """What is said of a batch."""
    sweeps = sweeps_of(plan, seed=seed)
    return looked_at_sweeps(template_of(sweeps[:32], told_sense=None, seed=0), sweeps).population


def limit_deg(cause: str, noise: str, *, seed: int, sweeps: int, kept: Kept) -> float:
    """The strength at which half of the devices' sweeps are explained by the cause, between two that were tried."""
    low, high = 0, len(STRENGTHS_DEG) - 1
    while high - low > 1:
        middle = (low + high) // 2
        named = _named(cause, noise, STRENGTHS_DEG[middle], seed=seed, sweeps=sweeps, kept=kept)
        low, high = (low, middle) if 2 * named >= sweeps else (middle, high)
    return STRENGTHS_DEG[high]


def trials(kind: str, *, noise: str, draws: int, seed: int, limits: dict[str, float]) -> Iterator[Trial]:
    """The batches of a kind: shared (of each cause), clean, or odd."""
    for number in range(draws):
        for cause in CAUSES if kind == "shared" else ("",):
            name = "/".join([kind, noise, cause, str(number)])
            own = derived_seed(seed, name)
            plan = Plan(count=COUNT, noise=NOISES[noise])
            if kind == "shared":
                plan = replace(plan, cause=cause, strength_deg=0.25 * limits[cause], phase=SHARES.get(cause, "own"))
            yield Trial(name, plan, own)


def odd_batch(count: int, *, seed: int) -> Plan:
    """A batch with ten odd devices, in places drawn at random."""
    rng = stream(seed, "odd")
    places = rng.choice(count, 10, replace=False)
    odd = {
        int(place): (what, ODD_SPREADS if what == "offset" else float(rng.uniform(*ODD_STRENGTH_DEG)))
        for place, what in zip(places, ODD * 2, strict=True)
    }
    return Plan(count=count, noise=NOISES["white"], odd=odd)


def outcome(trial: Trial) -> dict[str, Any]:
    """What was said of a batch, beside what it holds."""
    found = population(trial.plan, seed=trial.seed)
    names = [{one.name, *one.not_told_from} for one in found.causes]
    hit = [trial.plan.cause in those for those in names]
    return {
        "cause": trial.plan.cause,
        "strength_deg": trial.plan.strength_deg,
        "found": any(hit),
        "false": [sorted(those) for those, right in zip(names, hit, strict=True) if not right],
        "sizes": [[one.name, one.amplitude, one.low, one.high, one.spread] for one in found.causes],
        "apart": [[one.device, list(one.figures)] for one in found.apart],
        "changes": [one.figure for one in found.changes],
        "factors": [[f.factor.label, f.found.mean, f.found.low, f.found.high, f.found.spread] for f in found.factors],
    }


def run(asked: Sequence[Trial], kept: Kept) -> list[dict[str, Any]]:
    """The outcomes of all, those that are kept already not asked for again."""
    for trial in asked:
        if trial.name not in kept.lines:
            kept.add(trial.name, outcome(trial))
    return [kept.lines[trial.name] for trial in asked]


def _named(cause: str, noise: str, strength_deg: float, *, seed: int, sweeps: int, kept: Kept) -> int:
    """On how many of so many devices ``explain`` names the cause."""
    name = "/".join(["single", noise, cause, f"{strength_deg:.5f}", str(sweeps)])
    if name not in kept.lines:
        plan = Plan(
            count=sweeps,
            cause=cause,
            strength_deg=strength_deg,
            phase=SHARES.get(cause, "own"),
            spread=0.0,
            noise=NOISES[noise],
        )
        answers = [explain(_sweep(device(plan, place, seed=seed), place)) for place in range(sweeps)]
        named = [any(cause in (c.name, *c.indistinguishable_from) for c in answer.causes) for answer in answers]
        kept.add(name, {"named": sum(named), "sweeps": sweeps})
    return int(kept.lines[name]["named"])


def _sweep(columns: dict[str, Any], place: int) -> Sweep:
    wanted = {name: columns[name] for name in ("reference_deg", "measured_deg")}
    return Sweep.from_columns(wanted, name=f"device {place + 1}")
