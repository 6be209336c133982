"""What makes columns a sweep: plausible cells, enough readings at enough angles, and a sensor that follows them."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from twin.angles import Array, BoolArray, radians, wrap_deg
from twin.errors import SweepError
from twin.following import FOLLOWS_DEG, distance_deg, follows, spread_deg, swing_deg
from twin.periods import times_as_fast
from twin.sweep_columns import COLUMNS, MAY_BE_MISSING, OF_SETUP, PLAUSIBLE, SMALLEST_AMPLITUDE

FEWEST_ROWS = 8
_ONE_ANGLE_DEG = 0.1
"""Angles closer than this count as one: a jig's stop, read again."""


def check_plausible(key: str, values: Array, *, name: str) -> None:
    """Refuse the first cell (n,) that no bench can have meant; what is missing or infinite is not judged here."""
    known = np.isfinite(values)
    if key == "direction":
        wrong = known & (np.abs(values) != 1.0)
        expected = "+1 or -1; leave the column out where the direction was not recorded"
    else:
        low, high = PLAUSIBLE[key]
        wrong = known & ((values < low) | (values > high))
        expected = f"{low:g} to {high:g}; leave the cell empty where there is no reading"
        if key in OF_SETUP and not wrong.any():
            first = values[np.argmax(known)]
            wrong, expected = known & (values != first), f"{first:g} as before: one number for the whole recording"
        if key == "turn" and not wrong.any():
            wrong = known & (values != np.round(values))
            expected = "a whole number: which sweep or revolution the reading belongs to"
    if wrong.any():
        row = int(np.argmax(wrong))
        raise SweepError(f"{name}: row {row + 1}, column {key}: found {values[row]:g}; expected {expected}")


def as_recorded(columns: Mapping[str, Array], *, name: str, required: Collection[str] = ()) -> dict[str, Array]:
    """The columns of a sweep among some, in their order, each checked (:func:`check_plausible`).

    A column without a single reading was not recorded, unless it is ``required``. Raises SweepError.
    """
    data = {key: np.asarray(columns[key], dtype=np.float64) for key in COLUMNS if key in columns}
    for key, values in data.items():
        check_plausible(key, values, name=name)
    return {key: values for key, values in data.items() if key in required or np.isfinite(values).any()}


def check_both_channels(data: Mapping[str, Array], *, name: str) -> None:
    """Refuse one channel without the other. Raises SweepError."""
    if ("vx" in data) != ("vy" in data):
        have, lack = ("vx", "vy") if "vx" in data else ("vy", "vx")
        raise SweepError(f"{name}: column {have} stands without {lack}; expected both channels or none: add {lack}")


def rows_in_use(data: Mapping[str, Array]) -> tuple[BoolArray, dict[int, str]]:
    """Which rows (n,) have a reading in every cell that must hold one; the numbers of the others, and why."""
    keep = np.ones(next(iter(data.values())).size, dtype=bool)
    rejected: dict[int, str] = {}
    for key, values in data.items():
        if key in MAY_BE_MISSING:
            continue
        bad = np.flatnonzero(~np.isfinite(values) & keep)
        keep[bad] = False
        rejected.update({int(row) + 1: f"{key} missing or not finite" for row in bad})
    return keep, dict(sorted(rejected.items()))


def check_usable(data: Mapping[str, Array], *, name: str, rejected: int) -> None:
    """Enough rows at enough angles, in degrees, and a sensor that moves."""
    reference, measured = data["reference_deg"], data["measured_deg"]
    n = reference.size
    if n < FEWEST_ROWS:
        lost = f" ({rejected} rejected for missing or infinite cells)" if rejected else ""
        raise SweepError(f"{name}: {n} usable rows{lost}; expected at least {FEWEST_ROWS} readings over the circle")
    if np.max(np.abs(wrap_deg(reference - reference[0]))) < _ONE_ANGLE_DEG:
        raise SweepError(
            f"{name}: column reference_deg: every row is {reference[0]:g} deg; expected readings at different angles"
        )
    if np.max(np.abs(wrap_deg(measured - measured[0]))) == 0.0:
        raise SweepError(
            f"{name}: column measured_deg: every row is {measured[0]:g} deg while the reference moves; "
            "expected a sensor that follows; check the sensor's link"
        )
    if np.ptp(reference) <= 6.4 and np.ptp(measured) <= 6.4:
        raise SweepError(
            f"{name}: columns reference_deg and measured_deg span {np.ptp(reference):.3g} and {np.ptp(measured):.3g}: "
            "that looks like radians or turns; expected degrees: convert both columns"
        )
    count = np.unique(np.round(wrap_deg(reference) / _ONE_ANGLE_DEG)).size
    if count < FEWEST_ROWS:
        raise SweepError(f"{name}: column reference_deg: {count} different angles; expected at least {FEWEST_ROWS}")


