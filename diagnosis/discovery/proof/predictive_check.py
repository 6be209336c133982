"""Likeness: whether sweeps simulated from the extended twin can be told from the measured one.

Residuals are simulated with the twin's noise (its colour, its tails, its dependence on the rows, the stairs behind it)
on the measured motion, and are fitted as the measured one was: to first order, by the same projection off the fit's
Jacobian. A set of statistics of their distribution and their correlation then stands beside the measured ones. The
p-value is the rank of the worst of them, the same for every sweep: an exact test if all are exchangeable (Barnard's
Monte Carlo test: J. R. Stat. Soc. B 25 (1963) 294).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from diagnosis.discovery.fitting.coefficients import to_cosine, to_rows
from diagnosis.discovery.fitting.joint_fit import Fit, root_weights
from diagnosis.discovery.fitting.noise.rounding import ahead_of_stairs
from diagnosis.discovery.proof.bootstrap import noise_of, row_scale, simulated
from twin.angles import TAU, Array, IntArray
from twin.noise.description import Noise

_BINS = 360
_COARSE = 12
_HIGHEST_ORDER = 90
_LAGS = (2, 3, 4, 5, 8, 13, 21, 34)
_BLOCKS = 24
_CHUNK = 1_500_000
"""Numbers in one array while sweeps are simulated: 12 MB."""
_LEAST_SPREAD = 1e-3
"""Smallest spread that a statistic is credited with: any that is not projected away scatters more."""


@dataclass(frozen=True)
class PredictiveCheck:
    """``p``: how often a sweep simulated from the twin stands out as much as the measured one.

    ``worst`` says in words which statistic of the measured one stands out most, ``worst_sigma`` by how much.
    """

    p: float
    worst: str
    worst_sigma: float


def likeness(fit: Fit, *, rng: np.random.Generator, noise: Noise | None = None) -> PredictiveCheck | None:
    """Hold the measured residual of a fit against simulated ones; ``noise``: its noise, estimated if not given.

    None where there are too few readings, or nothing but digits is left.
    """
    if why_not_checked(fit) is not None:
        return None
    use = fit.observations.usable
    noise = noise or noise_of(fit)
    plan = _Plan.of(fit)
    weight = 1.0 / np.sqrt(fit.observations.spectrum(noise))
    scale = row_scale(fit, noise)

    def whitened(coefficients: Array) -> Array:
        return to_rows(fit.observations, coefficients * weight) / scale

    refit = _Refit.of(fit)
    names, measured = plan.statistics(whitened(refit.settled(fit.cosine_residual[0])[None]))
    table = [measured]
    ahead = ahead_of_stairs(fit, noise)
    to_come = fit.settings.predictive_sweeps
    while to_come > 0:
        count = min(to_come, max(_CHUNK // len(use), 1))
        residual = to_cosine(fit.observations, simulated(fit, ahead, count=count, rng=rng))
        table.append(plan.statistics(whitened(refit(residual, rng)))[1])
        to_come -= count
    scores = _standardised(np.concatenate(table))
    together = scores.max(axis=1)
    worst = int(np.argmax(scores[0]))
    rank = 1 + int(np.count_nonzero(together[1:] >= together[0]))
    return PredictiveCheck(rank / len(scores), names[worst], float(scores[0, worst]))


class NotChecked(NamedTuple):
    """Why a fit is not held against simulated sweeps; ``needed``: so many ``readings`` it takes, None: not for them."""

    why: str
    readings: int
    needed: int | None


def why_not_checked(fit: Fit) -> NotChecked | None:
    """Why simulated sweeps would say nothing of a fit; None where they do."""
    needed = fit.settings.fewest_checked + len(fit.free)
    if fit.rows < needed:
        return NotChecked("too few beside the fitted parameters", fit.rows, needed)
    smallest = float(np.radians(fit.settings.smallest_rms_deg))
    left = fit.residual[0][fit.observations.usable]
    # Less than the noise ahead of the stairs: no reading lies near an edge, and only the file's digits are left.
    if np.mean(left**2) < max(smallest, 0.9 * fit.weighting.blur) ** 2:
        return NotChecked("nothing but the digits of the readings is left", fit.rows, None)
    return None


# ---- the fit's own projection ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Refit:
    """The fit's projection: residuals lose what the free parameters would have taken up."""

    root: Array
    rows: Array
    elsewhere: Array
    pull: Array
    behind: Array

    @classmethod
    def of(cls, fit: Fit) -> _Refit:
        r, j = fit.whitened()
        norm = np.linalg.norm(j, axis=1, keepdims=True)
        _, size, right = np.linalg.svd(j / np.where(norm > 0.0, norm, 1.0), full_matrices=False)
        right = right[size > 1e-7 * size.max(initial=0.0)]
        n = len(fit.observations)
        # The radius has noise of its own, which moves the parameters too; the turns' zeros are the twin's.
        radius = slice(n, n * fit.observations.observables)
        sigma = float(np.sqrt(np.mean(r[radius] ** 2))) if fit.observations.observables == 2 else 0.0
        square = right[:, radius] @ right[:, radius].T
        values, vectors = np.linalg.eigh(square)
        elsewhere = sigma * vectors * np.sqrt(np.maximum(values, 0.0))
        pull = right[:, n * fit.observations.observables :] @ fit.prior_residual
        return cls(
            root_weights(fit.weighting, fit.observations.observables)[0], right[:, :n], elsewhere, pull, right @ r
        )

    def settled(self, coefficients: Array) -> Array:
        """The fit's own cosine coefficients (n,) after the last fraction of a step that its solver has left undone."""
        return np.asarray(coefficients - (self.behind @ self.rows) / self.root)

    def __call__(self, coefficients: Array, rng: np.random.Generator) -> Array:
        """Cosine coefficients (count, n) of residuals before the fit -> after it."""
        white = coefficients * self.root
        along = white @ self.rows.T + self.pull + rng.standard_normal((len(white), len(self.rows))) @ self.elsewhere.T
        return np.asarray((white - along @ self.rows) / self.root)


