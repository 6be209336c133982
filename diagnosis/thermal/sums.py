"""The error model whose factors follow the temperature: residuals, slopes and sums over all readings.

Factor k at a temperature is the sum over j of coefficient[k, j] t^j, with t from -1 to 1 over the span. A model has the
terms (k, j) that a mask (6, powers) names; the slope of a reading with respect to one is t^j times that of the factor.
Beside them stand columns that are linear in the residual: orders of the shaft angle, and what turns its sign with the
direction.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model.model import LOWER_LIMIT, UPPER_LIMIT, Readings
from diagnosis.thermal.levels import Span
from diagnosis.thermal.recording import Recording
from twin.angles import Array, IntArray

Mask = NDArray[np.bool_]
_CHUNK = 8192
_PASSES = 30
_SETTLED = 1e-10
_DIRECTION_ORDERS = np.arange(1, 5)


@dataclass(frozen=True, eq=False)
class Model:
    """A recording, the senses s and h in which sensor and output count, and the terms (6, powers) of the laws."""

    recording: Recording
    senses: tuple[int, int]
    span: Span
    terms: Mask

    @property
    def places(self) -> list[tuple[int, int]]:
        """Factor and power of each term, in the order of the columns."""
        return [(int(k), int(j)) for k, j in np.argwhere(self.terms)]

    @property
    def count(self) -> int:
        """How many terms there are."""
        return int(np.count_nonzero(self.terms))

    def with_terms(self, terms: Mask) -> Model:
        """The same readings under other laws."""
        return replace(self, terms=terms)

    def with_recording(self, recording: Recording) -> Model:
        """Other readings under the same laws."""
        return replace(self, recording=recording)

    def linearised(self, coefficients: Array) -> Iterator[tuple[slice, Array, Array, Array]]:
        """Piece by piece: rows, residual (c,) [rad], slopes of the factors (6, c), powers of the temperature (., c)."""
        rec, (sensor, output) = self.recording, self.senses
        readings = Readings.of(rec.reference_rad, rec.measured_rad, sensor_sense=sensor, output_sense=output)
        for start in range(0, len(rec), _CHUNK):
            rows = slice(start, start + _CHUNK)
            powers = self.span.powers(rec.temperature_c[rows], self.terms.shape[1] - 1)
            points = np.clip((coefficients @ powers).T, LOWER_LIMIT, UPPER_LIMIT)
            residual, slopes = readings.sweeps((rows, None)).linearised(points)
            yield rows, residual[:, 0], slopes[:, :, 0].T, powers

    def residual(self, coefficients: Array) -> Array:
        """h m less the model's (n,) [rad]."""
        return np.concatenate([residual for _, residual, _, _ in self.linearised(coefficients)])

    def columns(self, slopes: Array, powers: Array) -> Array:
        """The columns (terms, c) of the laws."""
        return np.stack([slopes[k] * powers[j] for k, j in self.places])

    def descend(self, coefficients: Array) -> Array:
        """Least squares over the terms alone: coefficients (6, powers) from those given, by Gauss and Newton."""
        found = best = np.where(self.terms, coefficients, 0.0)
        least = np.inf
        for _ in range(_PASSES):
            gram, pull, total = np.zeros((self.count, self.count)), np.zeros(self.count), 0.0
            for _, residual, slopes, powers in self.linearised(found):
                columns = self.columns(slopes, powers)
                gram += columns @ columns.T
                pull += columns @ residual
                total += float(residual @ residual)
            if total >= least:
                break
            best, least = found, total
            step = np.asarray(np.linalg.lstsq(gram, pull, rcond=1e-12)[0])
            found = self.moved(found, step)
            if float(step @ pull) <= _SETTLED * total / max(len(self.recording), 1):
                # The last step is taken unseen: it is shorter than any error bar.
                return found
        return best

    def moved(self, coefficients: Array, step: Array) -> Array:
        """Coefficients (6, powers) after a step (terms,)."""
        out = coefficients.copy()
        out[self.terms] += step
        return out


@dataclass(frozen=True, eq=False)
class Beside:
    """Columns beside the laws: ``orders`` (k,) of the shaft angle; ``directed``: low orders times the direction too."""

    orders: IntArray
    directed: bool = False

    @property
    def count(self) -> int:
        """How many columns there are: the directed ones, then cosines, then sines of the orders."""
        return 2 * int(self.orders.size) + self.directed_count

    @property
    def directed_count(self) -> int:
        """How many of them turn their sign with the direction."""
        return self.directed * (1 + 2 * int(_DIRECTION_ORDERS.size))

    def columns(self, recording: Recording, rows: slice) -> Array:
        """The columns (count, c)."""
        shaft = recording.reference_rad[rows]
        parts = []
        if self.directed:
            low = _DIRECTION_ORDERS[:, None] * shaft
            parts += [np.ones((1, shaft.size)), np.cos(low), np.sin(low)]
            parts = [part * recording.direction[rows] for part in parts]
        waves = self.orders[:, None] * shaft
        return np.concatenate([*parts, np.cos(waves), np.sin(waves)])


@dataclass(frozen=True, eq=False)
class Sums:
    """Normal equations at a point: ``gram`` (p, p) and ``pull`` (p,) of the laws' columns, then those beside them.

    ``squares`` is the sum of squared residuals over ``rows`` readings.
    """

    gram: Array
    pull: Array
    squares: float
    rows: int


def sums(model: Model, coefficients: Array, beside: Beside, extra: Any = None) -> Sums:
    """The normal equations; ``extra`` maps rows and the factors' slopes (6, c) to further columns, which come last."""
    total: Sums | None = None
    for rows, residual, slopes, powers in model.linearised(coefficients):
        parts = [model.columns(slopes, powers), beside.columns(model.recording, rows)]
        columns = np.concatenate(parts if extra is None else [*parts, extra(rows, slopes)])
        piece = Sums(columns @ columns.T, columns @ residual, float(residual @ residual), residual.size)
        total = piece if total is None else _added(total, piece)
    assert total is not None
    return total


def _added(one: Sums, other: Sums) -> Sums:
    return Sums(one.gram + other.gram, one.pull + other.pull, one.squares + other.squares, one.rows + other.rows)
