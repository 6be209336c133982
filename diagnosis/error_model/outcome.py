"""From the outcome of a batch to one result a sweep: residuals, covariance, intervals, what each step brought."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model.global_search import GlobalSearch
from diagnosis.error_model.least_squares import Minimum
from diagnosis.error_model.model import LOWER_LIMIT, NAMES, UPPER_LIMIT, Readings
from diagnosis.error_model.result import BaselineFit, Contributions, SearchRange, Senses
from twin.angles import Array
from twin.confidence import student_95


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
    """What was found for the sweeps of a batch, one row each."""

    used: Readings
    """The readings (batch, n) in the senses that were kept, isolated gross errors with weight 0."""
    plain: Readings
    """The same with the caller's weights."""
    sensor: Array
    """Sense s (batch,) of the sensor, +1 or -1."""
    output: Array
    """Sense h (batch,) of the output, +1 or -1."""
    exact: Minimum
    """The least squares on the readings."""
    other: tuple[Array, Array] | None
    """Points (batch, 6) and costs (batch,) with both senses swapped; None where the senses were given."""
    search: GlobalSearch
    """The global search before."""


def results(outcome: Outcome) -> list[BaselineFit]:
    """One result a sweep."""
    # The residual is h m - atan2(y, x): times h it is measured minus predicted.
    residual = outcome.output[:, None] * outcome.exact.residual
    weights = outcome.used.weights
    counted = np.full(residual.shape, True) if weights is None else weights > 0.0
    outliers = _left_out(outcome.plain, counted)
    return [_result(outcome, k, residual[k], counted[k], outliers[k]) for k in range(len(residual))]


def _result(
    outcome: Outcome, k: int, residual: Array, counted: NDArray[np.bool_], outliers: NDArray[np.bool_]
) -> BaselineFit:
    """The result of sweep ``k``, whose rows (n,) have these residuals [rad]."""
    exact, weights = outcome.exact, outcome.used.weights
    freedom = max(int(np.count_nonzero(counted)) - 6, 1)
    pulled = residual if weights is None else weights[k] * residual
    sigma = float(np.sqrt(residual @ pulled / freedom))
    covariance = sigma**2 * _inverse(exact.curvature[k])
    half = student_95(freedom) * np.sqrt(np.diagonal(covariance))
    point = exact.points[k].copy()
    used = residual if counted.all() else residual[counted]
    rms = float(np.sqrt(used @ used / used.size))
    return BaselineFit(
        point=point,
        covariance=covariance,
        low=point - half,
        high=point + half,
        at_bound=(point <= LOWER_LIMIT) | (point >= UPPER_LIMIT),
        senses=_senses(outcome, k, sigma),
        search=_search_range(outcome.search, k),
        contributions=_contributions(outcome, k, counted, rms),
        residual_rad=residual,
        outliers=outliers,
        sigma_rad=sigma,
        rms_rad=rms,
        degrees_of_freedom=freedom,
        settled=bool(exact.settled[k]),
    )


def _senses(outcome: Outcome, k: int, sigma_rad: float) -> Senses:
    """The senses of sweep ``k``, and by how many standard errors the swapped ones fit worse."""
    sensor, output = int(outcome.sensor[k]), int(outcome.output[k])
    if outcome.other is None:
        return Senses(sensor=sensor, output=output, sigma=np.inf, other=None)
    points, cost = outcome.other
    excess = max(float(cost[k] - outcome.exact.cost[k]), 0.0) / max(sigma_rad**2, 1e-300)
    return Senses(sensor=sensor, output=output, sigma=float(np.sqrt(excess)), other=points[k].copy())


def _search_range(found: GlobalSearch, k: int) -> SearchRange:
    """Where the swarm looked for the parameters of sweep ``k``."""
    return SearchRange(
        lower=found.box.lower[k].copy(),
        upper=found.box.upper[k].copy(),
        widened=tuple(name for name, wide in zip(NAMES, found.box.widened[k], strict=True) if wide),
        rounds=int(found.rounds[k]),
    )


def _contributions(outcome: Outcome, k: int, counted: NDArray[np.bool_], rms_rad: float) -> Contributions:
    """What each step brought to the fit of sweep ``k``."""
    found, given = outcome.search, outcome.plain.weights
    total = float(np.count_nonzero(counted) if given is None else given[k].sum())
    best, own = found.histories[k]
    searched, by_swarm = float(np.sqrt(found.cost[k] / total)), bool(found.rounds[k])
    return Contributions(
        zero_only_rms_rad=float(np.sqrt(found.zero_only[k] / total)),
        swarm_rms_rad=searched if by_swarm else None,
        descents_rms_rad=None if by_swarm else searched,
        polished_rms_rad=rms_rad,
        particles_evaluated=int(found.evaluations[k]),
        particles_discarded=int(found.discarded[k]),
        passes=outcome.exact.passes,
        best_history_rad=np.sqrt(best / total),
        own_history_rad=np.sqrt(own / total),
    )


def _left_out(plain: Readings, counted: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Rows that the robust option left out; those to which the caller gave the weight 0 are not among them."""
    return ~counted if plain.weights is None else ~counted & (plain.weights > 0.0)


def _inverse(curvature: Array) -> Array:
    """Inverse of (6, 6); combinations that the readings do not determine get an enormous variance."""
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(curvature), 1e-300))
    values, vectors = np.linalg.eigh(curvature * scale[:, None] * scale)
    return np.asarray((vectors / np.maximum(values, 1e-13)) @ vectors.T * scale[:, None] * scale)