# ---- statistics ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Plan:
    """What the statistics of a motion's residuals need: rows in use, conditions, and angle bins."""

    use: IntArray
    order: IntArray
    starts: IntArray
    filled: IntArray
    counts: Array
    weights: dict[str, Array]
    turn_starts: IntArray
    block_starts: IntArray

    @classmethod
    def of(cls, fit: Fit) -> _Plan:
        motion = fit.observations.motion
        use = np.flatnonzero(fit.observations.usable)
        place = (np.floor(motion.shaft_rad[use] * (_BINS / TAU)).astype(np.int64)) % _BINS
        order = np.argsort(place, kind="stable")
        filled, starts, counts = np.unique(place[order], return_index=True, return_counts=True)
        weights: dict[str, Array] = {}
        if "both directions" in motion.provides:
            weights["direction"] = motion.direction
        if "two speeds" in motion.provides:
            weights["speed"] = motion.speed_rad_s
        if "two temperatures" in motion.provides:
            weights["temperature"] = motion.temperature_c - np.mean(motion.temperature_c)
        # The rows in use may all be of one kind.
        weights = {name: w[use][order] / np.sqrt(np.mean(w[use] ** 2)) for name, w in weights.items() if w[use].any()}
        turn = motion.turn if "two turns" in motion.provides else np.floor(motion.travel_rad / TAU).astype(np.int64)
        turn_starts: IntArray = np.flatnonzero(np.diff(turn[use], prepend=-1)).astype(np.int64)
        blocks: IntArray = np.unique(np.arange(_BLOCKS) * use.size // _BLOCKS)
        share = counts.astype(np.float64)
        return cls(use, order, starts, filled, share, weights, turn_starts, blocks)

    def statistics(self, white: Array) -> tuple[list[str], Array]:
        """Names, and statistics (count, J) of whitened residuals (count, n), each near to normal; high is odd.

        Those that may be odd at either end stand twice, once with each sign.
        """
        z = white[:, self.use]
        z = z / np.sqrt(np.mean(z**2, axis=1, keepdims=True))
        found = [*self._distribution(z), *self._sequence(z), *self._angle(z)]
        return [name for name, _ in found], np.stack([values for _, values in found], axis=1)

    def _distribution(self, z: Array) -> Iterator[tuple[str, Array]]:
        size = np.abs(z)
        square = z * z
        skew = np.mean(np.clip(square, 0.0, 16.0) * z, axis=1)
        yield "the residual leans to one side", np.abs(skew)
        tails = np.log(np.mean(np.minimum(square * square, 6.0**4), axis=1))
        yield "the residual has heavier tails", tails
        yield "the residual has lighter tails", -tails
        middle = np.mean(size, axis=1)
        yield "the residual is more peaked", -middle
        yield "the residual is flatter", middle
        yield "single readings stand out", np.log(np.max(size, axis=1))

    def _sequence(self, z: Array) -> Iterator[tuple[str, Array]]:
        n = z.shape[1]
        first = np.mean(z[:, 1:] * z[:, :-1], axis=1)
        yield "neighbouring readings are more alike", first
        yield "neighbouring readings are less alike", -first
        lags = [np.mean(z[:, lag:] * z[:, :-lag], axis=1) for lag in _LAGS if lag < n // 4]
        yield "readings some rows apart are correlated", _root(n * sum((r**2 for r in lags), start=np.zeros(len(z))))
        path = np.cumsum(z, axis=1)
        yield "the zero wanders or jumps along the record", np.log(np.ptp(path, axis=1))
        if self.turn_starts.size > 1:
            yield "the turns' zeros scatter", _scatter(z, self.turn_starts)
        loud = np.minimum(z * z, 9.0)
        loud -= np.mean(loud, axis=1, keepdims=True)
        yield "the scatter changes along the record", _scatter(loud, self.block_starts)

    def _angle(self, z: Array) -> Iterator[tuple[str, Array]]:
        in_order = z[:, self.order]
        sums = self._binned(in_order)
        power = np.abs(np.fft.rfft(sums, axis=1)[:, 1 : _HIGHEST_ORDER + 1]) ** 2
        yield "an order of the turn stands out", np.log(np.max(power, axis=1))
        coarse, share = _coarse(sums), _COARSE / z.shape[1]
        counts = np.zeros(_BINS)
        counts[self.filled] = self.counts
        # Only pairs of readings: what a reading has in common with itself says nothing.
        fine = sums**2 - self._binned(in_order**2)
        yield "readings at one angle are alike", np.sum(fine / np.maximum(counts, 1.0), axis=1)
        yield "the residual depends on the angle", _root(np.sum(coarse**2, axis=1) * share)
        loud = np.minimum(in_order**2, 9.0)
        loud -= np.mean(loud, axis=1, keepdims=True)
        lines = np.abs(np.fft.rfft(self._binned(loud), axis=1)[:, 1:5]) ** 2
        yield "the scatter depends on the angle", _root(np.sum(lines, axis=1) / z.shape[1])
        for name, weight in self.weights.items():
            yield (
                f"the residual depends on the {name}",
                _root(share * np.sum(_coarse(self._binned(in_order * weight)) ** 2, axis=1)),
            )
            yield f"the scatter depends on the {name}", np.abs(loud @ weight)

    def _binned(self, in_order: Array) -> Array:
        """Sums (count, bins) of rows (count, n) in the order of the angle."""
        out = np.zeros((len(in_order), _BINS))
        out[:, self.filled] = np.add.reduceat(in_order, self.starts, axis=1)
        return out


def _coarse(sums: Array) -> Array:
    return np.asarray(sums.reshape(len(sums), _COARSE, -1).sum(axis=2))


def _root(squares: Array) -> Array:
    """Sums of squares made near to normal; those that the fit has left nothing of are all alike."""
    return np.asarray(np.cbrt(1.0 + squares))


def _scatter(rows: Array, starts: IntArray) -> Array:
    """Summed squares of the stretches' sums, each per reading."""
    lengths = np.diff(np.append(starts, rows.shape[1]))
    return _root(np.sum(np.add.reduceat(rows, starts, axis=1) ** 2 / lengths, axis=1))


def _standardised(table: Array) -> Array:
    """Each sweep's statistics (sweeps, J) against mean and spread of all the others'."""
    count = len(table)
    total, square = table.sum(axis=0), (table**2).sum(axis=0)
    mean = (total - table) / (count - 1)
    variance = (square - table**2) / (count - 1) - mean**2
    # What the fit's projection has taken away altogether differs by rounding only.
    return np.asarray((table - mean) / np.sqrt(np.maximum(variance, _LEAST_SPREAD**2)))
