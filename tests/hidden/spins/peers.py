"""Corrections without a reference as others make them, from their published descriptions, on the same logs.

``ripple_table``: at a drive's nearly constant speed, what the measured speed does over the angle is taken for the
sensor's and integrated into a table of 32 entries, as the encoder calibration of the moteus drives does.
``mean_speed``: a straight line in time through each turn is the reference (constant speed over a turn).
``harmonic_fit``: cubics in time are the motion, one for every four turns, and orders 1 to 16 of the reading are fitted
beside them; ``weighted_fit`` is the same with turns weighted by what is left in them, which nobody is known to do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from .rotor import Array

Peer = Callable[[Mapping[str, Array]], Callable[[Array], Array]]
ENTRIES = 32


def unwrapped(columns: Mapping[str, Array]) -> tuple[Array, Array]:
    """Times [s] from the first reading on, and readings [deg] without jumps.

    Equal stamps are spread evenly; over rows that never arrived the shaft is taken to keep its speed.
    """
    time, reading = columns["time_s"], columns["measured_deg"]
    values, first, count = np.unique(time, return_index=True, return_counts=True)
    if values.size < time.size:
        time = np.interp(np.arange(time.size), first + 0.5 * (count - 1), values)
    lapse = np.maximum(np.diff(time), 1e-9)
    step = np.mod(np.diff(reading) + 180.0, 360.0) - 180.0
    near = np.flatnonzero(lapse < 1.5 * np.median(lapse))
    middle = 0.5 * (time[1:] + time[:-1])
    expected = lapse * np.interp(middle, middle[near], step[near] / lapse[near])
    step = expected + np.mod(step - expected + 180.0, 360.0) - 180.0
    return time - time[0], reading[0] + np.concatenate([[0.0], np.cumsum(step)])


def tabulated(entries_deg: Array) -> Callable[[Array], Array]:
    """The correction by a table of errors on an even grid from 0, straight lines between the entries."""
    grid = 360.0 / entries_deg.size * np.arange(entries_deg.size)

    def corrected(reading_deg: Array) -> Array:
        return np.asarray(reading_deg - np.interp(np.mod(reading_deg, 360.0), grid, entries_deg, period=360.0))

    return corrected


def _binned(place_deg: Array, values: Array, entries: int) -> Array:
    """Mean of the values around each entry of an even grid from 0; entries without a value by their neighbours'."""
    index = np.mod(np.round(np.mod(place_deg, 360.0) * entries / 360.0), entries).astype(np.int64)
    count = np.bincount(index, minlength=entries)
    total = np.bincount(index, values, minlength=entries)
    there = np.flatnonzero(count)
    return np.interp(np.arange(entries), there, total[there] / count[there], period=entries)


def ripple_table(columns: Mapping[str, Array]) -> Callable[[Array], Array]:
    """Speed over its mean of one turn around, minus 1, averaged in 32 sectors and integrated over the angle."""
    time, reading = unwrapped(columns)
    time, kept = np.unique(time, return_index=True)
    reading = reading[kept]
    way = np.sign(reading[-1] - reading[0])
    middle, speed = 0.5 * (reading[1:] + reading[:-1]), np.diff(reading) / np.diff(time)
    path = way * reading
    rising = np.maximum.accumulate(path)
    # the mean speed over the turn about each reading, by the times at which the turn began and ended
    centre = way * middle
    inside = (centre > path[0] + 180.0) & (centre < path[-1] - 180.0)
    if not inside.any():
        return tabulated(np.zeros(ENTRIES))
    began = np.interp(centre[inside] - 180.0, rising, time)
    ended = np.interp(centre[inside] + 180.0, rising, time)
    ripple = speed[inside] * way * (ended - began) / 360.0 - 1.0
    entries = _binned(middle[inside], ripple, ENTRIES)
    entries = entries - entries.mean()
    # the speed in a sector is that about its middle: half of it lies before the entry
    error = np.cumsum(entries) - 0.5 * entries
    return tabulated((error - error.mean()) * 360.0 / ENTRIES)


def mean_speed(columns: Mapping[str, Array]) -> Callable[[Array], Array]:
    """What the readings are off a straight line in time through each turn, averaged in 64 sectors."""
    time, reading = unwrapped(columns)
    turn = np.floor(np.abs(reading - reading[0]) / 360.0).astype(np.int64)
    places, errors = [], []
    for number in range(int(turn.max()) or 1):
        rows = np.flatnonzero(turn == number)
        if rows.size < 4:
            continue
        first, last = rows[0], min(rows[-1] + 1, time.size - 1)
        speed = (reading[last] - reading[first]) / (time[last] - time[first])
        line = reading[first] + speed * (time[rows] - time[first])
        off = reading[rows] - line
        places.append(reading[rows])
        errors.append(off - off.mean())
    entries = _binned(np.concatenate(places), np.concatenate(errors), 64)
    return tabulated(entries - entries.mean())


def harmonic_fit(columns: Mapping[str, Array]) -> Callable[[Array], Array]:
    """Least squares of the readings on orders 1 to 16 of the reading beside a cubic in time for every four turns."""
    return _harmonics(columns, rounds=1)


def weighted_fit(columns: Mapping[str, Array]) -> Callable[[Array], Array]:
    """The same, but turns in which more is left (a row lost, a load come on, a torque at low speed) count less."""
    return _harmonics(columns, rounds=8)


def _harmonics(columns: Mapping[str, Array], rounds: int) -> Callable[[Array], Array]:
    time, reading = unwrapped(columns)
    orders = np.arange(1, 17)
    window = np.floor(np.abs(reading - reading[0]) / (4.0 * 360.0)).astype(np.int64)
    parts = []
    for number in range(int(window.max()) + 1):
        rows = np.flatnonzero(window == number)
        if rows.size < 8:
            continue
        share = (time[rows] - time[rows].mean()) / max(float(np.ptp(time[rows])), 1e-9)
        basis = np.linalg.qr(np.vander(share, 4))[0]
        waves = np.radians(reading[rows])[:, None] * orders
        both = np.column_stack([np.cos(waves), np.sin(waves), reading[rows] - reading[rows].mean()])
        both = both - basis @ (basis.T @ both)
        parts.append((both.T @ both, rows.size))
    found = np.zeros(32)
    weights = np.ones(len(parts))
    for _ in range(rounds):
        total = np.tensordot(weights, np.array([product for product, _ in parts]), 1)
        found = np.linalg.lstsq(total[:32, :32], total[:32, 32], rcond=None)[0]
        signed = np.append(-found, 1.0)
        left = np.array([signed @ product @ signed / rows for product, rows in parts])
        weights = 1.0 / (left + 0.1 * np.median(left) + 1e-12)

    def corrected(reading_deg: Array) -> Array:
        angle = np.radians(np.asarray(reading_deg))[..., None] * orders
        return np.asarray(reading_deg - np.cos(angle) @ found[:16] - np.sin(angle) @ found[16:])

    return corrected


PEERS: dict[str, Peer] = {
    "ripple_table": ripple_table,
    "mean_speed": mean_speed,
    "harmonic_fit": harmonic_fit,
    "weighted_fit": weighted_fit,
}
