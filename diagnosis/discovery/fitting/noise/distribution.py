"""The distribution of whitened readings: heavy tails, and an RMS that depends on the conditions, by likelihood ratio.

The readings are drawn from Student's t distribution (Gaussian where its degrees of freedom are infinite) and the
logarithm of their scale is linear in the conditions. The two are judged together: uneven noise has heavy tails, and a
few wild readings look like uneven noise. Estimated by Fisher scoring (K. L. Lange, R. J. A. Little, J. M. G. Taylor,
J. Am. Stat. Assoc. 84 (1989) 881), the degrees of freedom by their profile likelihood.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from twin.angles import Array

TAIL = "tail"
_HEAVIEST = 0.45
"""Largest inverse of the degrees of freedom: below two of these there is no variance."""
_LIGHTEST = 1e-4
_RESOLUTION = 2e-3
"""Of the inverse degrees of freedom: a tenth of what 4000 readings tell of it."""
_GOLDEN = 0.5 * (5.0**0.5 - 1.0)
_STEPS = 20


@dataclass(frozen=True)
class Distribution:
    """A fitted distribution: ``log_likelihood`` [nats], its parts, and the readings' scale.

    ``inverse_dof`` is 1 over the degrees of freedom, 0 for Gaussian readings. ``log_scale`` is the logarithm of the
    scale where all conditions are zero, ``slopes`` its slopes (terms,) on each condition in the model.
    """

    log_likelihood: float
    inverse_dof: float
    log_scale: float
    slopes: Mapping[str, Array] = field(default_factory=dict)

    @property
    def dof(self) -> float:
        """Degrees of freedom; infinite: Gaussian."""
        return 1.0 / self.inverse_dof if self.inverse_dof > 0.0 else np.inf

    @property
    def rms(self) -> float:
        """RMS of a reading where all conditions are zero."""
        return float(np.exp(self.log_scale) / np.sqrt(1.0 - 2.0 * self.inverse_dof))

    @property
    def parts(self) -> tuple[str, ...]:
        """What it holds beyond even Gaussian noise."""
        return (*((TAIL,) if self.inverse_dof > 0.0 else ()), *self.slopes)


def distribution(readings: Array, conditions: Mapping[str, Array], *, limit: float, log_p: float) -> Distribution:
    """What readings show of heavy tails and of a scale that depends on the conditions.

    Parameters
    ----------
    readings : ndarray, shape (n,)
        Independent readings of mean zero.
    conditions : mapping of str to ndarray, shape (terms, n)
        What the logarithm of their scale may be proportional to.
    limit : float
        Readings farther out are not looked at: such ones may have been set aside before.
    log_p : float
        Log probability by chance below which a part is taken into the model.

    Returns
    -------
    Distribution
        With the parts that the likelihood ratio calls for, added one by one and each judged again beside the others.
    """
    inside = np.abs(readings) < limit
    model = _Model(readings[inside], {name: rows[:, inside] for name, rows in conditions.items()}, limit)
    found = model.fitted(())
    offered = (TAIL, *conditions)
    while len(found.parts) < len(offered):
        wider = [model.fitted((*found.parts, part)) for part in offered if part not in found.parts]
        chances = [model.chance(found, one) for one in wider]
        if min(chances) > log_p:
            break
        found = wider[int(np.argmin(chances))]
    while found.parts:
        narrower = [model.fitted(tuple(other for other in found.parts if other != part)) for part in found.parts]
        chances = [model.chance(one, found) for one in narrower]
        if max(chances) <= log_p:
            break
        found = narrower[int(np.argmax(chances))]
    return found


@dataclass(frozen=True, eq=False)
class _Model:
    """Readings (n,) that lie within a limit, and the conditions (terms, n) of each."""

    readings: Array
    conditions: Mapping[str, Array]
    limit: float

    def fitted(self, parts: tuple[str, ...]) -> Distribution:
        """The likeliest distribution with these parts."""
        names = [name for name in self.conditions if name in parts]
        design = np.concatenate([np.ones((1, self.readings.size)), *(self.conditions[name] for name in names)])
        gaussian = self._scored(design, 0.0)
        inverse_dof = 0.0
        if TAIL in parts and self._peaked(design, gaussian):
            inverse_dof = _peak_of(lambda one: self._log_likelihood(design, self._scored(design, one), one))
        slopes = self._scored(design, inverse_dof) if inverse_dof else gaussian
        ends = np.cumsum([1, *(len(self.conditions[name]) for name in names)])
        return Distribution(
            self._log_likelihood(design, slopes, inverse_dof),
            inverse_dof,
            float(slopes[0]),
            {name: slopes[start:end] for name, start, end in zip(names, ends[:-1], ends[1:], strict=True)},
        )

    def chance(self, narrow: Distribution, wide: Distribution) -> float:
        """Log probability that readings of the narrow distribution favour the wide one, of one part more, as much."""
        from scipy.special import chdtrc, log_ndtr

        gain = 2.0 * max(wide.log_likelihood - narrow.log_likelihood, 0.0)
        added = next((part for part in wide.parts if part not in narrow.parts), TAIL)
        if added == TAIL:
            # At the edge of the parameter's range: half a chi-square of one degree.
            return float(log_ndtr(-np.sqrt(gain)))
        return float(np.log(max(chdtrc(len(self.conditions[added]), gain), 1e-300)))

    def _peaked(self, design: Array, slopes: Array) -> bool:
        """Whether the likelihood rises at all as the degrees of freedom come down from infinity."""
        return bool(np.mean((self.readings / np.exp(slopes @ design)) ** 4) > 3.0)

    def _scored(self, design: Array, inverse_dof: float) -> Array:
        """The likeliest slopes (terms,) of the log scale for these degrees of freedom."""
        # Conditions that go together (a speed for each direction) are told apart no further.
        inverse = np.linalg.pinv(design @ design.T, rcond=1e-12, hermitian=True)
        slopes = np.zeros(len(design))
        slopes[0] = 0.5 * np.log(np.mean(self.readings**2))
        for _ in range(_STEPS):
            square = (self.readings / np.exp(slopes @ design)) ** 2
            weight = (1.0 + inverse_dof) / (1.0 + inverse_dof * square)
            score = design @ (weight * square - 1.0)
            step = inverse @ score * (1.0 + 3.0 * inverse_dof) / 2.0
            slopes = slopes + step * min(1.0, 1.0 / max(float(np.max(np.abs(step @ design))), 1e-300))
            if float(score @ step) < 1e-8:
                break
        return slopes

    def _log_likelihood(self, design: Array, slopes: Array, inverse_dof: float) -> float:
        """Log likelihood of readings that are looked at only within the limit."""
        log_scale = slopes @ design
        square = (self.readings / np.exp(log_scale)) ** 2
        edge = self.limit / float(np.exp(np.mean(log_scale)))
        density, beyond = _student(square, edge, inverse_dof)
        return density - float(np.sum(log_scale)) - self.readings.size * float(np.log1p(-beyond))


def _peak_of(likelihood: Callable[[float], float]) -> float:
    """The inverse degrees of freedom of the highest log likelihood, by golden sections (J. Kiefer, Proc. Am. Math. Soc.
    4 (1953) 502)."""
    low, high = _LIGHTEST, _HEAVIEST
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left, at_right = likelihood(left), likelihood(right)
    while high - low > _RESOLUTION:
        if at_left > at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left = likelihood(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right = likelihood(right)
    return 0.5 * (low + high)


def _student(square: Array, edge: float, inverse_dof: float) -> tuple[float, float]:
    """Log density of readings of unit scale with these squares (n,), summed, and the probability beyond an edge."""
    from scipy.special import gammaln, ndtr, stdtr

    if inverse_dof < _LIGHTEST:
        return float(-0.5 * np.sum(square) - 0.5 * square.size * np.log(2.0 * np.pi)), float(2.0 * ndtr(-edge))
    dof = 1.0 / inverse_dof
    norm = gammaln(0.5 * (dof + 1.0)) - gammaln(0.5 * dof) - 0.5 * np.log(np.pi * dof)
    return (
        float(square.size * norm - 0.5 * (dof + 1.0) * np.sum(np.log1p(inverse_dof * square))),
        float(2.0 * stdtr(dof, -edge)),
    )
