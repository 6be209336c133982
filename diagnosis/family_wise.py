"""Family-wise false alarms: how strong the best of all effects looks on sweeps simulated from the fitted baseline.

The F test's probability of a cause holds for noise of exactly the family's spectra, for independent looks, and without
stairs. None of this is quite so. So sweeps are simulated from the baseline with the noise that is left (its colour, its
dependence on the rows, the stairs behind it), every effect is screened on each as on the measured one, and the best
score of each is kept. A cause's family-wise probability is the share of them that reach its own score; beyond the
simulated ones their tail is taken to fall off exponentially, as that of a minimum of many probabilities does, and never
faster than a single F test's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.joint_fit import Fit, root_weights
from diagnosis.noise_colour import Colour
from diagnosis.noise_model import to_cosine
from diagnosis.screening import Base, by_chance, gains_of, matched_to
from diagnosis.simulated import ahead_of_stairs, simulated
from diagnosis.spectrum import line_shapes
from diagnosis.trial import HANDICAP
from twin.angles import Array
from twin.catalogue import unnamed
from twin.effect import Effect

SWEEPS = (32, 96)
"""Fewest and most simulated sweeps."""
_NUMBERS = 400_000
"""Numbers in the simulated residuals, between these bounds: the family's sixteen whitened copies take 50 MB."""
TAIL = 0.5
"""Share of the simulated scores that the tail is fitted to."""
PEAKS = 2
"""Lines looked at on each simulated sweep, of each of its spectra: the strongest is among them."""


@dataclass(frozen=True, eq=False)
class FamilyWise:
    """The best scores (sweeps,) on simulated sweeps, lowest first."""

    scores: Array

    @property
    def rate(self) -> float:
        """How fast the tail falls off with a score, 1 at most: what a single F test has."""
        tail = self.scores[: max(int(TAIL * self.scores.size), 2)]
        return min(1.0, (tail.size - 1) / max(float(np.sum(tail[-1] - tail)), 1e-300))

    def log_p(self, score: float) -> float:
        """Log probability that any effect reaches a score on a sweep without a cause."""
        tail = self.scores[max(int(TAIL * self.scores.size), 2) - 1]
        if score >= tail:
            reached = np.count_nonzero(self.scores <= score)
            return float(np.log((1.0 + reached) / (1.0 + self.scores.size)))
        return float(np.log(TAIL) - self.rate * (tail - score))


def weighed(effect: Effect, log_p: Array | float) -> Array | float:
    """The score of an effect: its log probability, with the handicap of a shape without a name.

    What coarse stairs add needs no handicap here: they are simulated.
    """
    return log_p + (HANDICAP if unnamed(effect.name) else 0.0)


def family_wise(
    baseline: Fit, extended: Fit, colour: Colour, effects: Sequence[Effect], *, rng: np.random.Generator
) -> FamilyWise:
    """Simulate the baseline with the noise of the extended fit, and screen ``effects`` on every sweep."""
    base = Base.of(baseline)
    noise = ahead_of_stairs(extended, colour)
    count = int(np.clip(_NUMBERS // len(baseline.evidence), *SWEEPS))
    residuals = np.empty((count, baseline.evidence.observables, len(baseline.evidence)))
    residuals[:, 0] = to_cosine(baseline.evidence, simulated(baseline, noise, count=count, rng=rng))
    if baseline.evidence.observables == 2:
        residuals[:, 1] = _radius(extended, count, rng)
    base = base.with_residuals(residuals)
    # Lines are looked for in what the baseline's own parameters leave.
    member = baseline.setting.member
    left = base.residuals[member][:, : len(baseline.evidence)] / base.roots[member][0]
    best = np.full(count, np.inf)
    for effect in effects:
        best = np.minimum(best, _scores(base, effect, left))
    return FamilyWise(np.sort(best))


def _radius(extended: Fit, count: int, rng: np.random.Generator) -> Array:
    """Cosine coefficients (count, n) of radii with the noise that the extended fit has left there."""
    root = root_weights(extended.setting, 2)[1]
    sigma = float(np.sqrt(np.mean((extended.cosine_residual[1] * root) ** 2)))
    return np.asarray(sigma * rng.standard_normal((count, root.size)) / root)


def _scores(base: Base, effect: Effect, left: Array) -> Array:
    """Best score (sweeps,) of one effect on each of a batch of residuals."""
    fit = base.fit
    if effect.line is None:
        shapes = list(effect.shapes(fit.linear.motion))
        looks = float(len(shapes))
    else:
        picked: dict[tuple[float, ...], Mapping[str, float]] = {}
        looks = 1.0
        for residual, best in zip(left, base.likelihood.argmax(axis=1), strict=True):
            found, tried = line_shapes(matched_to(base, residual, int(best)), fit, effect, peaks=PEAKS)
            picked.update({tuple(shape.values()): shape for shape in found})
            looks = max(looks, tried, float(len(found)))
        shapes = list(picked.values())
    if not shapes:
        return np.full(len(left), np.inf)
    gains, coefficients = gains_of(base, effect, shapes)
    best_gain = gains.max(axis=1)
    log_p = by_chance(base, effect, best_gain, coefficients.shape[2], looks)
    return np.asarray(np.where(best_gain > 0.0, weighed(effect, log_p), np.inf))
