"""One device among many: its factors, and how large each candidate would be on it, linearised about the fitted model.

The whole sweep gives the estimates. Two halves of it, each made of blocks from all over the record, give them twice
from different readings: their product has no bias by the noise, whatever that is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.error_model.fit import fit_many
from diagnosis.error_model.result import BaselineFit
from diagnosis.population.candidates import MOST_TERMS, Candidate, columns_of, factor_columns
from diagnosis.population.noise import whitened
from twin.angles import Array, radians
from twin.baseline import FACTORS
from twin.effect import BoolArray
from twin.following import slope_of
from twin.sweep import Sweep

BLOCKS = 48
"""Blocks that the rows are divided into, every other one at random to each half: a line's periods fall into both."""
FEWEST_ROWS = 40
"""Rows of a device below which its two halves cannot hold the factors and a candidate each."""
WIDEST_GAP_DEG = 60.0
"""Gap in the turn beyond which factors of order 3 are no longer told from one another."""
_SEEN = 1e-4
"""Share of a candidate's sum of squares beyond what is fitted along, below which a device does not show it."""

Arrays = dict[str, Array]


@dataclass(frozen=True, kw_only=True)
class Question:
    """What every device is asked: all candidates, and those among them (places) that are fitted along.

    ``taken_back``: places of those that were, until others explained what they had. ``noise``: coefficients of the
    autoregression that the noise of all devices is taken for, as they are measured on one bench.
    """

    candidates: tuple[Candidate, ...]
    present: tuple[int, ...] = ()
    taken_back: tuple[int, ...] = ()
    noise: tuple[float, ...] = ()
    output_sense: int = 1
    seed: int = 0

    @property
    def fitted(self) -> int:
        """Number of parameters that are fitted along: the factors, and the coefficients of what is present."""
        return len(FACTORS) + sum(self.candidates[place].terms for place in self.present)


def estimates(sweeps: Sequence[Sweep], question: Question, *, rng: np.random.Generator) -> Arrays:
    """The figures of devices (D, ...) by name; see :func:`_of_device`. ``rng`` is the swarm's."""
    fits = _fits(sweeps, question.output_sense, rng)
    found = [_of_device(sweep, fit, question) for sweep, fit in zip(sweeps, fits, strict=True)]
    return {name: np.array([one[name] for one in found]) for name in blank(question)}


def blank(question: Question) -> Arrays:
    """The figures of a device of which nothing is known."""
    count, size = len(question.candidates), question.fitted
    return {
        "rows": np.array(0.0),
        "left_out": np.array(0.0),
        "sense": np.array(np.nan),
        "sigma_deg": np.array(np.nan),
        "freedom": np.array(np.nan),
        "own_rms_deg": np.array(np.nan),
        "fitted": np.full(size, np.nan),
        "fitted_error": np.full(size, np.nan),
        "fitted_halves": np.full((2, size), np.nan),
        "halves_error": np.full((2, size), np.nan),
        "curvature": np.full((size, size), np.nan),
        "candidate": np.full((count, MOST_TERMS), np.nan),
        "candidate_halves": np.full((2, count, MOST_TERMS), np.nan),
        "candidate_error": np.full(count, np.nan),
        "candidate_square": np.full(count, np.nan),
    }


def left_over(sweeps: Sequence[Sweep], question: Question, *, rng: np.random.Generator) -> list[Array]:
    """What the parameters that are fitted leave of each device's readings (n,) [rad], gross errors left out."""
    left = []
    for sweep, fit in zip(sweeps, _fits(sweeps, question.output_sense, rng), strict=True):
        linear = Linear(fit.chain(), sweep.motion(), blur=0.0, observables=1)
        present = [question.candidates[place] for place in question.present]
        along = np.concatenate([factor_columns(linear), *columns_of(linear, present)])[:, ~fit.outliers]
        residual = fit.residual_rad[~fit.outliers]
        moved, *_ = _solved(along, residual)
        left.append(residual - moved @ along)
    return left