def check_follows(measured: Array, reference: Array, *, name: str) -> Array:
    """Refuse columns (n,) [deg] that do not go round together, with the reason where it can be seen.

    Returns the readings (n,) [deg] that do: those measured, or what they are once a fault of their words is taken off.
    """
    to_deg = 180.0 / np.pi
    if follows(measured, reference):
        if _repeats_every_radian_turn(measured, reference):
            raise SweepError(
                f"{name}: columns reference_deg and measured_deg: the error repeats every 6.283 over a span of "
                f"{np.ptp(reference):.4g}: that looks like radians; expected degrees: convert both columns"
            )
        return measured
    without_fault = _without_faults_of_words(measured, reference)
    if without_fault is not None:
        return without_fault
    swing = swing_deg(measured, reference)
    if swing is not None:
        raise SweepError(
            f"{name}: measured_deg swings between {swing[0] % 360.0:.0f} and {swing[1] % 360.0:.0f} deg while "
            f"reference_deg goes round; expected a reading that goes round with the shaft: the magnet is axial instead "
            "of diametral, or not over the sensor"
        )
    for wrong, (scale_measured, scale_reference) in {
        "column reference_deg": (1.0, to_deg),
        "column measured_deg": (to_deg, 1.0),
        "columns reference_deg and measured_deg": (to_deg, to_deg),
    }.items():
        if follows(scale_measured * measured, scale_reference * reference):
            raise SweepError(
                f"{name}: {wrong}: the two columns agree only if this is in radians (they span "
                f"{np.ptp(reference):.4g} and {np.ptp(measured):.4g}); expected degrees: convert it"
            )
    pole_pairs = times_as_fast(measured, reference)
    if pole_pairs is not None:
        raise SweepError(
            f"{name}: measured_deg turns {pole_pairs} times as fast as reference_deg; expected both in degrees of the "
            f"same shaft: unwrap and divide the faster one, or give --pole-pairs {pole_pairs} (pole_pairs="
            f"{pole_pairs}) for a sensor of so many periods"
        )
    raise SweepError(
        f"{name}: measured_deg does not follow reference_deg (typically {distance_deg(measured, reference):.0f} deg "
        f"off, in the better counting sense; expected below {FOLLOWS_DEG:g}); "
        "check that both columns belong to one sweep and are in degrees; halltwin doctor looks for the reason"
    )


def check_channels(vx: Array, vy: Array, measured: Array, *, name: str) -> None:
    """Refuse channels (n,) whose angle is not what the sensor reports: a radius taken from them would say nothing."""
    for key, values in (("vx", vx), ("vy", vy)):
        if np.max(np.abs(values)) < SMALLEST_AMPLITUDE:
            raise SweepError(
                f"{name}: column {key}: no reading is larger than {np.max(np.abs(values)):.3g}; expected a signal of "
                f"at least {SMALLEST_AMPLITUDE:g} in its unit: scale both channels, or leave them out"
            )
        if np.ptp(values) == 0.0:
            raise SweepError(
                f"{name}: column {key}: every row is {values[0]:g} while the reference moves; "
                "expected the channel's signal: mend it, or leave vx and vy out"
            )
    if follows(np.degrees(np.arctan2(vy, vx)), measured):
        return
    middle = [float(np.min(values) + np.max(values)) / 2.0 for values in (vx, vy)]
    hint = "check the columns, or leave vx and vy out"
    if follows(np.degrees(np.arctan2(vy - middle[1], vx - middle[0])), measured):
        hint = f"the channels stand at about {middle[0]:.4g} and {middle[1]:.4g} in mid-range: take that off both"
    elif (times := times_as_fast(np.degrees(np.arctan2(vy, vx)), measured)) is not None:
        hint = f"it turns {times} times as fast: give --pole-pairs {times} (pole_pairs={times}) for a sensor of so many"
    raise SweepError(
        f"{name}: columns vx, vy: atan2(vy, vx) does not follow measured_deg; expected the two channels that the angle "
        f"is computed from, zero at zero field; {hint}"
    )


def _without_faults_of_words(measured: Array, reference: Array) -> Array | None:
    """The readings (n,) [deg] as they go round with the reference once faults of the link are taken off; None: never.

    A top bit that is stuck, or a third of all frames lost, makes readings that follow nothing.
    """
    from twin.catalogue import CATALOGUE
    from twin.words import LIMIT_LOG_P, Words, faults_of

    words = Words(radians(reference), radians(measured), np.ones(measured.size, dtype=bool))
    finders = {e.name: e.in_words for e in CATALOGUE if e.in_words is not None and e.footprint == "sequence"}
    found = faults_of(words, finders, LIMIT_LOG_P)
    for _, fault in found:
        words = words.without(fault)
    return np.degrees(words.measured) if found else None


def _repeats_every_radian_turn(measured: Array, reference: Array) -> bool:
    """Whether the error (n,) repeats every 2 pi rather than every 360: several turns in radians also follow.

    Asked only of sweeps that hold two turns if they are in radians, and less than one in degrees.
    """
    if not 4.0 * np.pi <= np.ptp(reference) <= 340.0 or reference.size < 20:
        return False
    sense = min((1.0, -1.0), key=lambda s: spread_deg(measured - s * reference))
    to_deg = 180.0 / np.pi
    in_radians = _left_by_two_orders(to_deg * (measured - sense * reference), to_deg * reference) / to_deg
    return 3.0 * in_radians < _left_by_two_orders(measured - sense * reference, reference)


def _left_by_two_orders(error: Array, reference: Array) -> float:
    """Typical (median) error [deg] that orders 0 to 2 leave of errors (n,) [deg]; single wild readings do not count."""
    turn = radians(reference)
    orders = np.stack([np.ones_like(turn), np.cos(turn), np.sin(turn), np.cos(2 * turn), np.sin(2 * turn)], axis=1)
    error = wrap_deg(error - np.degrees(np.angle(np.mean(np.exp(1j * radians(error))))))
    kept = np.ones(error.size, dtype=bool)
    left = np.abs(error)
    for _ in range(3):
        left = np.abs(error - orders @ np.linalg.lstsq(orders[kept], error[kept], rcond=None)[0])
        kept = left <= 5.0 * np.median(left)
    return float(np.median(left))
