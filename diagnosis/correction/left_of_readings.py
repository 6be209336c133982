"""What of the errors of readings a table of the reading alone leaves: by direction, temperature, word, and the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.correction.as_read import AsRead, as_read
from diagnosis.correction.compensation import Correction
from diagnosis.correction.cross_validation import BeforeAfter
from diagnosis.correction.not_removed import FAULTS, GRID, NotRemoved, measured
from diagnosis.thermal.recording import Recording
from twin.angles import TAU, Array, wrap
from twin.decoded import Decoded
from twin.effect import BoolArray

ELSE = "else"
"""What differs with nothing that is recorded, and is no noise."""
_BINS = 36
_BEYOND_CHANCE = 5.0
"""Standard deviations from which on what neighbours do not differ by is no chance."""
_LEFT_OVER = 1.1
"""A held-out error that is larger by so much than what is listed has a reason of its own, which is listed."""
_WHY_HELD_OUT = {ELSE: "it leans to what the others were taken at (current, time, turn or other)"}


def of_words(given: AsRead) -> list[NotRemoved]:
    """What the faults of words do to readings that a drive reads as they are, over all readings."""
    left = []
    for fault in given.faults:
        rms, largest = measured(given.off_rad(fault))
        touched = f"{fault.said}: {np.count_nonzero(fault.touched)} of {len(given.read)} readings"
        left.append(NotRemoved(FAULTS, (fault.cause,), rms, largest, touched))
    return left


def of_words_of(sweeps: Sequence[Decoded]) -> list[NotRemoved]:
    """The same of sweeps that a correction is tried on, each by its name."""
    found = [(one.sweep.name, left) for one in sweeps for left in of_words(as_read([one]))]
    return [replace(left, at=f"{name}: {left.at}") for name, left in found]


def of_held_out(held_out: BeforeAfter, error_rad: Array, left: Sequence[NotRemoved]) -> list[NotRemoved]:
    """By how much readings err more that a table was not made of than with the table made of all of them (n,).

    Square for square, and only where that is much: then what is listed in ``left`` would not add up to it.
    """
    held, own = held_out.rms_deg[1], measured(error_rad)[0]
    if held <= _LEFT_OVER * own:
        return []
    most = max(left, key=lambda one: 0.0 if one.what == FAULTS else one.rms_deg or 0.0).what
    why = _WHY_HELD_OUT.get(most, "it is known less well")
    at = f"beyond the errors of the readings that the table is made of: made without them, {why}"
    return [NotRemoved("held-out readings", (), float(np.sqrt(held**2 - own**2)), None, at)]


def of_readings(
    recording: Recording, error_rad: Array, correction: Correction, temperature_c: float
) -> list[NotRemoved]:
    """What of the errors of readings a table made at a temperature [C] leaves; ``error_rad`` (n,) with the table."""
    settled = _settled(recording)
    noise_deg = _between_neighbours(settled, error_rad)
    if 2 * np.count_nonzero(settled) > settled.size:
        recording, error_rad = recording.part(settled), error_rad[settled]
    apart = _between_directions(recording, error_rad)
    left = [] if apart is None else [NotRemoved("direction", rms_deg=apart, at="half of what the directions differ by")]
    if correction.drift is not None:
        grid = TAU * np.arange(GRID) / GRID
        here = correction.shaft(grid, temperature_c)
        ends = (correction.drift.low_c, correction.drift.high_c)
        moved = [wrap(correction.shaft(grid, end) - here) for end in ends]
        rms, largest = measured(max(moved, key=lambda away: float(np.max(np.abs(away)))))
        left.append(NotRemoved("temperature", (), rms, largest, f"between {ends[0]:.1f} and {ends[1]:.1f} C"))
        return left
    return [*left, *_noise_and_rest(error_rad, apart or 0.0, noise_deg)]


def _noise_and_rest(error_rad: Array, apart_deg: float, noise_deg: float) -> list[NotRemoved]:
    """What no direction explains: the noise, and apart from it what readings in a row have in common.

    The latter only where it is no chance, and larger than the noise.
    """
    scatter, noise = measured(error_rad)[0] ** 2 - apart_deg**2, noise_deg**2
    rest = scatter - noise
    # The mean square of second differences of n readings is known to sqrt(2 (1 + 17/18) / n), that of n readings less.
    limit = _BEYOND_CHANCE * np.sqrt(2.0 * (1.0 + 17.0 / 18.0) / error_rad.size)
    if not rest > max(limit, 1.0) * noise:
        told = float(np.sqrt(max(scatter, 0.0)))
        return [NotRemoved("noise", rms_deg=told, at="and all else that the angle does not tell")]
    return [
        NotRemoved("noise", rms_deg=float(np.sqrt(noise)), at="by how readings in a row differ"),
        NotRemoved(
            "else",
            rms_deg=float(np.sqrt(rest)),
            at="no noise, and not in the correction: an order beyond its own, current, time, turn or other",
        ),
    ]


def _settled(recording: Recording) -> BoolArray:
    """Which readings (n,) both neighbours of are of the same way and turn: where it turns back the way is a guess."""
    settled = np.ones(len(recording), dtype=bool)
    for values in (recording.direction, recording.unit):
        same = np.diff(values) == 0
        settled &= np.r_[True, same] & np.r_[same, True]
    return settled


def _between_neighbours(settled: BoolArray, error_rad: Array) -> float:
    """RMS [deg] of the noise of readings (n,), by the second differences of settled ones; NaN where there are none."""
    second = np.diff(error_rad, 2)[settled[:-2] & settled[1:-1] & settled[2:]]
    return float(np.degrees(np.sqrt(np.mean(second**2) / 6.0))) if second.size else float("nan")


def _between_directions(recording: Recording, error_rad: Array) -> float | None:
    """RMS [deg] of half of what the errors (n,) of both directions differ by over the turn, less what is noise.

    None where there is one direction alone.
    """
    place = (np.mod(recording.reference_rad, TAU) / TAU * _BINS).astype(np.int64) % _BINS
    means, variances = [], []
    for way in (recording.direction > 0, recording.direction < 0):
        count = np.bincount(place[way], minlength=_BINS)
        if np.count_nonzero(count > 1) < _BINS // 2:
            return None
        many = np.maximum(count, 1)
        mean = np.bincount(place[way], weights=error_rad[way], minlength=_BINS) / many
        away = np.bincount(place[way], weights=(error_rad[way] - mean[place[way]]) ** 2, minlength=_BINS)
        means.append(np.where(count > 1, mean, np.nan))
        variances.append(away / np.maximum(count - 1, 1) / many)
    half = 0.5 * (means[0] - means[1])
    noise = 0.25 * (variances[0] + variances[1])[np.isfinite(half)]
    square = float(np.nanmean(half**2) - np.mean(noise))
    return float(np.degrees(np.sqrt(max(square, 0.0))))
