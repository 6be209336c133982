"""The direction in which the shaft came to each reading: as recorded, or from the order of the angles."""

from __future__ import annotations

import numpy as np

from twin.angles import Array


def infer_direction(shaft_rad: Array) -> Array:
    """Direction (+1 or -1) of each row from the order of the angles (n,); a row at rest keeps the last one.

    A step back that is much shorter than the usual step is jitter of the stop, not a reversal.
    """
    step = np.diff(shaft_rad)
    moving = np.abs(step) > 0.1 * np.median(np.abs(step[step != 0.0])) if np.any(step) else np.zeros(0, dtype=bool)
    if not moving.any():
        return np.ones(shaft_rad.size)
    last = np.maximum.accumulate(np.where(moving, np.arange(step.size), -1))
    last = np.where(last < 0, np.flatnonzero(moving)[0], last)
    sign = np.sign(step[last])
    return np.concatenate([sign[:1], sign])


def way_of(shaft_rad: Array, direction: Array | None, speed_rad_s: Array | None) -> Array:
    """Direction (+1 or -1) of each row (n,): as recorded, else from the order of the angles and a signed speed."""
    if direction is not None:
        return np.where(np.asarray(direction) < 0, -1.0, 1.0)
    way = infer_direction(shaft_rad)
    if speed_rad_s is None or np.ptp(np.sign(speed_rad_s)) != 2.0:
        return way
    # A signed speed says the direction of the very row at which the shaft turns round.
    sense = np.where(np.asarray(speed_rad_s) < 0.0, -1.0, 1.0)
    agreement = float(np.mean(sense * way))
    return np.asarray(sense * np.sign(agreement)) if abs(agreement) > 0.8 else way


def as_reached(shaft_rad: Array, way: Array) -> Array:
    """Direction (n,) in which the shaft came to each reading.

    A record may name the row at which the shaft turns round by the way in which it leaves it; but what lags, lags as on
    the way to it.
    """
    step = np.diff(shaft_rad)
    usual = np.median(np.abs(step[step != 0.0])) if np.any(step) else 0.0
    turned = np.flatnonzero(np.diff(way[:-1]))
    onward = step[turned] * way[turned] > 0.5 * usual
    back = step[turned + 1] * way[turned] < -0.5 * usual
    reached = np.array(way)
    late = turned[onward & back]
    reached[late + 1] = way[late]
    return reached
