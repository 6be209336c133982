"""Columns of a sensor of several periods a turn as columns of the shaft's turn.

A ring of magnets, or a resolver of several speeds, turns its field P times in a turn of the shaft. Its record holds the
angle of one period, which begins anew P times a turn, or that of the shaft; its channels always turn P times.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from twin.angles import Array, wrap_deg
from twin.errors import SweepError, UserError
from twin.following import follows, spread_deg
from twin.shown import shown

OPTION = "--pole-pairs (pole_pairs=)"
MOST_PAIRS = 1000
"""As of :func:`twin.reference.encoder.bldc_order`."""
_TRIED = 128
"""Numbers of periods that are tried before it is said that a record turns by none."""
_CHANNELS = ("vx", "vy")


def checked_pole_pairs(pole_pairs: int | None) -> int | None:
    """The number of periods a turn that is meant, None: one. Raises UserError where it is no such number."""
    if pole_pairs is None:
        return None
    whole = not isinstance(pole_pairs, bool) and hasattr(pole_pairs, "__index__")
    if not whole or not 1 <= pole_pairs.__index__() <= MOST_PAIRS:
        raise UserError(
            f"pole_pairs is {shown(pole_pairs)}; expected a whole number from 1 to {MOST_PAIRS}: how often the field "
            "at the sensor turns in a turn of the shaft"
        )
    return None if pole_pairs.__index__() == 1 else pole_pairs.__index__()


def of_the_shaft(columns: Mapping[str, Array], pole_pairs: int, *, name: str) -> dict[str, Any]:
    """The columns with both angles as those of the shaft.

    Parameters
    ----------
    columns : mapping of str to ndarray
        Columns (n,) of a sweep without missing cells; either angle turns once or ``pole_pairs`` times in a turn.
    pole_pairs : int
        Periods of the sensor in a turn of the shaft.
    name : str
        What messages call them.

    Returns
    -------
    dict
        The angle that turned several times is counted on by the other one, and divided. Channels that turn several
        times are left out: what they err by within a period stands in their angle. Who counts which way, (s, h), is
        then what they said of it, under ``senses``.

    Raises
    ------
    SweepError
        Where one angle turns another number of times as fast as the other.
    """
    made: dict[str, Any] = dict(columns)
    reference, measured = made["reference_deg"], made["measured_deg"]
    if not follows(measured, reference):
        if follows(measured, pole_pairs * reference):
            made["measured_deg"] = _counted_on(measured, by=reference, times=pole_pairs)
        elif follows(reference, pole_pairs * measured):
            made["reference_deg"] = _counted_on(reference, by=measured, times=pole_pairs)
        else:
            _raise_other_number(measured, reference, pole_pairs, name=name)
    if set(_CHANNELS) <= set(made):
        angle = np.degrees(np.arctan2(made["vy"], made["vx"]))
        once = made["measured_deg"]
        if not follows(angle, once) and follows(angle, pole_pairs * once):
            made = {key: values for key, values in made.items() if key not in _CHANNELS}
            output = _sense(angle, pole_pairs * once)
            made["senses"] = (_sense(once, made["reference_deg"]) * output, output)
    return made


def times_as_fast(fast: Array, slow: Array) -> int | None:
    """How many times, from 2, as fast one angle (n,) [deg] turns as another; None where it is no whole number."""
    return next((times for times in range(2, _TRIED + 1) if follows(fast, times * slow)), None)


def _counted_on(fast: Array, *, by: Array, times: int) -> Array:
    """An angle (n,) [deg] of a period as one of the turn: its periods are counted by an angle of the turn."""
    sense = _sense(fast, times * by)
    away = fast - sense * times * by
    middle = np.degrees(np.angle(np.mean(np.exp(1j * np.radians(away)))))
    return np.asarray(sense * by + (middle + wrap_deg(away - middle)) / times)


def _sense(angle: Array, other: Array) -> int:
    """Whether an angle (n,) [deg] counts with another (1) or against it (-1)."""
    return min((1, -1), key=lambda one: spread_deg(angle - one * other))


def _raise_other_number(measured: Array, reference: Array, pole_pairs: int, *, name: str) -> None:
    """Raise SweepError where one angle turns another whole number of times as fast as the other."""
    for fast, slow, columns in (
        (measured, reference, ("measured_deg", "reference_deg")),
        (reference, measured, ("reference_deg", "measured_deg")),
    ):
        times = times_as_fast(fast, slow)
        if times is not None:
            raise SweepError(
                f"{name}: {columns[0]} turns {times} times as fast as {columns[1]}; expected once or {pole_pairs} "
                f"times, as {OPTION} says: give {times} there, or a gear's ratio in --columns"
            )
