"""Groups of coefficients that scatter: how much each group does, and the coefficients drawn together by it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from twin.angles import Array, IntArray

_ROUNDS = 60
_STILL = 1e-3
_SINGULAR = 1e-13
"""Share of the largest eigenvalue below which one is rounding."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """Coefficients (p,), their covariance (p, p), and the standard deviation of each (p,) in its group; inf: free."""

    values: Array
    covariance: Array
    sd: Array

    @property
    def told(self) -> Array:
        """How much of each coefficient (p,) the readings tell, from 0, nothing beyond its group, to 1."""
        with np.errstate(invalid="ignore"):
            return np.clip(1.0 - np.diag(self.covariance) / self.sd**2, 0.0, 1.0)


def drawn(normal: Array, gradient: Array, variance: float, *, groups: Sequence[IntArray], sd: Array) -> Drawn:
    """Solve normal equations (p, p) whose coefficients scatter about zero by ``sd`` (p,), infinite: free.

    The standard deviations of the groups set out from there and follow by MacKay's fixed point (Neural Computation 4,
    415, 1992); a group of which the readings tell nothing stays where it set out.
    """
    sd = sd.copy()
    found = solved(normal, gradient, variance, sd)
    for _ in range(_ROUNDS):
        before = sd.copy()
        for group in groups:
            told = float(np.sum(found.told[group]))
            if told > 1e-3 * len(group):
                sd[group] = max(float(np.sqrt(np.sum(found.values[group] ** 2) / told)), 1e-3 * float(before[group[0]]))
        found = solved(normal, gradient, variance, sd)
        held = np.isfinite(sd)
        if np.all(np.abs(np.log(sd[held] / before[held])) < _STILL):
            break
    return found


def solved(normal: Array, gradient: Array, variance: float, sd: Array) -> Drawn:
    """The same with standard deviations that stay as they are."""
    system = normal + np.diag(variance / sd**2)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(system), 1e-300))
    inverse = _inverse(system * np.outer(scale, scale)) * np.outer(scale, scale)
    return Drawn(inverse @ gradient, variance * inverse, sd)


def _inverse(system: Array) -> Array:
    """Of a symmetric matrix with a diagonal of ones; without the directions of which it says next to nothing."""
    from scipy.linalg import eigh
    from scipy.linalg.lapack import dpocon, dpotrf, dpotri

    factor, failed = dpotrf(system, lower=True)
    if not failed and dpocon(factor, float(np.linalg.norm(system, 1)), uplo="L")[0] > _SINGULAR:
        lower, _ = dpotri(factor, lower=True)
        return np.asarray(np.tril(lower) + np.tril(lower, -1).T)
    # By relatively robust representations: divide and conquer does not always end on matrices as near a diagonal one.
    size, turned = eigh(system, driver="evr")
    kept = size > _SINGULAR * size[-1]
    return np.asarray((turned[:, kept] / size[kept]) @ turned[:, kept].T)
