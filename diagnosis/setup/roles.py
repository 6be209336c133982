"""Which column is the reference: swapped roles, and a reference that is coarser or later than the sensor."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import FALSE_ALARM, white_noise
from diagnosis.setup.record import FEWEST, Record
from diagnosis.setup.relation import travel_deg
from diagnosis.setup.sampling import step_of_word
from twin.angles import Array, wrap_deg
from twin.following import spread_deg
from twin.reading_grid import step_of_grid_deg

_TIMES = 3.0
"""A reference that scatters so many times as much as the sensor is none, or is not the reference."""
_LEAST_RUNS = 8
_SHARE_OF_STEP = 0.25
"""A reading that goes on by this share of the reference's step while that stands still has been waiting for it."""


def coarse_reference(record: Record) -> Finding | None:
    """A reference that stands still for some rows while the sensor goes on."""
    relation = record.relation
    if relation is None or not relation.follows:
        return None
    reference, reading = record.reference_deg, np.unwrap(record.measured_deg, period=360.0)
    cuts = np.flatnonzero(np.diff(reference) != 0.0) + 1
    starts, ends = np.concatenate([[0], cuts]), np.concatenate([cuts, [reference.size]])
    several = ends - starts >= 2
    if several.sum() < _LEAST_RUNS or several.sum() < 0.25 * starts.size:
        return None
    sense = float(np.sign(relation.ratio))
    travel = relation.travel_deg
    # Which way the shaft goes on into the next stretch.
    next_step = np.diff(travel[starts], append=travel[-1])
    way = np.sign(next_step)
    inside = sense * way * (reading[ends - 1] - reading[starts])
    used = several & (way != 0.0)
    steps = np.abs(next_step[used])
    if used.sum() < _LEAST_RUNS or not _grows(inside[used], _SHARE_OF_STEP * float(np.median(steps))):
        return None
    rows = float(np.median((ends - starts)[used]))
    return Finding(
        kind="coarse_reference",
        what="the reference is coarser or slower than the sensor: it stands still while the sensor goes on",
        evidence=f"it keeps each value for {rows:.0f} rows and then steps by {np.median(steps):.3g} deg; meanwhile the "
        f"reading moves by {np.median(inside[used]):.3g} deg",
        consequence="the reference's steps are taken for errors of the sensor, up to one step of it",
        remedy="use a finer reference, or read it as often as the sensor; else keep one row of each of its steps",
        rows=record.rows(starts[used][:40]),
    )


def _grows(inside: Array, least: float) -> bool:
    """Whether what happens inside of the stretches (n,) is a way on, and at least so long."""
    from scipy.stats import ttest_1samp

    if float(np.median(inside)) < least:
        return False
    if np.ptp(inside) == 0.0:
        return True
    return bool(ttest_1samp(inside, 0.0, alternative="greater").pvalue < FALSE_ALARM)


def swapped_roles(record: Record) -> Finding | None:
    """A reading that looks like the reference, and a reference that looks like the sensor."""
    if record.both.size < 2 * FEWEST or record.relation is None or not record.relation.follows:
        return None
    evidence = _by_channels(record)
    if evidence is None and not _is_table(record) and coarse_reference(record) is None:
        evidence = _by_steps(record) or _by_noise(record)
    if evidence is None:
        return None
    return Finding(
        kind="swapped_roles",
        what="reference and sensor are swapped",
        evidence=evidence,
        consequence="the reference's errors are explained as the sensor's, over the wrong angle",
        remedy="exchange the two columns",
        columns=record.exchanged("reference_deg", "measured_deg"),
    )


def _is_table(record: Record) -> bool:
    """Whether the readings are the index of one turn: a correction table on the sensor's axis, as firmware keeps it."""
    n = record.both.size
    step = float(np.median(np.abs(wrap_deg(np.diff(record.measured_deg)))))
    return abs(n * step - 360.0) < 2.0 * step and float(np.ptp(travel_deg(record.measured_deg))) < 361.0


def _by_channels(record: Record) -> str | None:
    """Channels whose angle is the reference's, not the reading's."""
    vx, vy = record.column("vx"), record.column("vy")
    if vx is None or vy is None or not (np.isfinite(vx).all() and np.isfinite(vy).all()):
        return None
    angle = np.degrees(np.arctan2(vy, vx))
    own, other = (
        min(spread_deg(side - sense * angle) for sense in (1.0, -1.0))
        for side in (record.measured_deg, record.reference_deg)
    )
    if other * 5.0 > own or own > 40.0 or own < 0.02:
        return None
    return f"atan2(vy, vx) is within {other:.3g} deg of reference_deg, and within {own:.3g} deg of measured_deg"


def _by_steps(record: Record) -> str | None:
    """A reading in one and the same step from row to row, as only what was set can be, and a reference that is not."""
    step = step_of_grid_deg(record.measured_deg, record.reference_deg)
    return None if step is None else f"measured_deg goes on by {step:.6g} deg in every row, reference_deg does not"


def _grid_deg(angle_deg: Array) -> float:
    """The smallest difference of two values: a column on a grid scatters by its steps, and says nothing by that."""
    steps = np.diff(np.unique(np.round(np.mod(angle_deg, 360.0), 6)))
    return float(np.min(steps)) if steps.size else 360.0


def _by_noise(record: Record) -> str | None:
    """A reference that scatters much more than the sensor from row to row of an even way."""
    from scipy.stats import f

    relation = record.relation
    assert relation is not None
    n = record.both.size
    noisy = white_noise(relation.travel_deg)
    quiet = white_noise(np.unwrap(record.measured_deg, period=360.0))
    # What a short word hides is no quietness.
    quiet = max(quiet, step_of_word(record.measured_deg) / np.sqrt(12.0), 1e-6)
    if n < 60 or noisy < max(_TIMES * quiet, 2.0 * _grid_deg(record.reference_deg)):
        return None
    # The median of n absolute third differences tells the variance about as well as a fifth of n squares would.
    if float(f.sf((noisy / quiet) ** 2 / _TIMES**2, n // 5, n // 5)) > FALSE_ALARM:
        return None
    return f"reference_deg scatters by {noisy:.3g} deg from row to row, measured_deg by {quiet:.3g} deg"