def _fits(sweeps: Sequence[Sweep], output_sense: int, rng: np.random.Generator) -> list[BaselineFit]:
    """The paper's error model fitted to each, the outputs of all counting alike."""
    angles = [(radians(sweep.reference_deg), radians(sweep.measured_deg)) for sweep in sweeps]
    slopes = [slope_of(reference, measured) for reference, measured in angles]
    found: dict[int, BaselineFit] = {}
    for slope in (1, -1):
        chosen = [k for k, one in enumerate(slopes) if one == slope]
        fits = fit_many([angles[k] for k in chosen], rng=rng, robust=True, senses=(slope * output_sense, output_sense))
        found.update(zip(chosen, fits, strict=True))
    return [found[k] for k in range(len(sweeps))]


def _widest_gap_deg(reference_deg: Array) -> float:
    """The widest part of the turn without a reading."""
    angles = np.sort(np.mod(reference_deg, 360.0))
    return float(np.max(np.diff(angles, append=angles[0] + 360.0)))


def _of_device(sweep: Sweep, fit: BaselineFit, question: Question) -> Arrays:
    """The figures of one device.

    ``fitted`` (m,), ``fitted_error`` (m,): factors in the twin's units, then coefficients of what is present, and their
    standard errors; ``fitted_halves`` and ``halves_error`` (2, m) the same from each half. ``curvature`` (m, m)
    [deg^2]: mean square of the readings' change with them. ``candidate`` (C, 2), ``candidate_halves`` (2, C, 2):
    coefficients of each candidate beside what is fitted; ``candidate_error`` (C,) their standard error in the mean of
    their directions, ``candidate_square`` (C,) the square of their size in errors, each direction by its own.
    """
    found = blank(question)
    used = ~fit.outliers
    found["rows"], found["left_out"] = np.array(float(len(sweep))), np.array(float(np.count_nonzero(fit.outliers)))
    found["sense"] = np.array(float(fit.senses.sensor * fit.senses.output))
    too_few = np.count_nonzero(used) < FEWEST_ROWS + 2 * question.fitted
    if too_few or _widest_gap_deg(sweep.reference_deg[used]) > WIDEST_GAP_DEG:
        return found
    linear = Linear(fit.chain(), sweep.motion(), blur=0.0, observables=1)
    provides = linear.motion.provides
    shown = [place for place, one in enumerate(question.candidates) if one.declared.visible_in(provides)]
    if not set(question.present) <= set(shown):
        return found
    of_shown = columns_of(linear, [question.candidates[place] for place in shown])
    columns = np.concatenate([np.zeros((0, len(sweep))), *of_shown])
    ends = np.cumsum([0, *(question.candidates[place].terms for place in shown)])
    places = {place: np.arange(ends[k], ends[k + 1]) for k, place in enumerate(shown)}
    present = np.concatenate([[], *(places[place] for place in question.present)]).astype(int)
    # All in degrees, so that figures are read without thinking of units.
    along = np.degrees(np.concatenate([factor_columns(linear), columns[present]]))
    start = np.concatenate([fit.point * [factor.per_coordinate for factor in FACTORS], np.zeros(present.size)])
    sums = _Sums.of(along, np.degrees(columns), np.degrees(fit.residual_rad), used=used, question=question)
    sums.tell_fitted(found, start)
    sums.tell_candidates(found, places)
    return found


