"""From readings at several temperatures to the laws of the factors: the joint fit, step by step."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model.fit import fit_baseline
from diagnosis.error_model.gross_errors import isolated
from diagnosis.error_model.model import ZERO
from diagnosis.error_model.result import BaselineFit
from diagnosis.thermal.evidence import FAMILY_LEVEL, Evidence, evidence
from diagnosis.thermal.laws import SENSITIVE, FactorLaw, judge, law_at
from diagnosis.thermal.levels import Levels, Span, levels_of, widest_gap_rad
from diagnosis.thermal.recording import Recording
from diagnosis.thermal.sums import Beside, Model, sums
from twin.angles import TAU, Array

_FEWEST_ROBUST = 24
_LOWEST_ORDER, _HIGHEST_ORDER = 4, 32
"""Order 3 is the quadratic term's, which could not be told from the offsets by order 1 alone."""
_SAME_RAD = np.radians(1e-4)
_ROUNDS = 3
_COUNTS = 0.25
"""Zeros that scatter by less than this share of the noise, in RMS, hide no drift of the zero that matters."""


@dataclass(frozen=True, eq=False)
class OverTemperature:
    """The factors over temperature. ``model`` holds the readings that were used, and the terms that they support.

    ``coefficients`` (6, powers) are those of the model, in powers of t over its span. ``own_zeros``: the reference
    was set anew on the way, so that what the zero does with temperature cannot be told; the readings of ``model``
    are turned to one zero.
    """

    model: Model
    coefficients: Array
    levels: Levels
    power: int
    factors: tuple[FactorLaw, ...]
    evidence: Evidence
    noise_rad: float
    own_zeros: bool
    gross: NDArray[np.bool_]
    """Gross errors (n,) among all readings of the recording."""
    fit: BaselineFit
    """All readings as if the temperature were one."""

    def band(self, factor: int, temperature_c: Array) -> tuple[Array, Array]:
        """A factor's law (n,) at temperatures (n,) [C], and half of its 95 % interval there."""
        return law_at(self.evidence, self.model, factor, temperature_c)

    @property
    def followed(self) -> NDArray[np.bool_]:
        """The factors (6,) that a correction follows: the sensitive ones."""
        return np.array([law.verdict == SENSITIVE for law in self.factors])


def find_laws(
    recording: Recording, *, rng: np.random.Generator, senses: tuple[int, int] | None = None
) -> OverTemperature:
    """The law of each factor over the temperatures of a recording, at least 8 readings."""
    aligned = recording.with_one_zero()
    own_zeros = aligned is not recording
    fit = fit_baseline(
        aligned.reference_rad, aligned.measured_rad, rng=rng, senses=senses, robust=len(aligned) >= _FEWEST_ROBUST
    )
    span = Span(float(recording.temperature_c.min()), float(recording.temperature_c.max()))
    used = aligned.part(~fit.outliers)
    levels = levels_of(used)
    power = levels.power(span)
    start = np.zeros((6, power + 1))
    start[:, 0] = fit.point
    terms = np.ones((6, power + 1), dtype=bool)
    model = Model(aligned, (fit.senses.sensor, fit.senses.output), span, terms)
    start = model.with_recording(used).descend(start)
    gross = _gross_errors(model, start)
    model = model.with_recording(aligned.part(~gross))
    levels, beside = levels_of(model.recording), beside_of(model.recording)
    model, start, scattered = _with_own_zeros(model, start, beside, forced=own_zeros)
    asked = np.arange(6) != (ZERO if scattered else -1)
    found = evidence(model, start, levels, beside)
    mask, factors = judge(found, model, power, asked)
    chosen = model.with_terms(mask)
    return OverTemperature(
        model=chosen,
        coefficients=chosen.descend(start),
        levels=levels,
        power=power,
        factors=factors,
        evidence=found,
        noise_rad=float(np.sqrt(found.variance)),
        own_zeros=scattered,
        gross=gross,
        fit=fit,
    )


def beside_of(recording: Recording) -> Beside:
    """What is fitted beside the laws: orders that the angles tell apart, and the direction where there are both."""
    angles = np.unique(np.round(np.remainder(recording.reference_rad, TAU) / _SAME_RAD)).size
    # An order whose half period fits into a gap without readings would be told from the laws by nothing.
    highest = min(_HIGHEST_ORDER, angles // 2 - 4, int(np.pi / widest_gap_rad(recording.reference_rad)))
    orders = np.arange(_LOWEST_ORDER, highest + 1)
    return Beside(orders, directed=bool(abs(np.mean(recording.direction)) < 0.9))


def _gross_errors(model: Model, coefficients: Array) -> NDArray[np.bool_]:
    """Mask (n,) of isolated gross errors of the model's readings."""
    n = len(model.recording)
    if n < _FEWEST_ROBUST:
        return np.zeros(n, dtype=bool)
    residual = model.residual(coefficients)[None]
    order = np.argsort(np.remainder(model.recording.reference_rad, TAU), kind="stable")[None]
    first = isolated(residual, order, np.zeros((1, n), dtype=bool))
    return np.asarray(isolated(residual, order, first)[0])


def _with_own_zeros(model: Model, start: Array, beside: Beside, *, forced: bool) -> tuple[Model, Array, bool]:
    """The model with its readings turned to one zero, where the zeros of its units scatter more than their noise.

    Returns the model, its fit, and whether that was so.
    """
    left = _left(model, start, beside)
    if not forced and not _scatter(model, left):
        return model, start, False
    for _ in range(_ROUNDS):
        turned = model.recording.turned(model.senses[0] * model.recording.unit_means(left))
        model = replace(model, recording=turned)
        start = model.descend(start)
        left = _left(model, start, beside)
    return model, start, True


def _scatter(model: Model, left: Array) -> bool:
    """Whether the mean of what is left (n,) differs from unit to unit: surely, and by as much as counts."""
    from scipy.special import fdtrc

    recording = model.recording
    means, count = recording.unit_means(left), np.bincount(recording.unit)
    between, within = int(np.count_nonzero(count)) - model.terms.shape[1] - 1, len(recording) - means.size
    if between < 1 or within < 1:
        return False
    inside = float(np.sum((left - means[recording.unit]) ** 2)) / within
    size = float(np.sum(count * means**2)) / between
    sure = fdtrc(between, within, size / max(inside, 1e-300)) < FAMILY_LEVEL
    return bool(sure and np.sum(count * means**2) > _COUNTS**2 * inside * len(recording))


def _left(model: Model, coefficients: Array, beside: Beside) -> Array:
    """What the laws and the columns beside them leave of each reading (n,) [rad]."""
    total = sums(model, coefficients, beside)
    step = np.linalg.lstsq(total.gram, total.pull, rcond=1e-12)[0]
    p = model.count
    pieces = [
        residual - step[:p] @ model.columns(slopes, powers) - step[p:] @ beside.columns(model.recording, rows)
        for rows, residual, slopes, powers in model.linearised(coefficients)
    ]
    return np.concatenate(pieces)
