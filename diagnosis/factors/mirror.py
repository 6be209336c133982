"""Which of the two mirror solutions of a sweep is the right one, or that these readings cannot tell.

With both senses swapped, (s, h) to (-s, -h), the point (Vx, Vy, g, beta, q, zero) reads as (Vx, -Vy, g, -beta, q,
-zero) does, exactly where q = 0. The quadratic term alone is no odd function: of order 3 it makes q/4 (-1, -1) in
(sin 3a, cos 3a), the mirrored model q/4 (-1, +1), at right angles to it. So the mirrored fit ends at q near 0, with
all of order 3 left, and is worse by q over its standard error. Whatever else makes an error of order 3 speaks for
either.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from diagnosis.error_model.result import BaselineFit
from twin.angles import Array, cos_sin

By = Literal["quadratic term", "channels", "twin", "option"]
DECIDED_LOG_ODDS = float(np.log(1000.0))
"""Odds from which one of the two is dropped: of a thousand sweeps decided so narrowly one is decided wrongly."""
_NEAR = (4, 5, 6, 7, 8)
"""Orders in which the error model leaves nothing: what stands there shows how much else may stand at order 3."""
_WHOLE_TURN_DEG = 330.0
_READINGS_AN_ORDER = 4
_PIECE = 8192
"""Readings whose cosines are held at once."""


@dataclass(frozen=True)
class KnownSense:
    """In which sense h the output counts, m = h atan2(y, x), and who says so."""

    output: int
    by: By


@dataclass(frozen=True, eq=False)
class Mirror:
    """Who decides between the two, None: nobody; the odds; and the other solution where it fits as well."""

    by: By | None
    log_odds: float | None
    """Of the solution against its mirror image; None where the senses were known."""
    other: BaselineFit | None = None

    @property
    def decided(self) -> bool:
        """Whether there is one solution only."""
        return self.by is not None


def log_odds(fit: BaselineFit, reference_rad: Array, *, counted: BaselineFit, covered_deg: float) -> float:
    """Natural logarithm of the odds of a fit against its mirror image, before any other knowledge of the senses.

    The smaller one of two: against the scatter of the readings, and against the structure that the fit leaves in the
    orders beyond 3. With the variance unknown, of prior density 1/sigma, either is half the degrees of freedom times
    the logarithm of the ratio of the sums of squares. ``counted`` is the fit with the intervals that count, which
    are wider where readings repeat.
    """
    excess = (fit.senses.sigma * fit.standard_errors[0] / counted.standard_errors[0]) ** 2
    white = 0.5 * counted.degrees_of_freedom * float(np.log1p(excess / counted.degrees_of_freedom))
    used = ~fit.outliers
    shaft, left = reference_rad[used], fit.residual_rad[used]
    orders = np.array((3, *_NEAR))
    if covered_deg < _WHOLE_TURN_DEG or np.unique(np.round(shaft, 6)).size < 2 * _READINGS_AN_ORDER * orders.size:
        return white
    power = _of_orders(shaft, left, orders) ** 2
    # Sines and cosines have a mean square of one half.
    gained = 2.0 * fit.senses.sigma**2 * fit.sigma_rad**2 / left.size
    ratio = 1.0 + gained / max(float(power.sum()), 1e-300)
    return min(white, 0.5 * (2 * len(_NEAR) + 1) * float(np.log(ratio)))


def _of_orders(shaft: Array, left: Array, orders: Array) -> Array:
    """Cosines, then sines, of these orders of the shaft [rad] in what is left, both (n,): least squares, in pieces."""
    gram, pull = np.zeros((2 * orders.size, 2 * orders.size)), np.zeros(2 * orders.size)
    for start in range(0, shaft.size, _PIECE):
        rows = slice(start, start + _PIECE)
        columns = np.concatenate(cos_sin(orders[:, None] * shaft[rows]))
        gram += columns @ columns.T
        pull += columns @ left[rows]
    return np.asarray(np.linalg.lstsq(gram, pull, rcond=None)[0])


def judged(fit: BaselineFit, reference_rad: Array, *, counted: BaselineFit, covered_deg: float) -> Mirror:
    """Whether these readings decide between a fit, whose senses were free, and its mirror image."""
    odds = log_odds(fit, reference_rad, counted=counted, covered_deg=covered_deg)
    return Mirror("quadratic term" if odds > DECIDED_LOG_ODDS else None, odds)
