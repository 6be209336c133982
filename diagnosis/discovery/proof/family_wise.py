"""Family-wise false alarms: how strong each effect looks on sweeps simulated from the fitted baseline.

The F test's probability of a cause holds for Gaussian noise of exactly the family's spectra, for independent looks, and
without stairs. None of this is quite so, for some effects less than for others: slow noise passes for a drift long
before it passes for an order, and a wild reading for a narrow shape. So sweeps are simulated from the baseline with the
noise that is left (its colour, its tails, its dependence on the rows, the stairs behind it), and every effect is
screened on each as on the measured one. An effect's own simulated scores calibrate its probability; the smallest of
these on each simulated sweep calibrate the probability that any effect reaches it (the single-step minP procedure of
Westfall and Young, Resampling-Based Multiple Testing, 1993). Beyond the simulated scores a tail is taken to fall off
exponentially, and never faster than a single F test's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.coefficients import to_cosine
from diagnosis.discovery.fitting.joint_fit import Fit, root_weights
from diagnosis.discovery.fitting.noise.rounding import ahead_of_stairs
from diagnosis.discovery.proof.bootstrap import simulated
from diagnosis.discovery.search.periodogram import line_shapes
from diagnosis.discovery.search.screening import Base, by_chance, gains_of, matched_to, sharpened
from twin.angles import Array
from twin.effect import Effect
from twin.noise.description import Noise

_NUMBERS = 400_000
"""Numbers in the simulated residuals, between fewest and most sweeps: the family's sixteen whitened copies take 50 MB.
"""
TAIL = 0.5
"""Share of the simulated scores that the tail is fitted to."""
FEWEST = 8
"""Fewest scores that a tail is fitted to."""
SHARPENED = 12
"""Strongest simulated scores whose shape is found as closely as that of the measured sweep: what the others would gain
by it is told by these."""
PEAKS = 2
"""Lines looked at on each simulated sweep, of each of its spectra: the strongest is among them."""


@dataclass(frozen=True, eq=False)
class Tail:
    """Scores (sweeps,) simulated without a cause, lowest first; those of sweeps without any gain are infinite."""

    scores: Array

    @classmethod
    def of(cls, scores: Array) -> Tail:
        """Sort the scores."""
        return cls(np.sort(scores))

    def log_p(self, score: Array) -> Array:
        """Log probabilities that a score is reached without a cause."""
        count = self.scores.size
        reached = np.searchsorted(self.scores, score, side="right")
        ranked = np.log((1.0 + reached) / (1.0 + count))
        tail = self.scores[: int(TAIL * count)]
        tail = tail[np.isfinite(tail)]
        if tail.size < FEWEST:
            # Hardly ever any gain at all: less often than its score says.
            return np.asarray(np.minimum(np.where(reached > 0, ranked, score), 0.0))
        rate = min(1.0, (tail.size - 1) / max(float(np.sum(tail[-1] - tail)), 1e-300))
        beyond = np.log(tail.size / count) - rate * (tail[-1] - score)
        return np.asarray(np.where(score < tail[-1], beyond, ranked))


@dataclass(frozen=True, eq=False)
class FamilyWise:
    """The tails of each effect's scores, by name, and that of the smallest probability among them."""

    tails: Mapping[str, Tail]
    smallest: Tail

    def log_p(self, name: str, score: float) -> float:
        """Log probability that any effect stands out as much as the named one does with this score."""
        return float(self.smallest.log_p(self.tails[name].log_p(np.array(score))))


def family_wise(
    baseline: Fit, extended: Fit, noise: Noise, effects: Sequence[Effect], *, rng: np.random.Generator
) -> FamilyWise:
    """Simulate the baseline with the ``noise`` of the extended fit, and screen ``effects`` on every sweep."""
    base = Base.of(baseline)
    ahead = ahead_of_stairs(extended, noise)
    settings = baseline.settings
    count = int(np.clip(_NUMBERS // len(baseline.observations), settings.fewest_simulated, settings.most_simulated))
    residuals = np.empty((count, baseline.observations.observables, len(baseline.observations)))
    residuals[:, 0] = to_cosine(baseline.observations, simulated(baseline, ahead, count=count, rng=rng))
    if baseline.observations.observables == 2:
        residuals[:, 1] = _radius(extended, count, rng)
    base = base.with_residuals(residuals)
    # Lines are looked for in what the baseline's own parameters leave.
    member = baseline.weighting.member
    left = base.residuals[member][:, : len(baseline.observations)] / base.roots[member][0]
    scores = {effect.name: _scores(base, effect, left) for effect in effects}
    tails = {name: Tail.of(values) for name, values in scores.items()}
    smallest = np.min([tails[name].log_p(values) for name, values in scores.items()], axis=0)
    return FamilyWise(tails, Tail.of(smallest))


def _radius(extended: Fit, count: int, rng: np.random.Generator) -> Array:
    """Cosine coefficients (count, n) of radii with the noise that the extended fit has left there."""
    root = root_weights(extended.weighting, 2)[1]
    sigma = float(np.sqrt(np.mean((extended.cosine_residual[1] * root) ** 2)))
    return np.asarray(sigma * rng.standard_normal((count, root.size)) / root)


def _scores(base: Base, effect: Effect, left: Array) -> Array:
    """Score (sweeps,) of one effect, the log probability of the F test, at its best shape for each residual."""
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
    terms = coefficients.shape[2]
    log_p = by_chance(base, effect, best_gain, terms, looks)
    scores = np.asarray(np.where(best_gain > 0.0, log_p, np.inf))
    strongest = np.argsort(scores)[:SHARPENED]
    strongest = strongest[np.isfinite(scores[strongest])]
    if not strongest.size:
        return scores
    points = sharpened(base.part(strongest), effect, shapes, gains[strongest], coefficients[strongest])
    exact = by_chance(base, effect, np.array([point.gain for point in points]), terms, looks)
    # What falls off as exp(score) is, all moved by independent gains, moved by the log of their mean exponential.
    moved = scores - np.log(np.mean(np.exp(scores[strongest] - exact)))
    moved[strongest] = exact
    return np.asarray(moved)
