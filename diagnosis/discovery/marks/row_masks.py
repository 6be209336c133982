"""Single rows: those that stand out alone, those that an effect has touched, and what each leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.coefficients import without_motion
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise.rounding import coarsest_stair
from diagnosis.discovery.fitting.observations import Observations
from diagnosis.discovery.marks.outliers import spikes
from diagnosis.discovery.marks.spread import row_scale
from twin.angles import Array, wrap
from twin.effect import BoolArray
from twin.sweep import Sweep

_PASSES = 4
"""The set is stable after one or two; a row at the edge could come and go."""


def mask_spikes(fit: Fit, step: float, also: BoolArray) -> Fit:
    """The fit without the rows that stand out alone, fitted anew until their set is stable.

    ``step`` [rad] is that of the output's grid; raw rows in ``also`` (n_raw,) stay out too.
    """
    settings, motion = fit.settings, fit.observations.motion
    for _ in range(_PASSES):
        # Where the noise is louder a reading has to be farther out.
        scale, grid = fit.observations.scale, max(step, coarsest_stair(fit.chain))
        mask = spikes(fit.residual[0] / scale, motion, grid / scale, settings)
        mask |= gross_of_few(fit)
        usable = ~mask & fit.observations.sure & ~rows_of(fit.observations, also)
        if fit.observations.observables == 2:
            # Channels that fall out say nothing true about the radius: alone for a reading, or by more than any cause
            # would change it.
            radius = fit.residual[1]
            alone = spikes(radius, motion, 0.0, settings)
            near = ~alone & (np.abs(radius - np.median(radius)) < settings.fallen_out)
            # What most readings do is no falling out: such channels are as they are.
            usable &= near | (2 * np.count_nonzero(near) < near.size)
        if np.array_equal(usable, fit.observations.usable):
            break
        fit = solve(evaluate(fit.chain, fit.free, fit.observations.masked(usable), fit.weighting))
    return fit


def gross_of_few(fit: Fit) -> BoolArray:
    """Which rows (n,) that a short record's fit was made without are no readings of the same noise.

    So few rows do not tell their scatter robustly, but the fit without a row tells what that should read: the deleted
    residual follows Student's t (R. D. Cook, S. Weisberg, Residuals and Influence in Regression, 1982, section 2.2).
    The row may be any of all (Bonferroni).
    """
    from scipy.special import stdtrit

    observations = fit.observations
    out = np.asarray(~observations.usable & observations.sure)
    n = len(observations)
    if n >= fit.settings.spike_few or not out.any() or fit.rows <= len(fit.free):
        return np.zeros(n, dtype=bool)
    row_slopes = fit.jacobian[:, 0, out]
    variance = fit.variance + np.einsum("pn,pq,qn->n", row_slopes, fit.covariance(), row_slopes)
    chance = float(np.exp(fit.settings.footprint_log_p)) / n
    limit = float(stdtrit(fit.rows - len(fit.free), 1.0 - 0.5 * chance))
    far = np.zeros(n, dtype=bool)
    # Where the other rows do not tell what this one should read, its variance is infinite.
    far[out] = np.abs(fit.residual[0][out]) > limit * np.sqrt(np.nan_to_num(variance, nan=np.inf))
    return far


def rows_of(observations: Observations, raw: BoolArray) -> BoolArray:
    """Rows of the observations whose raw rows are mostly marked."""
    count = np.bincount(observations.group)
    return np.asarray(np.bincount(observations.group, raw) > 0.5 * count)


def without_rows(fit: Fit, raw: BoolArray) -> Fit:
    """The fit without the marked raw rows (n_raw,)."""
    rows = rows_of(fit.observations, raw)
    if not np.any(rows & fit.observations.usable):
        return fit
    return solve(evaluate(fit.chain, fit.free, fit.observations.masked(fit.observations.usable & ~rows), fit.weighting))


def with_rows(fit: Fit, raw: BoolArray) -> Fit:
    """The fit as it stands, with the marked raw rows (n_raw,) in use again where they are sure."""
    observations = fit.observations
    usable = observations.usable | (rows_of(observations, raw) & observations.sure)
    return evaluate(fit.chain, fit.free, observations.masked(usable), fit.weighting)


def scaled(fit: Fit, variance: Array) -> Fit:
    """The fit with its rows weighed by a variance (n,)."""
    observations = replace(fit.observations, scale=row_scale(fit.observations, variance) * fit.observations.level)
    return solve(evaluate(fit.chain, fit.free, observations, fit.weighting))


def raw_residual(fit: Fit, sweep: Sweep) -> Array:
    """Residual [rad] of every raw reading (n_raw,) against the fit, without what the shaft may have done of itself."""
    observations = fit.observations
    residual = wrap(observations.measured - fit.linear.angle)
    moved = residual - without_motion(observations, residual)
    if len(sweep) == len(observations):
        return residual - moved
    predicted: Array = fit.linear.angle[observations.group] + observations.ahead
    return wrap(np.radians(sweep.measured_deg) - predicted) - moved[observations.group]
