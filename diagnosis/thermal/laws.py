"""The law of each factor over temperature, and the word for it: sensitive, immune, or not told.

*Sensitive*: without a term in the temperature the readings would be less likely than noise allows, at the level of the
whole family of tests (Bonferroni); all other factors have every power meanwhile, so that none stands in for another.
*Immune*: an equivalence test says so. Between any two temperatures of the span the factor moves
the angle by less than the noise floor, in RMS over the turn: two one-sided tests for each pair (Schuirmann 1987),
all of which must reject (Berger 1982), at the level of the family (Holm 1979). *Not told*: neither.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb
from typing import Literal

import numpy as np

from diagnosis.error_model.model import NAMES, Readings
from diagnosis.thermal.evidence import FAMILY_LEVEL, Evidence
from diagnosis.thermal.levels import Span
from diagnosis.thermal.sums import Mask, Model
from twin.angles import TAU, Array
from twin.confidence import student_95
from twin.motion import NOMINAL_C

Verdict = Literal["sensitive", "immune", "not told"]
SENSITIVE: Verdict = "sensitive"
IMMUNE: Verdict = "immune"
NOT_TOLD: Verdict = "not told"
FROM_C = NOMINAL_C
"""Laws count the temperature from here, as the twin's drifts do."""
_ROUNDING = 1e-12
_PAIRS = 9
"""Temperatures over the span between any two of which a factor is asked to stay."""


@dataclass(frozen=True)
class Figure:
    """An estimate with its 95 % interval, in the units of the error model's point."""

    value: float
    low: float
    high: float

    def times(self, by: float) -> Figure:
        """The same in another unit, ``by`` > 0 of which make one of this."""
        return Figure(self.value * by, self.low * by, self.high * by)


@dataclass(frozen=True)
class FactorLaw:
    """One factor over temperature; ``name`` is the error model's, as are the units.

    ``per_power``: per kelvin, per kelvin squared, ..., counted from 25 C. Of a factor that is not sensitive they are
    what a straight line would have, and the correction does not use them.
    """

    name: str
    verdict: Verdict
    at_25: Figure
    per_power: tuple[Figure, ...]
    drift_rad: float
    """RMS over the turn by which the law moves the angle, between the two temperatures where that is largest."""
    drift_below_rad: float
    """What it is less than, but for one chance in a hundred."""
    p_constant: float
    """Probability that a sensor without any drift would show as much of one in any factor."""
    p_drifts: float
    """Probability that a factor which drifts by the noise floor would show as little; over all that were asked."""
    scatters: bool
    """Whether its values stand farther from any law than noise allows; the intervals follow that scatter."""


def select(found: Evidence, power: int, asked: Mask) -> tuple[Mask, Array]:
    """The terms (6, powers) that the readings support, and for each factor (6,) the p-value of having none but 1.

    Each factor is asked while all others have every power, so that none stands in for another; those that are not
    ``asked`` (6,) keep them.
    """
    mask, chance = found.terms.copy(), np.ones(6)
    mask[asked, 1:] = False
    free = [int(k) for k in np.flatnonzero(asked)]
    family = max(len(free) * power, 1)
    for k in free:
        law = found.terms.copy()
        law[k, 1:] = False
        chance[k] = min([1.0, *(family * found.rise(law, k, j) for j in range(1, power + 1))])
        if chance[k] >= FAMILY_LEVEL:
            continue
        highest = 1
        law[k, 1] = True
        while highest < power and family * found.rise(law, k, power) < FAMILY_LEVEL:
            highest += 1
            law[k, highest] = True
        mask[k] = law[k]
    return mask, chance


def judge(found: Evidence, model: Model, power: int, asked: Mask) -> tuple[Mask, tuple[FactorLaw, ...]]:
    """The selected terms (6, powers), and the law of each factor; those not ``asked`` (6,) are not told."""
    mask, chance = select(found, power, asked)
    sensitive = mask[:, 1:].any(axis=1) & asked
    weight = _weight_on_angle(model, found.coefficients)
    largest, below, drifts = _drifts(found, model.span, np.where(sensitive[:, None], mask, found.terms), weight)
    told = np.flatnonzero(asked & ~sensitive)
    drifts[told] = _holm(drifts[told])
    immune = np.isin(np.arange(6), told) & (drifts < FAMILY_LEVEL) & (power > 0)
    factors = []
    for k, name in enumerate(NAMES):
        line = mask.copy()
        line[k, : min(power, 1) + 1] = True
        at_25, *per_power = _figures(found, model.span, line, k)
        factors.append(
            FactorLaw(
                name=name,
                verdict=SENSITIVE if sensitive[k] else IMMUNE if immune[k] else NOT_TOLD,
                at_25=_figures(found, model.span, mask, k)[0] if immune[k] else at_25,
                per_power=tuple(per_power),
                drift_rad=float(largest[k]),
                drift_below_rad=float(below[k]),
                p_constant=float(chance[k]),
                p_drifts=float(drifts[k]) if k in told else 1.0,
                scatters=bool(found.scatters[k]),
            )
        )
    return mask, tuple(factors)


