"""Is a cause there in the batch? Tests over all devices, for what is too weak to be named on any one of them.

On each device a candidate has coefficients with errors. Three ways in which a batch may share it are tried. With the
same size and phase on all devices, counted from the reference's zero or from the sensor's own, their mean differs from
zero; this is Hotelling's test with the devices' own scatter, which supposes nothing about the noise. With a phase of
its own on each device the mean is zero, but the estimates from two halves of the readings agree: the mean of their
product differs from zero, whatever the noise is, as the errors of the halves are independent.

Before they are averaged the figures are put in units of their errors and drawn in towards zero beyond two of their
usual sizes (Huber's function), so that no single odd device decides or hides anything. That leaves the tests as they
are, as it leaves a mean of zero at zero.

References: Hotelling (1931), Ann. Math. Statist. 2, 360; Huber (1981), Robust Statistics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.population.candidates import Candidate
from diagnosis.population.false_discovery import believed
from twin.angles import Array
from twin.effect import BoolArray

FALSE_SHARE = 0.01
"""Share of false ones among all causes that are said of a batch: the search for causes of one device has the same."""
_USUAL = 2.0
"""Beyond so many of their usual sizes figures count no more: of normal ones this keeps 99 % of their information."""
FEWEST_DEVICES = 8
"""Devices below which the scatter is too little known for a test of several coefficients."""
_LEAKED = 0.1
"""Share of a candidate's evidence that a stronger one may have made: the rest still stands by itself."""
_DECIDED = float(np.log(1000.0))
"""Log of the odds from which of two causes one is right, as for a device's mirror image."""

REFERENCE, SENSOR, OWN = "reference", "sensor", "own"
"""From where the phase is counted that all devices share; or each device has its own."""
WAYS = (REFERENCE, SENSOR, OWN)


@dataclass(frozen=True, eq=False, kw_only=True)
class Figures:
    """A candidate's coefficients over devices: (N, T), from each half (2, N, T), errors (N,); NaN where not seen.

    ``turned`` (N,) is by how much a phase counted from the sensor's zero is less than one from the reference's [rad];
    None where the candidate is no line or all zeros are alike. Only a ``line`` has a phase, which may be each device's
    own; any other cause that devices share has a mean.
    """

    line: bool
    values: Array
    halves: Array
    errors: Array
    turned: Array | None = None

    @property
    def seen(self) -> BoolArray:
        """Which devices (N,) show it."""
        return np.asarray(np.isfinite(self.errors) & np.isfinite(self.halves).all(axis=(0, 2)))

    def counted_from(self, where: str) -> Array:
        """The coefficients (N, T) with phases from the reference's zero or the sensor's."""
        if where != SENSOR or self.turned is None:
            return self.values
        # A strength at phase 0 and at 90 deg: a wave of the phase p has the coefficients (cos p, sin p).
        turned = (self.values[:, 0] + 1j * self.values[:, 1]) * np.exp(-1j * self.turned)
        return np.stack([turned.real, turned.imag], axis=1)


def log_p_of(figures: Figures, sign: int) -> Array:
    """Log p (3,) in the order of :data:`WAYS`: by chance alone the devices agree as well; NaN where not tested."""
    seen = figures.seen
    if np.count_nonzero(seen) < FEWEST_DEVICES:
        return np.full(3, np.nan)
    errors = figures.errors[seen]
    found = [_log_p_of_mean(figures.values[seen] / errors[:, None], sign), np.nan]
    if figures.turned is not None:
        found[1] = _log_p_of_mean(figures.counted_from(SENSOR)[seen] / errors[:, None], sign)
    if not figures.line:
        return np.array([*found, np.nan])
    product = np.einsum("nt,nt->n", *figures.halves[:, seen]) / errors**2
    return np.array([*found, _log_p_of_mean(product[:, None], 1)])


def together(log_p: Array) -> Array:
    """Log p (C,) of candidates from those of the ways (C, 3) in which each was tried: at most their number times."""
    tried = np.count_nonzero(~np.isnan(log_p), axis=1)
    least = np.where(tried > 0, np.nanmin(np.where(np.isnan(log_p), np.inf, log_p), axis=1), np.nan)
    with np.errstate(divide="ignore"):
        return np.asarray(np.minimum(least + np.log(tried), 0.0))


def newly_found(log_p: Array, overlaps: Array, *, devices: int, share: float = FALSE_SHARE) -> list[int]:
    """Places of the candidates (C,) that are believed, strongest first, and not because of a stronger one.

    ``overlaps`` (C, C) are cosines: a candidate shows the square of it of another's evidence, which is the squared
    distance of Hotelling's test that has this probability.
    """
    evidence = devices * np.expm1(-2.0 * np.where(np.isnan(log_p), 0.0, log_p) / devices)
    chosen: list[int] = []
    sure = believed(log_p, share)
    for place in np.argsort(np.where(np.isnan(log_p), np.inf, log_p), kind="stable"):
        if not sure[place]:
            break
        leaked = [overlaps[place, other] ** 2 * evidence[other] for other in chosen]
        if max(leaked, default=0.0) <= _LEAKED * evidence[place]:
            chosen.append(int(place))
    return chosen


def not_told_from(place: int, log_p: Array, candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Other causes that say of the batch nearly as much as the candidate, and those that are the same on the motion."""
    own = candidates[place]
    near = np.flatnonzero(log_p < log_p[place] + _DECIDED) if np.isfinite(log_p[place]) else np.array([], dtype=int)
    names = [*own.same, *(candidates[other].effect for other in near)]
    return tuple(name for name in dict.fromkeys(names) if name != own.effect)


def _log_p_of_mean(values: Array, sign: int) -> float:
    """Log of the probability that figures (N, T) of mean zero have a mean as large; ``sign``: it must have this one."""
    from scipy.special import chdtri

    count, terms = values.shape
    size = np.linalg.norm(values, axis=1)
    usual = float(np.median(size)) / np.sqrt(chdtri(terms, 0.5))
    if usual == 0.0:
        return 0.0
    limit = _USUAL * usual * np.sqrt(terms)
    drawn = values * np.minimum(1.0, limit / np.maximum(size, 1e-300))[:, None]
    mean, scatter = drawn.mean(axis=0), np.atleast_2d(np.cov(drawn.T))
    if sign and mean[0] * sign <= 0.0:
        return 0.0
    square = count * float(mean @ np.linalg.solve(scatter + 1e-12 * np.trace(scatter) * np.eye(terms), mean))
    log_p = float(log_probability(np.array(count * np.log1p(square / (count - 1))), terms, count))
    return log_p - np.log(2.0) if sign else log_p
