"""How fast the swarm converges on cases drawn from Table 2, and what each of the paper's modifications brings.

A case has converged when the swarm's best is within 1 % of the smallest RMS error that there is; least squares from the
truth finds that. All methods search the same cases from the same seeds, so that they are compared case by case.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from diagnosis.error_model import grid_search, least_squares, model, swarm
from diagnosis.error_model.error_band import outside
from diagnosis.error_model.model import Readings
from diagnosis.error_model.search_range import first_box
from diagnosis.error_model.swarm import SwarmSettings
from diagnosis.progress import Count
from scenarios.commands.paper.table_2 import STEPS, Cases
from twin.angles import Array

NEAR = 1.01
"""A best within this factor of the smallest RMS counts as converged."""
_TOGETHER = 50
"""Cases that are searched in one batch: their arrays stay small."""
_MARGIN = 0.05
GRID_POINTS = 5
"""Points of each factor in the coarse grid: 5^6 = 15,625 tries, nearly as many as the swarm's 20,100 particles."""


@dataclass(frozen=True)
class Method:
    """One way to search: its words, the swarm's settings, whether in Table 2's steps, the discard rule's Delta E."""

    words: str
    settings: SwarmSettings = field(default_factory=SwarmSettings)
    steps: bool = False
    band_rad: float | None = None


@dataclass(frozen=True, eq=False)
class Searched:
    """What a method did: iterations needed (cases,), infinite where it never converged; RMS errors [rad].

    ``best_rad`` and ``own_rad`` (cases, iterations + 1) are of the swarm's best and of the mean of the particles' own
    bests, ``least_rad`` (cases,) the smallest there is; ``discarded`` (cases,) particles by Eq. 11.
    """

    needed: Array
    best_rad: Array
    own_rad: Array
    least_rad: Array
    discarded: Array


def methods(band_rad: float) -> dict[str, Method]:
    """The methods compared, by a short name; the paper's own is ``modified``."""
    constant = SwarmSettings(inertia_max=0.729, inertia_min=0.729)
    first = SwarmSettings(inertia_max=1.0, inertia_min=1.0, own_pull=2.0, best_pull=2.0)
    return {
        "standard": Method("standard swarm of 1995: inertia 1, c = 2", first),
        "constant": Method("constant inertia 0.729", constant),
        "modified": Method("the paper's: inertia falls from 0.9 to 0.4 (Eq. 10)"),
        "steps": Method("the same, velocity in steps of Table 2", steps=True),
        "discard": Method(f"the same, discard rule of {np.degrees(band_rad):.3f} deg (Eq. 11)", band_rad=band_rad),
    }


def search(cases: Cases, method: Method, *, seed: int, count: Count | None = None, done: int = 0) -> Searched:
    """Search all cases by one method; ``count`` hears how many are done beside those ``done`` before."""
    count = count or Count(0)
    parts = []
    for start in range(0, len(cases), _TOGETHER):
        part = cases.part(slice(start, start + _TOGETHER))
        # The stream belongs to the cases, not to the method.
        parts.append(_search(part, method, np.random.default_rng([seed, start])))
        count.of("searching_random_cases", done + start + len(part), None)
    return Searched(*(np.concatenate(one) for one in zip(*parts, strict=True)))


def _search(cases: Cases, method: Method, rng: np.random.Generator) -> tuple[Array, Array, Array, Array, Array]:
    readings = Readings.of(cases.reference, cases.measured)
    gram = readings.gram()
    least = least_squares.descend(least_squares.on_gram(gram), cases.points, count=readings.count).cost
    lower, upper = _range(cases)
    root = model.factor(gram)
    found = swarm.run(
        lambda points: model.cost(model.coefficients(points), root),
        lower,
        upper,
        rng=rng,
        settings=method.settings,
        steps=STEPS if method.steps else None,
        outside=None if method.band_rad is None else outside(readings, method.band_rad),
    )
    best, own, smallest = (np.sqrt(cost / readings.count) for cost in (found.best_history, found.own_history, least))
    there = best <= NEAR * smallest[:, None]
    needed = np.where(there.any(axis=1), np.argmax(there, axis=1), np.inf)
    return needed, best, own, smallest, found.discarded.astype(np.float64)


def _range(cases: Cases) -> tuple[Array, Array]:
    """Lower and upper end (cases, 6) of what is searched: Table 2's range about the mean error, and a little more.

    A case drawn at the range's very edge may have its least RMS beyond it, by its noise.
    """
    box = first_box(np.asarray(np.angle(np.mean(np.exp(1j * (cases.measured - cases.reference)), axis=1))))
    more = _MARGIN * (box.upper - box.lower)
    return box.lower - more, box.upper + more


def coarse_grid_rad(cases: Cases) -> Array:
    """RMS error (cases,) [rad] of the best point of the ordinary method's grid with few points a factor."""
    gram = Readings.of(cases.reference, cases.measured).gram()
    costs = [
        grid_search.grid_search(one, low, high, points=GRID_POINTS).cost
        for one, low, high in zip(gram, *_range(cases), strict=True)
    ]
    return np.asarray(np.sqrt(np.asarray(costs) / cases.reference.shape[1]))


@dataclass(frozen=True)
class Median:
    """A median with its 95 % interval from the order statistics: no distribution is assumed."""

    value: float
    low: float
    high: float


def median_of(values: Array) -> Median:
    """The median of values (n,); infinite ones, which never converged, count as the largest."""
    from scipy.stats import binom

    ranked = np.sort(values)
    # The count of values below the true median is binomial with one half.
    rank = max(int(binom.ppf(0.025, values.size, 0.5)) - 1, 0)
    return Median(float(np.median(ranked)), float(ranked[rank]), float(ranked[values.size - 1 - rank]))


@dataclass(frozen=True)
class Paired:
    """One method against another, case by case: the median of the differences in iterations, how often it is slower.

    ``p_value`` is that of the sign test, both ways: of two equally fast methods either is as often the slower one.
    """

    difference: Median
    slower: int
    faster: int
    p_value: float


def paired(new: Searched, old: Searched) -> Paired:
    """The differences new - old of the iterations needed, where either of them converged."""
    from scipy.stats import binomtest

    last = new.best_rad.shape[1]
    difference = np.minimum(new.needed, last) - np.minimum(old.needed, last)
    slower, faster = int(np.count_nonzero(difference > 0)), int(np.count_nonzero(difference < 0))
    p_value = float(binomtest(slower, slower + faster).pvalue) if slower + faster else 1.0
    return Paired(median_of(difference), slower, faster, p_value)


def search_all(
    cases: Cases, chosen: Mapping[str, Method], *, seed: int, count: Count | None = None
) -> dict[str, Searched]:
    """Every method on all cases, by name."""
    return {
        name: search(cases, method, seed=seed, count=count, done=place * len(cases))
        for place, (name, method) in enumerate(chosen.items())
    }
