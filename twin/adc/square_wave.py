"""Channels cut off to nearly a square wave, told by the readings themselves.

Where both channels are at their limit the reading is an odd multiple of 45 deg, whatever the angle; only near the axes,
where one of them goes through zero, it turns at all. Nothing that is linear about an uncut sensor leads from there to
the limit, so that a search has to set out from it.
"""

from __future__ import annotations

import numpy as np

from twin.angles import TAU, Array, wrap
from twin.words import WordFault, Words

_LEAST_HELD = 0.36
"""Share of the readings at the four angles from which on this is asked: channels cut off below 0.48 of their
amplitude. Above, the search finds the limit from an uncut sensor."""
_CORNER_RAD = np.radians(2.0)
"""Readings within this of an odd multiple of 45 deg count as held there: a sensor that is not cut off has 4 x 4 of its
360 degrees there."""
_ZEROS, _LEVELS, _ROUNDS = 61, 25, 5
_ROWS = 1500
"""Rows that the grids are held against; of more, one in so many."""
_FIRST_RAD, _FIRST_SHARE = np.radians(12.0), 0.6
_NARROWER = 0.25


def reading(angle: Array, level: float) -> Array:
    """The reading (n,) [rad] of cosine and sine of an angle, both cut off at a level, in amplitudes."""
    return np.asarray(np.arctan2(np.clip(np.sin(angle), -level, level), np.clip(np.cos(angle), -level, level)))


def find(words: Words) -> WordFault | None:
    """The limit where the channels are cut off to nearly a square wave, and the readings as they would be without."""
    held = np.abs(wrap(4.0 * words.measured - 0.5 * TAU)) < 4.0 * _CORNER_RAD
    held &= words.usable
    share = float(np.mean(held[words.usable])) if words.usable.any() else 0.0
    corners = np.unique(np.round((words.measured[held] - 0.125 * TAU) / (0.25 * TAU)).astype(np.int64) % 4)
    if share < _LEAST_HELD or corners.size < 4:
        return None
    fits = [_fitted(words, sense, share) for sense in (1.0, -1.0)]
    angle, level, off = min(fits, key=lambda one: float(np.sum(np.abs(one[2][words.usable]))))
    before = words.expected.residual[words.usable]
    ratio = float(np.mean(np.abs(off[words.usable])) / max(float(np.mean(np.abs(before))), 1e-12))
    if ratio > 0.5:
        return None
    values = {"level_percent": 100.0 * level, "x_side": 0.0, "y_side": 0.0}
    nothing_lost = np.zeros(len(words), dtype=bool)
    return WordFault(values, float(np.log(ratio)) * held.sum(), words.usable, nothing_lost, wrap(angle + off))


def _fitted(words: Words, sense: float, share: float) -> tuple[Array, float, Array]:
    """The angle (n,) [rad] in one sense, the limit, and what the readings are off (n,) [rad] by least absolute errors.

    By grids that close in on the zero and the limit: the sum has kinks wherever a channel leaves its limit.
    """
    away = words.measured - sense * words.reference
    zero = float(np.angle(np.mean(np.exp(1j * away[words.usable]))))
    # Of a turn 8 arcsin(limit) is not held.
    level = float(np.sin(0.125 * TAU * np.clip(1.0 - share, 1e-3, 1.0)))
    wide, factor = _FIRST_RAD, _FIRST_SHARE
    rows = np.flatnonzero(words.usable)
    rows = rows[:: max(rows.size // _ROWS, 1)]
    turn, read = sense * words.reference[rows], words.measured[rows]
    for _ in range(_ROUNDS):
        zeros = zero + wide * np.linspace(-1.0, 1.0, _ZEROS)
        levels = level * (1.0 + factor) ** np.linspace(-1.0, 1.0, _LEVELS)
        sums = np.array([[np.sum(np.abs(wrap(read - reading(turn + z, limit)))) for limit in levels] for z in zeros])
        i, j = np.unravel_index(int(np.argmin(sums)), sums.shape)
        zero, level = float(zeros[i]), float(min(levels[j], 1.0))
        wide, factor = wide * _NARROWER, factor * _NARROWER
    angle = sense * words.reference + zero
    return angle, level, wrap(words.measured - reading(angle, level))
