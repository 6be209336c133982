"""Two variances of known shapes over the rows, of which one may be none: their likelihood given squared readings."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.fitting.profile import reached
from twin.angles import Array
from twin.confidence import Z95

_STEPS = 8
"""Of Fisher scoring: from a start within a tenth, the square of its error is left by each."""


@dataclass(frozen=True, eq=False)
class TwoVariances:
    """Variance ``base expected + added shape`` of the rows (n,) whose squares are given, both shapes of mean one."""

    square: Array
    expected: Array
    shape: Array
    base: float = 1.0
    added: float = 0.0

    @property
    def variance(self) -> Array:
        """Of each row (n,)."""
        return np.asarray(self.base * self.expected + self.added * self.shape)

    @property
    def deviance(self) -> float:
        """Minus twice the log likelihood of Gaussian noise with these variances, but for a constant."""
        variance = self.variance
        return float(np.sum(np.log(variance) + self.square / variance))

    def fitted(self, ratio: float) -> TwoVariances:
        """Both at their most likely, from a first ratio of the added one to the base."""
        start = float(np.mean(self.square / (self.expected + ratio * self.shape)))
        found: Array = np.array([1.0, ratio]) * start
        parts = np.stack([self.expected, self.shape])
        for _ in range(_STEPS):
            variance = found @ parts
            relative = parts / variance
            # Fisher scoring: the information of a square about its variance is half of one over the variance squared.
            step = np.linalg.solve(relative @ relative.T, relative @ (self.square / variance - 1.0))
            found = np.asarray(np.maximum(found + step, 0.1 * found), dtype=np.float64)
        return replace(self, base=float(found[0]), added=float(found[1]))

    def inflation(self, alike: float) -> float:
        """By how much the variance of the added one's estimate is larger where readings of it are no single ones.

        ``alike`` is the sum of its squared autocorrelations over all lags, what the base is being independent: squares
        correlate by these squares (M. S. Bartlett, Suppl. J. R. Statist. Soc. 8 (1946) 27), and each row counts as it
        tells the added variance.
        """
        share = (self.added * self.shape / self.variance) ** 2
        return float(np.sum(share * (1.0 + share * (alike - 1.0))) / np.sum(share))

    def interval(self, inflation: float) -> tuple[float, float]:
        """95 % interval of the added variance by its profile likelihood, from where both are most likely.

        ``inflation``: by how much deviances are too large for the noise, by its tails or for what readings share. Where
        few rows tell the variance its likelihood is far from a parabola: it may be twice as large, but not nearly none.
        """
        reach = Z95 * float(np.sqrt(inflation))
        least = self.deviance

        def away(way: float, room: float) -> float:
            def root(size: float) -> float:
                return float(np.sqrt(max(self._beside(self.added + way * size).deviance - least, 0.0)))

            return reached(root, min(0.1 * self.added, room), room, reach)

        return self.added - away(-1.0, self.added), self.added + away(1.0, np.inf)

    def _beside(self, added: float) -> TwoVariances:
        """The most likely base beside a given added variance."""
        base = max(self.base + (self.added - added) * float(np.mean(self.shape / self.expected)), 0.1 * self.base)
        for _ in range(_STEPS):
            variance = base * self.expected + added * self.shape
            relative = self.expected / variance
            step = float(relative @ (self.square / variance - 1.0)) / float(relative @ relative)
            base = max(base + step, 0.1 * base)
        return replace(self, base=base, added=added)