@dataclass(frozen=True, eq=False)
class _Sums:
    """Whitened columns of what is fitted (m, r) and of candidates (c, r), the residual (r,), and the rows of a half.

    ``plain`` (m, n) and ``as_read`` (n,) are the columns of what is fitted and the residual as they are.
    """

    along: Array
    columns: Array
    residual: Array
    first: BoolArray
    plain: Array
    as_read: Array

    @classmethod
    def of(cls, along: Array, columns: Array, residual: Array, *, used: BoolArray, question: Question) -> _Sums:
        """The same from all rows (n,), of which some are not used."""
        noise, inside = np.array(question.noise), used[len(question.noise) :]
        return cls(
            along=whitened(along, noise)[:, inside],
            columns=whitened(columns, noise)[:, inside],
            residual=whitened(np.where(used, residual, 0.0), noise)[inside],
            first=_first_half(residual.size, question.seed)[noise.size :][inside],
            plain=along[:, used],
            as_read=residual[used],
        )

    def tell_fitted(self, found: Arrays, start: Array) -> None:
        """The parameters that are fitted, from all rows and from each half; ``start`` (m,) is where they are linear."""
        moved, variance, left = _solved(self.along, self.residual)
        freedom = self.residual.size - start.size
        sigma2 = left / freedom
        found["fitted"], found["fitted_error"] = start + moved, np.sqrt(sigma2 * variance)
        found["sigma_deg"], found["freedom"] = np.sqrt(np.array(sigma2)), np.array(float(freedom))
        rows = self.plain.shape[1]
        found["curvature"] = self.plain @ self.plain.T / rows
        about = self.as_read - moved @ self.plain
        found["own_rms_deg"] = np.sqrt(about @ about / (rows - start.size))
        for half, inside in enumerate((self.first, ~self.first)):
            of_half, variance, _ = _solved(self.along[:, inside], self.residual[inside])
            found["fitted_halves"][half] = start + of_half
            found["halves_error"][half] = np.sqrt(sigma2 * variance)

    def tell_candidates(self, found: Arrays, places: dict[int, Array]) -> None:
        """Each candidate's coefficients beside what is fitted, from all rows and from each half."""
        for half, inside in ((None, slice(None)), (0, self.first), (1, ~self.first)):
            columns, residual = _beside(self.along[:, inside], self.columns[:, inside], self.residual[inside])
            whole = np.einsum("cr,cr->c", self.columns[:, inside], self.columns[:, inside])
            pulled = columns @ residual
            for terms in range(1, MOST_TERMS + 1):
                chosen = [place for place, rows in places.items() if rows.size == terms]
                rows = np.array([places[place] for place in chosen], dtype=int).reshape(len(chosen), terms)
                own = columns[rows]
                gram = own @ own.transpose(0, 2, 1)
                seen = np.all(np.einsum("ktt->kt", gram) > _SEEN * whole[rows], axis=1)
                inverse = np.linalg.inv(np.where(seen[:, None, None], gram, np.eye(terms)))
                value = np.where(seen[:, None], (inverse @ pulled[rows][..., None])[..., 0], np.nan)
                if half is not None:
                    found["candidate_halves"][half, chosen, :terms] = value
                    continue
                found["candidate"][chosen, :terms] = value
                error = float(found["sigma_deg"]) * np.sqrt(np.einsum("ktt->k", inverse) / terms)
                found["candidate_error"][chosen] = np.where(seen, error, np.nan)
                square = np.einsum("kt,ktu,ku->k", value, gram, value)
                found["candidate_square"][chosen] = square / float(found["sigma_deg"]) ** 2


def _first_half(rows: int, seed: int) -> BoolArray:
    """Which rows (n,) belong to the first half: blocks drawn at random, the same for all devices of this length."""
    count = min(BLOCKS, rows // 4)
    first = np.zeros(count, dtype=bool)
    first[np.random.default_rng([seed, rows]).permutation(count)[: count // 2]] = True
    return np.asarray(first[np.arange(rows) * count // rows])


def _solved(columns: Array, residual: Array) -> tuple[Array, Array, float]:
    """Least squares of residual (r,) on columns (m, r): solution, variances for noise of 1, sum of squares left."""
    scale = np.maximum(np.linalg.norm(columns, axis=1), 1e-300)
    unit = columns / scale[:, None]
    inverse = np.linalg.pinv(unit @ unit.T, rcond=1e-10, hermitian=True)
    solution = inverse @ (unit @ residual)
    left = residual - solution @ unit
    return solution / scale, np.diagonal(inverse) / scale**2, float(left @ left)


def _beside(along: Array, columns: Array, residual: Array) -> tuple[Array, Array]:
    """Columns (c, r) and residual (r,) less their parts that what is fitted (m, r) explains."""
    scale = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    left, values, _ = np.linalg.svd((along / scale).T, full_matrices=False)
    basis = left[:, values > 1e-7 * values[0]]
    return columns - (columns @ basis) @ basis.T, residual - basis @ (basis.T @ residual)
