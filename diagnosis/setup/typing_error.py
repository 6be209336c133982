"""Gross errors of single rows in small tables, as of a number mistyped."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding, rows_shown
from diagnosis.setup.harmonics import FALSE_ALARM, waves
from diagnosis.setup.record import Record
from twin.angles import Array, IntArray

_MOST_ROWS = 100
"""Tables that a person writes; of longer ones single wild readings are the search's."""
_FEWEST_ROWS = 14
_MOST_WRONG = 2
_TIMES = 4.0
"""Without the row the rest must fit so many times better."""


def typing_error(record: Record) -> Finding | None:
    """A row or two that do not fit the low orders of the others."""
    relation = record.relation
    if relation is None or not relation.follows or not _FEWEST_ROWS <= record.both.size <= _MOST_ROWS:
        return None
    wrong, off = _wrong_rows(np.radians(record.reference_deg), relation.error_at_one_deg)
    if not wrong.size:
        return None
    rows = record.rows(wrong)
    told = ", ".join(
        f"row {row} reads {record.measured_deg[place]:g}, {size:+.2f} deg off"
        for row, place, size in zip(rows, wrong, off, strict=True)
    )
    return Finding(
        kind="typing_error",
        what=f"a gross error in {rows_shown(rows)}, as of a number mistyped",
        evidence=f"{told} from the orders that all other rows agree on",
        consequence="a single such row is spread over all orders, and over a correction made of them",
        remedy="look the row up, correct it or leave its cell empty",
        rows=rows,
    )


def _wrong_rows(shaft_rad: Array, error_deg: Array) -> tuple[IntArray, Array]:
    """Places of up to two rows that all others contradict, and by how much each is off."""
    from scipy.stats import t

    n = error_deg.size
    nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
    best = nothing
    for highest in (1, 2, 3, 4):
        if 2 * highest + 1 > n // 2:
            break
        design = np.stack([np.ones(n), *waves(shaft_rad, range(1, highest + 1))], axis=1)
        out: list[int] = []
        sigma = _sigma(design, error_deg, out)
        for _ in range(_MOST_WRONG + 1):
            place, score = _worst(design, error_deg, out)
            free = n - len(out) - design.shape[1] - 1
            if free < 3 or float(t.sf(score, free)) * 2.0 * n * 4.0 > FALSE_ALARM:
                break
            out.append(place)
        if 0 < len(out) <= _MOST_WRONG and _sigma(design, error_deg, out) * _TIMES < sigma:
            kept = np.setdiff1d(np.arange(n), out)
            coefficients = np.linalg.lstsq(design[kept], error_deg[kept], rcond=None)[0]
            places = np.sort(np.array(out))
            best = places, (error_deg - design @ coefficients)[places]
    return best


def _worst(design: Array, error: Array, out: list[int]) -> tuple[int, float]:
    """The row that its fellows contradict most, by its externally studentised residual."""
    kept = np.setdiff1d(np.arange(error.size), out)
    part, values = design[kept], error[kept]
    hat = np.einsum("ij,ji->i", part, np.linalg.pinv(part))
    left = values - part @ np.linalg.lstsq(part, values, rcond=None)[0]
    free = kept.size - design.shape[1]
    total = float(np.sum(left**2))
    room = np.maximum(1.0 - hat, 1e-9)
    without = np.maximum(total - left**2 / room, 1e-24) / max(free - 1, 1)
    score = np.abs(left) / np.sqrt(room * without)
    worst = int(np.argmax(score))
    return int(kept[worst]), float(score[worst])


def _sigma(design: Array, error: Array, out: list[int]) -> float:
    kept = np.setdiff1d(np.arange(error.size), out)
    left = error[kept] - design[kept] @ np.linalg.lstsq(design[kept], error[kept], rcond=None)[0]
    return float(np.sqrt(np.sum(left**2) / max(kept.size - design.shape[1], 1)))