def _drifts(found: Evidence, span: Span, mask: Mask, weight: Array) -> tuple[Array, Array, Array]:
    """Of each factor (6,) the largest drift [rad], what it is below, and the p-value of the noise floor."""
    from scipy.special import stdtr, stdtrit

    powers = span.powers(np.linspace(span.low_c, span.high_c, _PAIRS), mask.shape[1] - 1)
    first, second = np.triu_indices(_PAIRS, 1)
    apart = (powers[:, second] - powers[:, first]).T
    floor = np.sqrt(found.variance)
    largest, below, chance = np.zeros(6), np.zeros(6), np.ones(6)
    for k in range(6):
        value, covariance = _of_factor(found, mask, k)
        moved = weight[k] * np.abs(apart @ value)
        error = weight[k] * _errors(apart, covariance)
        largest[k] = np.max(moved)
        below[k] = np.max(moved + stdtrit(found.freedom[k], 1.0 - FAMILY_LEVEL) * error)
        chance[k] = np.max(stdtr(found.freedom[k], (moved - floor) / error))
    return largest, below, chance


def _figures(found: Evidence, span: Span, mask: Mask, factor: int) -> tuple[Figure, ...]:
    """A factor's value at 25 C and its coefficients per kelvin, per kelvin squared, ... with their intervals."""
    value, covariance = _of_factor(found, mask, factor)
    count = int(np.count_nonzero(mask[factor]))
    turned = from_25(span, mask.shape[1])[:count]
    value, error = turned @ value, _errors(turned, covariance)
    half = student_95(found.freedom[factor]) * error
    return tuple(Figure(float(v), float(v - h), float(v + h)) for v, h in zip(value, half, strict=True))


def law_at(found: Evidence, model: Model, factor: int, temperature_c: Array) -> tuple[Array, Array]:
    """A factor's law (n,) in the model at temperatures (n,) [C], and half of its 95 % interval."""
    value, covariance = _of_factor(found, model.terms, factor)
    powers = model.span.powers(temperature_c, model.terms.shape[1] - 1)
    return value @ powers, student_95(found.freedom[factor]) * _errors(powers.T, covariance)


def _errors(combined: Array, covariance: Array) -> Array:
    """Standard errors (n,) of combinations (n, p) of coefficients; never less than rounding leaves of the terms."""
    square, terms = (
        np.einsum("ij,jk,ik->i", *parts)
        for parts in ((combined, covariance, combined), (abs(combined), abs(covariance), abs(combined)))
    )
    return np.asarray(np.sqrt(np.maximum(square, _ROUNDING * terms + 1e-300)))


def _of_factor(found: Evidence, mask: Mask, factor: int) -> tuple[Array, Array]:
    """Coefficients (powers,) of one factor in the model of the mask, and their covariance, 0 where there is no term."""
    coefficients, covariance = found.solve(mask)
    inside = np.argwhere(mask)[:, 0] == factor
    full = np.zeros((mask.shape[1], mask.shape[1]))
    full[np.ix_(mask[factor], mask[factor])] = covariance[np.ix_(inside, inside)]
    return coefficients[factor], full


def from_25(span: Span, count: int) -> Array:
    """The matrix (count, count) from coefficients of t^j to those of (T - 25 C)^i."""
    away = span.middle_c - FROM_C
    turned = np.zeros((count, count))
    for j in range(count):
        for i in range(j + 1):
            turned[i, j] = comb(j, i) * (-away) ** (j - i) / span.half_K**j
    return turned


def _weight_on_angle(model: Model, coefficients: Array) -> Array:
    """By how much a unit of each factor (6,) moves the angle, in RMS over the turn [rad]."""
    turn = TAU * np.arange(720) / 720
    readings = Readings.of(turn, turn, sensor_sense=model.senses[0], output_sense=model.senses[1])
    slopes = readings.linearised(coefficients[:, 0])[1]
    return np.asarray(np.sqrt(np.mean(slopes**2, axis=-1)))


def _holm(chances: Array) -> Array:
    """p-values (m,) for the family of them all, by Holm's step-down rule."""
    order = np.argsort(chances)
    stepped = np.maximum.accumulate(chances[order] * np.arange(chances.size, 0, -1))
    out = np.empty_like(chances)
    out[order] = np.minimum(stepped, 1.0)
    return out
