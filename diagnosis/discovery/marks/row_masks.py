"""Single rows: those that stand out alone, those that an effect has touched, and what each leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise.rounding import coarsest_stair
from diagnosis.discovery.fitting.observations import Evidence
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
    settings, motion = fit.settings, fit.evidence.motion
    for _ in range(_PASSES):
        mask = spikes(fit.residual[0], motion, max(step, coarsest_stair(fit.chain)), settings)
        usable = ~mask & fit.evidence.sure & ~rows_of(fit.evidence, also)
        if fit.evidence.observables == 2:
            # Channels that fall out say nothing true about the radius: alone for a reading, or by more than any cause
            # would change it.
            radius = fit.residual[1]
            alone = spikes(radius, motion, 0.0, settings)
            usable &= ~alone & (np.abs(radius - np.median(radius)) < settings.fallen_out)
        if np.array_equal(usable, fit.evidence.usable):
            break
        fit = solve(evaluate(fit.chain, fit.free, fit.evidence.masked(usable), fit.setting))
    return fit


def rows_of(evidence: Evidence, raw: BoolArray) -> BoolArray:
    """Rows of the evidence whose raw rows are mostly marked."""
    count = np.bincount(evidence.group)
    return np.asarray(np.bincount(evidence.group, raw) > 0.5 * count)


def without_rows(fit: Fit, raw: BoolArray) -> Fit:
    """The fit without the marked raw rows (n_raw,)."""
    rows = rows_of(fit.evidence, raw)
    if not np.any(rows & fit.evidence.usable):
        return fit
    return solve(evaluate(fit.chain, fit.free, fit.evidence.masked(fit.evidence.usable & ~rows), fit.setting))


def scaled(fit: Fit, variance: Array) -> Fit:
    """The fit with its rows weighed by a variance (n,)."""
    evidence = replace(fit.evidence, scale=row_scale(fit.evidence, variance))
    return solve(evaluate(fit.chain, fit.free, evidence, fit.setting))


def raw_residual(fit: Fit, sweep: Sweep) -> Array:
    """Residual [rad] of every raw reading (n_raw,) against the fit."""
    if len(sweep) == len(fit.evidence):
        return np.asarray(fit.residual[0])
    predicted: Array = fit.linear.angle[fit.evidence.group] + fit.evidence.ahead
    return wrap(np.radians(sweep.measured_deg) - predicted)
