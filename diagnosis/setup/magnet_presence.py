"""Whether the reading goes round with the shaft at all: an axial magnet, one that is not over the sensor, or none."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import FALSE_ALARM, fitted, waves
from diagnosis.setup.ratio_search import Closest, closest_ratio
from diagnosis.setup.record import FEWEST, Record
from diagnosis.setup.relation import travel_deg
from twin.following import swing_deg

_WHOLE_DEG = 300.0
"""Travel of the shaft that a judgement needs: on less a reading that swings and one that goes round look alike."""
_ORDERS = (1, 2, 3, 4)


def axial_magnet(record: Record) -> Finding | None:
    """A reading that swings to and fro within a part of the turn while the shaft goes round."""
    if record.both.size < FEWEST:
        return None
    swing = swing_deg(record.measured_deg, record.reference_deg)
    if swing is None:
        return None
    low, high = swing
    return Finding(
        kind="axial_magnet",
        what="the magnet is axial instead of diametral, or not over the sensor",
        evidence=f"the reading swings between {low % 360.0:.0f} and {high % 360.0:.0f} deg while the reference "
        f"goes round {np.ptp(travel_deg(record.reference_deg)) / 360.0:.2f} times",
        consequence="the field at the sensor does not turn with the shaft, so that no angle can be computed from it",
        remedy="use a magnet magnetised across its diameter, centre it on the shaft's end and put the sensor in front "
        "of it; beside a shaft, a multipole ring or a sensor for that place",
    )


def missing_magnet(record: Record) -> Finding | None:
    """A reading that has nothing to do with the shaft."""
    if record.both.size < 2 * FEWEST or record.relation is not None or axial_magnet(record) is not None:
        return None
    travel = travel_deg(record.reference_deg)
    if np.ptp(travel) < _WHOLE_DEG or np.ptp(record.measured_deg) == 0.0:
        return None
    closest = closest_ratio(travel, record.measured_deg)
    by_chance = closest.chance >= FALSE_ALARM
    # A magnet on the shaft makes the reading go round, or come again with each turn.
    if not by_chance and closest.goes_round:
        return None
    of_the_turn = _p_of_orders(np.radians(travel), np.radians(record.measured_deg)) < FALSE_ALARM
    if of_the_turn and (by_chance or closest.whole):
        return None
    turns = np.ptp(travel) / 360.0
    return Finding(
        kind="no_magnet",
        what="the reading has nothing to do with the shaft: no magnet over the sensor, or another shaft's sensor",
        evidence=f"no ratio of speeds up to {closest.highest:.0f} and no order up to {_ORDERS[-1]} of the turn makes "
        f"it follow the reference over {turns:.1f} turns" + ("" if by_chance else _swings(record, travel, closest)),
        consequence="there is no error to explain: the reading is noise, or another quantity",
        remedy="check that the magnet is there and within the sensor's air gap, and that both columns belong to one "
        "shaft and one recording",
    )


def _swings(record: Record, travel: np.ndarray, closest: Closest) -> str:
    """That a reading swings to and fro instead of going round, how often a turn and a second, and what does so."""
    time = record.column("time_s")
    rate = ""
    if time is not None and np.isfinite(time).all() and time[-1] > time[0]:
        rate = f", {closest.ratio * abs(travel[-1] - travel[0]) / 360.0 / (time[-1] - time[0]):.3g} Hz"
    ring = ", or as a ring of poles does beside the sensor" if closest.whole else ""
    return f"; it swings to and fro {closest.ratio:.4g} times a turn{rate}, as what wires pick up does{ring}"


def _p_of_orders(shaft_rad: np.ndarray, reading_rad: np.ndarray) -> float:
    """Probability that orders of the turn in the reading's sine and cosine (n,) are chance."""
    from scipy.stats import f

    shapes = [np.ones_like(shaft_rad), *waves(shaft_rad, _ORDERS)]
    free = reading_rad.size - len(shapes)
    if free < 4:
        return 0.0
    p = 1.0
    for part in (np.cos(reading_rad), np.sin(reading_rad)):
        left = float(np.sum(fitted(shapes, part).left ** 2))
        total = float(np.sum((part - part.mean()) ** 2))
        ratio = (total - left) / (len(shapes) - 1) / max(left / free, 1e-300)
        p = min(p, 2.0 * float(f.sf(ratio, len(shapes) - 1, free)))
    return p
