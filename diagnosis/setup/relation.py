"""How a reading goes with its reference: how many times as fast, which way, and what is left as error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.setup.harmonics import Fitted, fitted, waves
from diagnosis.setup.ratio_search import closeness, goes_round, part_to_search
from twin.angles import Array, wrap_deg
from twin.following import follows, is_near, spread_deg

_SMALL_STEP_DEG = 90.0
"""Rows of the reference that are typically closer than this follow one another round the turn."""
_WHOLE = 0.9
"""Turns from which orders are told from a slope."""
_AS_CLOSE = 0.95
"""Share of the closest: a fifth of a line's width beside its middle it is sinc(0.2) = 0.94."""


@dataclass(frozen=True, eq=False)
class Relation:
    """A reading that turns ``ratio`` times as fast as the reference, negative where it counts the other way.

    Attributes
    ----------
    ratio, ratio_error : float
        The ratio and its standard error.
    travel_deg : ndarray
        The reference [deg] over its turns, (n,).
    error_deg : ndarray
        Reading minus ratio times reference [deg], (n,), without its mean.
    fit : Fitted
        That error by a constant, a slope with the turns, and orders 1 to 4 where a whole turn shows them.
    """

    ratio: float
    ratio_error: float
    travel_deg: Array
    error_deg: Array
    fit: Fitted

    @property
    def turns(self) -> float:
        """Turns from one end of the reference's range to the other."""
        return float(np.ptp(self.travel_deg)) / 360.0

    @property
    def error_at_one_deg(self) -> Array:
        """The error (n,) of a reading that is to turn as fast as the reference: a slope of the ratio stands in it."""
        off = self.ratio - float(np.sign(self.ratio))
        return np.asarray(self.error_deg + off * (self.travel_deg - self.travel_deg[0]))

    @property
    def follows(self) -> bool:
        """Whether the reading turns as fast as the reference, either way."""
        return abs(abs(self.ratio) - 1.0) < 0.2


def travel_deg(reference_deg: Array) -> Array:
    """An angle (n,) [deg] over its turns, where its rows follow one another."""
    if reference_deg.size < 2 or np.median(np.abs(wrap_deg(np.diff(reference_deg)))) >= _SMALL_STEP_DEG:
        return reference_deg
    return np.unwrap(reference_deg, period=360.0)


def relation_of(reference_deg: Array, measured_deg: Array) -> Relation | None:
    """How two angles (n,) [deg] go together; None where they do not.

    Parameters
    ----------
    reference_deg, measured_deg : ndarray
        The angles [deg], in the order in which they were taken, wrapped or not.

    Returns
    -------
    Relation or None
        The ratio with its standard error, and the error beside it.
    """
    travel = travel_deg(reference_deg)
    if np.ptp(travel) < 1.0 or np.ptp(measured_deg) == 0.0:
        return None
    if follows(measured_deg, reference_deg):
        ratio: float | None = min((1.0, -1.0), key=lambda sense: spread_deg(measured_deg - sense * reference_deg))
    else:
        ratio = _searched(travel, measured_deg)
    return None if ratio is None else _refined(ratio, travel, measured_deg)


def _searched(travel: Array, measured: Array) -> float | None:
    """The ratio at which a reading (n,) goes most closely with the reference (n,); None where it does with none."""
    part = part_to_search(travel)
    if not part.ratios.size:
        return None
    at, reading = travel[part.rows], measured[part.rows]
    close = closeness(at, np.exp(1j * np.radians(reading)), part.ratios)
    # Of ratios that go as closely, as those that even points show alike, the smallest.
    place = int(np.argmax(np.max(close, axis=0) >= _AS_CLOSE * np.max(close)))
    if not goes_round(float(np.max(close[:, place])), float(np.min(close[:, place])), at.size):
        return None
    best = float(part.ratios[place]) * (1.0 if close[0, place] >= close[1, place] else -1.0)
    finer = best + np.linspace(-1.0, 1.0, 41) * part.finest
    best = float(min(finer, key=lambda ratio: spread_deg(reading - ratio * at)))
    off = spread_deg(reading - best * at)
    if abs(best) < 0.5 * part.finest:
        return None
    return best if is_near(off, spread_deg(best * at)) else None


def _refined(ratio: float, travel: Array, measured: Array) -> Relation | None:
    """The ratio from a fit of the error with a slope."""
    turn = travel / 360.0
    whole = bool(np.ptp(turn) >= _WHOLE) and turn.size >= 16
    shapes = [np.ones_like(turn), turn - float(np.mean(turn))]
    shapes += waves(np.radians(travel), (1, 2, 3, 4) if turn.size >= 24 else (1, 2)) if whole else []
    for _ in range(4):
        error = _along(measured - ratio * travel)
        fit = fitted(shapes, error)
        slope = float(fit.values[1]) / 360.0
        if abs(slope) < 1e-9 or abs(slope) > 0.5 * abs(ratio):
            break
        ratio += slope
    error = _along(measured - ratio * travel)
    return Relation(ratio, float(fit.errors[1]) / 360.0, travel, error, fitted(shapes, error))


def _along(error: Array) -> Array:
    """Errors (n,) [deg] without their mean; those that drift by whole turns are followed along the rows."""
    centre = np.degrees(np.angle(np.mean(np.exp(1j * np.radians(error)))))
    about = wrap_deg(error - centre)
    if spread_deg(error) > 45.0:
        about = np.unwrap(about, period=360.0)
    return np.asarray(about - np.median(about))
