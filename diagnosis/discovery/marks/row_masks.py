"""Single rows: those that stand out alone, those that an effect has touched, and what each leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.observations import Evidence
from diagnosis.discovery.marks import footprints
from diagnosis.discovery.marks.stairs import stair_step
from twin.angles import Array, wrap
from twin.effect import BoolArray
from twin.sweep import Sweep

FALLEN_OUT = 0.2
"""Change of the log of the channels' amplitude that no cause makes."""


def mask_spikes(fit: Fit, step: float, also: BoolArray | None = None) -> tuple[Evidence, Fit]:
    """The fit without the rows that stand out alone; fitted anew where there are any, until the set is stable."""
    for _ in range(4):
        mask, _sigma = footprints.spikes(fit.residual[0], fit.evidence.motion, max(step, stair_step(fit.chain, step)))
        usable = ~mask & fit.evidence.sure
        if fit.evidence.observables == 2:
            # Channels that fall out say nothing true about the radius: alone for a reading, or by more than any cause
            # would change it.
            radius = fit.residual[1]
            alone, _ = footprints.spikes(radius, fit.evidence.motion, 0.0)
            usable &= ~alone & (np.abs(radius - np.median(radius)) < FALLEN_OUT)
        if also is not None:
            usable &= ~rows_of(fit.evidence, also)
        if np.array_equal(usable, fit.evidence.usable):
            break
        fit = solve(evaluate(fit.chain, fit.free, fit.evidence.masked(usable), fit.setting))
    return fit.evidence, fit


def rows_of(evidence: Evidence, raw: BoolArray) -> BoolArray:
    """Rows of the evidence whose raw rows are mostly marked."""
    count = np.bincount(evidence.group)
    return np.asarray(np.bincount(evidence.group, raw) > 0.5 * count)


def without_rows(fit: Fit, raw: BoolArray) -> Fit:
    rows = rows_of(fit.evidence, raw)
    if not np.any(rows & fit.evidence.usable):
        return fit
    return solve(evaluate(fit.chain, fit.free, fit.evidence.masked(fit.evidence.usable & ~rows), fit.setting))


def scaled(fit: Fit, variance: Array) -> Fit:
    evidence = replace(fit.evidence, scale=footprints.row_scale(fit.evidence, variance))
    return solve(evaluate(fit.chain, fit.free, evidence, fit.setting))


def raw_residual(fit: Fit, sweep: Sweep) -> Array:
    """Residual [rad] of every raw reading (n_raw,) against the fit."""
    if len(sweep) == len(fit.evidence):
        return np.asarray(fit.residual[0])
    predicted: Array = fit.linear.angle[fit.evidence.group] + fit.evidence.ahead
    return wrap(np.radians(sweep.measured_deg) - predicted)
