"""Self-starting EWMA charts: when has a fitted factor begun to drift, at a stated rate of false alarms.

Each new value is held against the mean and scatter of all values before it and turned into a standard normal deviate
(Quesenberry 1991), so no trial period of known scatter is needed and the rate of false alarms is what it says from
the third value on. The deviates are smoothed exponentially (Roberts 1959); the limit follows from the average run
length by the integral equation of the chart (Crowder 1987).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from diagnosis.factors.change_point import Change, change_point
from twin.angles import Array

WEIGHT = 0.2
"""Share of the newest value in the average: best for drifts of about one standard deviation."""
BOTH, FORWARD, BACKWARD = "both", "forward", "backward"
"""Readings of a sweep by the direction of travel: all of them, or those of one direction."""
_NODES = 65
_FIRST = 2


@dataclass(frozen=True, eq=False)
class Chart:
    """One factor's chart over the sweeps (n,); NaN where there is nothing to hold a value against yet.

    ``unit`` is that of the values; ``travel`` says which readings of each sweep they come from.
    """

    name: str
    unit: str
    travel: str
    values: Array
    deviates: Array
    averages: Array
    limit: float
    signal: int | None
    """Index of the first sweep outside the limit."""
    change: Change | None
    """When it began to change, by all values; None without a signal."""

    @property
    def direction(self) -> int:
        """Which way the signalled factor moves; 0 without a signal."""
        return 0 if self.signal is None else int(np.sign(self.averages[self.signal]))

    @property
    def scatter(self) -> float:
        """Standard deviation of a value, from the differences of successive ones, which a slow drift hardly changes."""
        return float(np.std(np.diff(self.values)) / np.sqrt(2.0))


def chart(
    name: str, values: Array, *, limit: float, unit: str = "1", travel: str = BOTH, weight: float = WEIGHT
) -> Chart:
    """The chart of one factor's values (n,), in the order in which the sweeps were taken."""
    found = deviates(values)
    averages = np.full(values.size, np.nan)
    state = 0.0
    for k in range(_FIRST, values.size):
        state = (1.0 - weight) * state + weight * float(found[k])
        averages[k] = state
    with np.errstate(invalid="ignore"):
        outside = np.flatnonzero(np.abs(averages) > limit)
    return Chart(
        name=name,
        unit=unit,
        travel=travel,
        values=values,
        deviates=found,
        averages=averages,
        limit=limit,
        signal=int(outside[0]) if outside.size else None,
        change=change_point(values) if outside.size else None,
    )


def deviates(values: Array) -> Array:
    """Standard normal deviates (n,) of each value against all before it; NaN for the first two."""
    from scipy.special import ndtri, stdtr

    out = np.full(values.size, np.nan)
    for k in range(_FIRST, values.size):
        before = values[:k]
        scatter = float(before.std(ddof=1))
        if scatter == 0.0:
            out[k] = 0.0 if values[k] == before[0] else np.inf * np.sign(values[k] - before[0])
        else:
            student = (values[k] - before.mean()) / (scatter * np.sqrt(1.0 + 1.0 / k))
            # By the lower tail, where the normal quantile keeps its digits.
            out[k] = -np.sign(student) * ndtri(stdtr(k - 1, -abs(student)))
    return np.asarray(np.clip(out, -8.0, 8.0))


@lru_cache(maxsize=32)
def limit_for(run_length: float, weight: float = WEIGHT) -> float:
    """The limit of one two-sided chart whose average run length without a drift is ``run_length`` sweeps."""
    low, high = 0.05, 5.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if average_run_length(middle, weight) < run_length else (low, middle)
    return 0.5 * (low + high)


def average_run_length(limit: float, weight: float = WEIGHT, shift: float = 0.0) -> float:
    """Average number of values until |average| exceeds the limit, from 0, when the deviates' mean is ``shift``.

    N(u) = 1 + integral of N(v) times the density of going from u to v, solved on Gauss-Legendre nodes.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    places = limit * nodes
    step = (places[None, :] - (1.0 - weight) * np.append(places, 0.0)[:, None]) / weight - shift
    density = np.exp(-0.5 * step**2) / (np.sqrt(2.0 * np.pi) * weight)
    moves = density * (limit * weights)
    inside = np.linalg.solve(np.eye(_NODES) - moves[:-1], np.ones(_NODES))
    return float(1.0 + moves[-1] @ inside)
