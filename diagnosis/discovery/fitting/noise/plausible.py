"""Which noises are plausible: judged with all that could be locked to the angle set aside.

Structure that repeats with the angle, left by several causes at once, looks like coloured noise to any one cause. Over
several turns it can be told from noise without naming it: it is projected out, and what is left chooses the noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.discovery.fitting.coefficients import radius_to_cosine, to_cosine
from twin.angles import Array
from twin.motion import NOMINAL_C, Motion

if TYPE_CHECKING:
    from diagnosis.discovery.fitting.joint_fit import Fit
    from diagnosis.discovery.fitting.noise_family import NoiseFamily
    from diagnosis.discovery.fitting.observations import Observations


@lru_cache(maxsize=4)
def plausible_members(fit: Fit) -> tuple[int, ...]:
    """The family members that the noise may be, given the fit's residual; all where there are too few turns to tell.

    A fit is asked once for each rival that it is held against: found once.
    """
    everyone = tuple(range(len(fit.weighting.family.members)))
    motion = fit.observations.motion
    if motion.turns < fit.settings.noise_turns:
        return everyone
    aside = _locked(fit.observations, fit.weighting.family)
    if fit.rows < 4 * (len(aside.shapes) + len(fit.free)):
        return everyone
    score, _ = _scores(fit.cosine_residual[0], aside, fit.cosine_jacobian[:, 0], fit.rows)
    return tuple(int(k) for k in np.flatnonzero(score > score.max() - fit.settings.noise_reach))


@dataclass(frozen=True, eq=False)
class _Aside:
    """Shapes (q, n) set aside, as cosine coefficients of unit length, and their Gram matrices (members, q, q).

    The same for all fits to one set of observations: made once.
    """

    shapes: Array
    family: NoiseFamily

    @classmethod
    def of(cls, columns: Array, family: NoiseFamily) -> _Aside:
        """Set these columns (q, n) aside."""
        return cls(_unit(columns), family)

    @cached_property
    def grams(self) -> Array:
        """By the family's member that whitens them."""
        return np.stack([(self.shapes * weight) @ self.shapes.T for weight in self.family.weights])


def _unit(columns: Array) -> Array:
    """Columns (q, n) of unit length."""
    return np.asarray(columns / np.maximum(np.linalg.norm(columns, axis=1, keepdims=True), 1e-300))


@lru_cache(maxsize=4)
def _locked(observations: Observations, family: NoiseFamily) -> _Aside:
    """What could be locked to the angle, of the angle."""
    return _Aside.of(to_cosine(observations, locked_shapes(observations.motion)), family)


@lru_cache(maxsize=4)
def _locked_in_radius(observations: Observations, family: NoiseFamily) -> _Aside:
    """The same of the radius, which is free of a common size and of the lowest orders."""
    motion = observations.motion
    low = [turned(k * motion.shaft_rad) for k in (1, 2) for turned in (np.cos, np.sin)]
    columns = np.concatenate([np.stack([np.ones(len(motion)), *low]), locked_shapes(motion)])
    return _Aside.of(radius_to_cosine(observations, columns), family)


def either(*members: tuple[int, ...]) -> tuple[int, ...]:
    """The family members that are plausible by any of several fits."""
    return tuple(sorted(set().union(*members)))


def radius_noise(fit: Fit) -> tuple[int, float] | None:
    """Family member and variance of the radius' noise, all that could be locked to the angle set aside.

    None where there are too few rows to set it aside.
    """
    aside = _locked_in_radius(fit.observations, fit.weighting.family)
    if fit.rows < 2 * len(aside.shapes):
        return None
    score, variance = _scores(fit.cosine_residual[1], aside, np.zeros((0, len(fit.observations))), fit.rows)
    best = int(np.argmax(score))
    return best, float(variance[best])


def _scores(residual: Array, aside: _Aside, columns: Array, rows: int) -> tuple[Array, Array]:
    """Restricted log likelihood and variance of each family member, columns (p, n) projected out beside the shapes."""
    own, family, count = _unit(columns), aside.family, len(aside.shapes) + len(columns)
    dof = rows - count
    score, variance = np.empty(len(family.members)), np.empty(len(family.members))
    cost = family.cost(rows)
    gram, along = np.empty((count, count)), np.empty(count)
    for member, weight in enumerate(family.weights):
        white, weighted = own * weight, weight * residual
        across = white @ aside.shapes.T
        gram[: len(own), : len(own)] = white @ own.T
        gram[: len(own), len(own) :], gram[len(own) :, : len(own)] = across, across.T
        gram[len(own) :, len(own) :] = aside.grams[member]
        gram += 1e-9 * np.trace(gram) / count * np.eye(count)
        along[: len(own)], along[len(own) :] = own @ weighted, aside.shapes @ weighted
        left = float(residual @ weighted - along @ np.linalg.solve(gram, along))
        _, log_det = np.linalg.slogdet(gram)
        score[member] = -0.5 * (dof * np.log(max(left, 1e-300)) + cost[member] + log_det)
        variance[member] = left / dof
    return score, variance


def locked_shapes(motion: Motion) -> Array:
    """Shapes (q, n) to set aside: orders 3 to 12, low orders times direction, temperature, speed; a slow drift."""
    highest = int(min(12, motion.points_per_turn / 2.5))
    ones = np.ones(len(motion))
    shapes: list[Array] = []

    def series(orders: range, weight: Array) -> None:
        for k in orders:
            shapes.append(weight * np.cos(k * motion.shaft_rad))
            if k:
                shapes.append(weight * np.sin(k * motion.shaft_rad))

    series(range(3, highest + 1), ones)
    if motion.recordings is not None:
        # What one recording's factors do not take up of the low orders is no noise in another either.
        for number in range(len(motion.recordings)):
            series(range(0, min(3, highest + 1)), (motion.recordings.number == number).astype(np.float64))
    low = range(0, min(8, highest) + 1)
    # A slow drift of the zero is no noise either: the noise's colour is told by what is faster.
    share = np.linspace(0.0, 1.0, len(motion))
    shapes.extend(np.cos(np.pi * mode * share) for mode in (1, 2, 3))
    if "both directions" in motion.provides:
        series(low, motion.direction)
    if "two temperatures" in motion.provides:
        series(low, (motion.temperature_c - NOMINAL_C) / 50.0)
    if "two speeds" in motion.provides:
        series(range(0, min(4, highest) + 1), motion.speed_rad_s / float(np.max(np.abs(motion.speed_rad_s))))
    return np.stack(shapes)
