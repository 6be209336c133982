"""Whether two angles go round together, in either counting sense: what makes two columns a sweep."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians, wrap_deg

FOLLOWS_DEG = 40.0
_FOLLOWS_SHARE = 0.6
"""A sensor follows the shaft if their median difference is below this angle, and below this share of the shaft's own
movement."""


def distance_deg(measured: Array, driver: Array) -> float:
    """Typical (median) difference [deg] of two angles (n,) [deg] in the better counting sense, zeros taken off."""
    return min(spread_deg(measured - sense * driver) for sense in (1.0, -1.0))


def spread_deg(angle: Array) -> float:
    """Median distance [deg] of angles (n,) [deg] from their mean direction."""
    centre = np.degrees(np.angle(np.mean(np.exp(1j * radians(angle)))))
    return float(np.median(np.abs(wrap_deg(angle - centre))))


def follows(measured: Array, driver: Array) -> bool:
    """Whether one angle (n,) [deg] follows another. Over part of a turn a constant is near to any, hence the share."""
    return distance_deg(measured, driver) <= min(FOLLOWS_DEG, _FOLLOWS_SHARE * spread_deg(driver))
