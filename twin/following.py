"""Whether two angles go round together, in either counting sense: what makes two columns a sweep."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, mean_vector, radians, wrap_deg

FOLLOWS_DEG = 40.0
_FEWEST_SWUNG = 16
_ROUND_DEG = 300.0
_WIDEST_SWING_DEG = 300.0
_UNSWUNG = 0.2
"""Share of the variance of a reading that swings which orders 1 to 4 of the turn leave at most."""
_JUMPS = 0.6
"""A reading that goes round in another unit, or with a bit stuck, falls back by most of its span in each turn."""
_BACK = 0.2
"""Share of the way that a reading which swings goes back, at least; one that goes round never does."""
_FOLLOWS_SHARE = 0.6
"""A sensor follows the shaft if their median difference is below this angle, and below this share of the shaft's own
movement."""


def distance_deg(measured: Array, driver: Array) -> float:
    """Typical (median) difference [deg] of two angles (n,) [deg] in the better counting sense, zeros taken off."""
    return min(spread_deg(measured - sense * driver) for sense in (1.0, -1.0))


def spread_deg(angle: Array) -> float:
    """Median distance [deg] of angles (n,) [deg] from their mean direction."""
    centre = np.degrees(np.angle(mean_vector(radians(angle))))
    return float(np.median(np.abs(wrap_deg(angle - centre))))


def follows(measured: Array, driver: Array) -> bool:
    """Whether one angle (n,) [deg] follows another. Over part of a turn a constant is near to any, hence the share."""
    return is_near(distance_deg(measured, driver), spread_deg(driver))


def is_near(off_deg: float, moved_deg: float) -> bool:
    """Whether what is off by so much from what moves by so much follows it."""
    return off_deg <= min(FOLLOWS_DEG, _FOLLOWS_SHARE * moved_deg)


def swing_deg(measured: Array, driver: Array) -> tuple[float, float] | None:
    """Between which angles [deg] a reading (n,) swings to and fro while its driver (n,) [deg] goes round.

    None where the driver makes less than most of a turn, or the reading goes round, only one way, or by itself.
    """
    if driver.size < _FEWEST_SWUNG:
        return None
    travel = np.unwrap(driver, period=360.0)
    centre = np.degrees(np.angle(mean_vector(radians(measured))))
    away = wrap_deg(measured - centre)
    low, high = np.quantile(away, [0.02, 0.98])
    if np.ptp(travel) < _ROUND_DEG or high - low > _WIDEST_SWING_DEG or high == low:
        return None
    if np.sum(np.abs(np.diff(away)) > _JUMPS * (high - low)) > np.ptp(travel) / 720.0:
        return None
    # By the angle, so that noise between neighbouring rows does not count as a way.
    turn = radians(travel)
    waves = np.stack([np.ones_like(turn), *(w(k * turn) for k in (1, 2, 3, 4) for w in (np.cos, np.sin))], axis=1)
    smooth = waves @ np.linalg.lstsq(waves, away, rcond=None)[0]
    if np.var(away - smooth) > _UNSWUNG * np.var(away):
        return None
    back = float(np.mean(np.diff(smooth) * np.diff(travel) < 0.0))
    return (float(centre + low), float(centre + high)) if min(back, 1.0 - back) > _BACK else None


def slope_of(reference_rad: Array, measured_rad: Array) -> int:
    """Whether the readings (n,) count with the reference (1) or against it (-1)."""
    same, other = (abs(mean_vector(measured_rad - sign * reference_rad)) for sign in (1.0, -1.0))
    return 1 if same >= other else -1
