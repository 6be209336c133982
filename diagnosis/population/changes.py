"""Since when the batch is another: which figures change in the order of production, from which device on.

Whether a figure changes at all is asked of its ranks, turned into normal scores, so that neither odd devices nor the
shape of its distribution matter: the largest of all steps and the trend are held against chance, as many times as they
were tried. When it changed is then the most likely change point, with its interval.

Reference: Pettitt (1979), Appl. Statist. 28, 126, for ranks; Conover (1999), Practical Nonparametric Statistics, 5.10,
for normal scores.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.factors.change_point import Change, change_point
from diagnosis.population.apart import RESIDUAL
from diagnosis.population.batch import ZERO, Batch
from diagnosis.population.false_discovery import believed
from diagnosis.population.pooled import FALSE_SHARE, SENSOR, Figures
from twin.angles import Array
from twin.baseline import FACTORS
from twin.effect import BoolArray

_EACH_SIDE = 5
"""Fewest devices before and after a change that is asked for."""
FEWEST_DEVICES = 4 * _EACH_SIDE
"""Below, no change in ranks is improbable enough."""


@dataclass(frozen=True, kw_only=True)
class ChangeOfBatch:
    """A figure that changes over the devices: its name and unit, log p, and when; places are those of the batch."""

    figure: str
    unit: str
    log_p: float
    change: Change


@dataclass(frozen=True, eq=False)
class Course:
    """A figure over the devices in their order (N,)."""

    figure: str
    unit: str
    values: Array


def courses(batch: Batch) -> Iterator[Course]:
    """The factors, the residual's RMS, and each coefficient of the causes that the batch shares."""
    for place, factor in enumerate(FACTORS[:ZERO]):
        yield Course(factor.label, factor.shown_unit or "1", batch.arrays["fitted"][:, place])
    yield Course(RESIDUAL, "deg", batch.arrays["sigma_deg"])
    for number, one in enumerate(batch.present):
        figures = batch.figures_of_present(number)
        for values in _sizes(figures):
            yield Course(one.effect, one.unit, values)


def changes_of(batch: Batch, usual: BoolArray, share: float = FALSE_SHARE) -> list[ChangeOfBatch]:
    """The figures that change over the usual devices (N,), most certain first."""
    places = np.flatnonzero(usual)
    if places.size < FEWEST_DEVICES:
        return []
    asked = list(courses(batch))
    log_p = np.array([log_p_of_change(course.values[places]) for course in asked])
    found = []
    for place in np.flatnonzero(believed(log_p, share)):
        one = asked[place]
        when = change_point(one.values[places])
        first, low, high = (int(places[k]) for k in (when.first, when.low, when.high))
        change = Change(first=first, low=low, high=high, shape=when.shape, size=when.size)
        found.append(ChangeOfBatch(figure=one.figure, unit=one.unit, log_p=float(log_p[place]), change=change))
    return sorted(found, key=lambda one: one.log_p)


def log_p_of_change(values: Array) -> float:
    """Log of the probability, at most, that values (N,) in any order show as large a step or trend."""
    from scipy.special import ndtri

    count = values.size
    if np.ptp(values) == 0.0:
        return 0.0
    scores = np.asarray(ndtri((np.argsort(np.argsort(values, kind="stable"), kind="stable") + 0.5) / count))
    total = float(scores @ scores)
    before = np.cumsum(scores)[_EACH_SIDE - 1 : count - _EACH_SIDE]
    number = np.arange(_EACH_SIDE, count - _EACH_SIDE + 1)
    steps = before**2 * count / (number * (count - number))
    ramp = np.arange(count) - 0.5 * (count - 1)
    trend = float(ramp @ scores) ** 2 / float(ramp @ ramp)
    best = min(max(float(steps.max()), trend), (1.0 - 1e-12) * total)
    gain = -count * np.log(1.0 - best / total)
    return min(float(log_probability(np.array(gain), 1, count - 1)) + float(np.log(steps.size + 1)), 0.0)


def _sizes(figures: Figures) -> list[Array]:
    """Coefficients (N,) of a cause where devices share its phase, else its size."""
    values = figures.values
    if values.shape[1] == 1:
        return [values[:, 0]]
    ways = [values] if figures.turned is None else [values, figures.counted_from(SENSOR)]
    agreeing = [way for way in ways if _agree(way[figures.seen])]
    return list(agreeing[0].T) if agreeing else [np.linalg.norm(values, axis=1)]


def _agree(values: Array) -> bool:
    """Whether coefficients (N, 2) point one way: their mean is more than half of their usual size."""
    return float(np.linalg.norm(np.median(values, axis=0))) > 0.5 * float(np.median(np.linalg.norm(values, axis=1)))
