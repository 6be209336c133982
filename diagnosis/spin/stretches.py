"""Stretches of a log in which the shaft turns: readings counted on over whole turns, stops and gaps left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import Array, IntArray, wrap
from twin.effect import BoolArray
from twin.spin import FEWEST_ROWS

_GAP = 20.0
"""Spacings of readings without one, from which on nobody knows how far the shaft has turned meanwhile."""
_SLOW = 0.1
"""Largest change of the speed in a radian, as a share of it. Where it is due to friction that goes with the speed, the
response to a torque is off by four times its square, 0.04 (:func:`twin.mechanics.torque_ripple.response`)."""
_REPAIR = 9


@dataclass(frozen=True, eq=False)
class Turning:
    """Rows (m,) of a log in which the shaft turns, their readings (m,) [rad] counted on, and the stretch of each."""

    rows: IntArray
    readings_rad: Array
    stretch: IntArray

    def kept(self, keep: BoolArray) -> Turning:
        """Those of the rows (m,), in stretches that are long enough; where some are left out, one ends."""
        run = np.concatenate([[0], np.cumsum((np.diff(self.stretch) != 0) | (np.diff(keep.astype(int)) != 0))])
        keep = keep & (np.bincount(run)[run] >= FEWEST_ROWS)
        stretch = np.unique(run[keep], return_inverse=True)[1].astype(np.int64)
        return Turning(self.rows[keep], self.readings_rad[keep], stretch)


def turning(measured_rad: Array, time_s: Array) -> Turning:
    """Find the stretches of a log of readings (n,) [rad] at times (n,) [s], never falling."""
    # A second reading of one instant tells no motion.
    fresh = np.concatenate([[True], np.diff(time_s) > 0.0])
    rows = np.flatnonzero(fresh)
    counted = counted_on(measured_rad[rows], time_s[rows])
    moves = _moves(counted, time_s[rows])
    step = np.diff(time_s[rows])
    broken = step > _GAP * float(np.median(step))
    return Turning(rows, counted, np.concatenate([[0], np.cumsum(broken)])).kept(moves)


def counted_on(measured_rad: Array, time_s: Array) -> Array:
    """Readings (n,) [rad] counted on over whole turns; one that lies far off counts no turn."""
    from scipy.ndimage import median_filter

    step = wrap(np.diff(measured_rad))
    speed = median_filter(step / np.diff(time_s), size=_REPAIR, mode="nearest")
    expected = speed * np.diff(time_s)
    # Each step is the one nearest to what its neighbours lead to expect.
    step = expected + wrap(step - expected)
    return np.asarray(measured_rad[0] + np.concatenate([[0.0], np.cumsum(step)]))


def _moves(counted: Array, time_s: Array) -> BoolArray:
    """Which readings (n,) were taken of a shaft that turns evenly enough.

    The speed over about a turn changes by little on a radian's way.
    """
    width = _rows_a_turn(counted)
    before = np.maximum(np.arange(counted.size) - width, 0)
    behind = np.minimum(np.arange(counted.size) + width, counted.size - 1)
    span = time_s[behind] - time_s[before]
    speed = (counted[behind] - counted[before]) / span
    change = (speed[behind] - speed[before]) / span
    fastest = float(np.quantile(np.abs(speed), 0.98))
    return np.asarray((np.abs(change) < _SLOW * speed**2) & (np.abs(speed) > 0.02 * fastest))


def _rows_a_turn(counted: Array) -> int:
    """Half the readings in a turn at the speed that is usual while the shaft moves."""
    step = np.abs(np.diff(counted))
    moving = step[step > 0.1 * float(np.quantile(step, 0.9))]
    usual = float(np.median(moving)) if moving.size else 0.0
    return int(np.clip(np.pi / max(usual, 1e-9), 4, max(counted.size // 8, 4)))
