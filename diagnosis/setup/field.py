"""The field at the sensor: too weak, too strong, or of a magnet that is off centre."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import FALSE_ALARM, amplitudes, fitted, noise_floor, times_sure, waves, white_noise
from diagnosis.setup.magnet_presence import axial_magnet
from diagnosis.setup.record import FEWEST, Record
from twin.angles import Array
from twin.sweep_columns import SMALLEST_AMPLITUDE

_NOISIEST_DEG = 1.0
"""Noise of a reading: ten times what data sheets state of sensors in the field they are made for (0.1 deg RMS)."""
_MODULATED = 0.10
"""Share by which a dipole's field goes up and down twice a turn at a sensor that is a quarter of its distance off the
axis: along the offset the field is 1 - 3 (d/R)^2 of that across it."""
_CHANNELS_MODULATED = 0.17
"""The same of two channels, whose gains and offsets of their own make a part of it."""
_FAR_OFF_DEG = 8.0
"""Amplitude of order 1 or 2 in the error from which on no tolerance of a sensor makes it: 14 % of offset, or of 28 %
between the gains."""
_WEAK_BITS, _STRONG_BITS, _PRESENT = 16, 8, 32
"""Of the status word of AS5600 and its kin: magnet too weak, too strong, detected."""
_END_ON_3V3 = 128.0
"""Where the gain of an AS5600 on 3.3 V ends by its data sheet (AGC register): the middle of its range on 5 V."""


def too_weak(record: Record) -> Finding | None:
    """A field that is too weak: the gain at its end, a reading that scatters, the sensor's own word."""
    if (empty := _without_signal(record)) is not None:
        return empty
    said = _gain_at_end(record) or _status_says(record, _WEAK_BITS) or _scatters(record)
    if said is None:
        return _may_be_at_end(record)
    return Finding(
        kind="weak_field",
        what="the magnet is too weak or too far away",
        evidence=said,
        consequence="the reading scatters, and offsets and stray fields weigh more than they need to",
        remedy="bring the magnet nearer, or take a stronger one",
    )


def _without_signal(record: Record) -> Finding | None:
    """A channel whose largest reading is none."""
    for name in ("vx", "vy"):
        values = record.column(name)
        largest = 0.0 if values is None else float(np.max(np.abs(values), initial=0.0))
        if 0.0 < largest < SMALLEST_AMPLITUDE:
            return Finding(
                kind="weak_field",
                what="a channel holds no signal: no field is there, or its scale is wrong",
                evidence=f"{name} is never larger than {largest:.3g}; a signal has at least {SMALLEST_AMPLITUDE:g} in "
                "its unit",
                consequence="no angle can be computed from it, and explain and diagnose refuse the log",
                remedy="scale both channels, or leave them out",
            )
    return None


def _may_be_at_end(record: Record) -> Finding | None:
    """A gain that stands at the end of one supply's range, which is the middle of the other's."""
    if _constant(record.column("agc")) != _END_ON_3V3 or _status_says(record, _PRESENT) is not None:
        return None
    return Finding(
        kind="weak_field",
        level="note",
        what="the magnet is too weak or too far away, if the sensor is an AS5600 on 3.3 V",
        evidence="agc is 128 in every row: the end of its range on 3.3 V, the middle of it on 5 V",
        consequence="at its end the gain no longer makes up for the field: it scatters, and stray fields weigh more",
        remedy=f"read the status: bit {_WEAK_BITS.bit_length() - 1} says whether the field is too weak; on 3.3 V bring "
        "the magnet nearer until agc is about 64",
    )


def _constant(values: Array | None) -> float | None:
    """The one value of a column, None where there are more, or too few readings."""
    if values is None:
        return None
    known = values[np.isfinite(values)]
    return float(known[0]) if known.size >= FEWEST and np.ptp(known) == 0.0 else None


def _all_ones(value: float) -> bool:
    """Whether a number is the largest of a word of 6 bits or more."""
    return value >= 63.0 and value % 1.0 == 0.0 and (int(value) & (int(value) + 1)) == 0


def _gain_at_end(record: Record) -> str | None:
    agc, field = _constant(record.column("agc")), _constant(record.column("magnitude"))
    if agc is not None and _all_ones(agc):
        return f"agc stands at its end, {agc:g}, in every row"
    if field == 0.0:
        return "magnitude is 0 in every row"
    return None


def _status_says(record: Record, bit: int) -> str | None:
    status = record.column("status")
    if status is None:
        return None
    known = status[np.isfinite(status)]
    whole = known.size >= FEWEST and bool(np.all((known % 1.0 == 0.0) & (known >= 0.0) & (known < 64.0)))
    words = known.astype(np.int64) if whole else np.zeros(0, dtype=np.int64)
    if not words.size or np.any(words & 7) or np.mean((words & bit) > 0) < 0.5:
        return None
    usual = int(np.bincount(words).argmax())
    return f"status is {usual} in most rows: bit {bit.bit_length() - 1} of AS5600 and its kin says so"


def _noise_deg(record: Record) -> float:
    """What of the error is white beside its orders."""
    relation = record.relation
    return (
        0.0
        if relation is None or not relation.follows
        else noise_floor(np.where(relation.fit.kept, relation.fit.left, 0.0))
    )


def _scatters(record: Record) -> str | None:
    noise = _noise_deg(record)
    relation = record.relation
    if relation is None or noise < _NOISIEST_DEG:
        return None
    n = record.both.size
    # The median of n/2 exponential powers is uncertain by 2/(ln 2 sqrt(2 n)) of itself, its root by half of that.
    if noise * (1.0 - times_sure() / (np.log(2.0) * np.sqrt(2.0 * n))) < _NOISIEST_DEG:
        return None
    return f"the reading scatters by {noise:.2g} deg from row to row; data sheets state 0.1 deg or less"


def too_strong(record: Record) -> Finding | None:
    """A field that is too strong: the gain at its other end, a magnitude or channels that stop at a limit."""
    agc, field = _constant(record.column("agc")), _constant(record.column("magnitude"))
    said = None
    if agc == 0.0 and _constant(record.column("status")) != 0.0:
        said = "agc stands at its end, 0, in every row"
    elif field is not None and _all_ones(field):
        said = f"magnitude stands at its end, {field:g}, in every row"
    said = said or _status_says(record, _STRONG_BITS) or _clipped(record)
    if said is None:
        return None
    return Finding(
        kind="strong_field",
        what="the magnet is too strong or too near",
        evidence=said,
        consequence="the channels stop at a limit: errors of order 4 and higher, which no linear correction takes off",
        remedy="move the magnet away, or take a weaker one",
    )


def _clipped(record: Record) -> str | None:
    """Channels that stay at their largest and smallest value for longer than a sine does."""
    from scipy.stats import binom

    found = []
    for name in ("vx", "vy"):
        values = record.column(name)
        if values is None or values.size < FEWEST or not np.isfinite(values).all() or np.ptp(values) == 0.0:
            return None
        # A sine is within one step of its end for this share of the turn. Noise brings no more readings to the end
        # than lie within its mean positive part, 0.4 sigma, of it: a sine is the rarer the farther from its end.
        near = float(np.min(np.diff(np.unique(values)))) + 0.4 * white_noise(values)
        share = float(np.arccos(1.0 - min(2.0 * near / float(np.ptp(values)), 2.0)) / np.pi)
        for end in (values.max(), values.min()):
            # One row after the other: at angles that come again a sine meets its largest value again, too.
            count = int(np.sum((values[1:] == end) & (values[:-1] == end)))
            chance = float(binom.sf(count - 1, values.size, share))
            found.append((count, chance))
    if max(chance for _, chance in found) > FALSE_ALARM or min(count for count, _ in found) < FEWEST:
        return None
    return f"vx and vy stay at their largest and smallest value in {sum(count for count, _ in found)} rows"


def off_centre(record: Record) -> Finding | None:
    """A magnet or a sensor off the shaft's axis: a field that goes up and down with the turn, or very large errors."""
    relation = record.relation
    if relation is None or not relation.follows or relation.turns < 0.9 or record.both.size < 24:
        return None
    if axial_magnet(record) is not None:
        return None
    said = _modulated(record) or _large_orders(record)
    if said is None:
        return None
    return Finding(
        kind="off_centre",
        what="the magnet or the sensor is off the shaft's axis, or another field adds to the magnet's",
        evidence=said,
        consequence="errors of orders 1 and 2 far beyond a sensor's own, which change with every mounting",
        remedy="centre magnet and sensor on the axis; keep motors, magnets and iron away, or shield",
    )


def _modulated(record: Record) -> str | None:
    vx, vy = record.column("vx"), record.column("vy")
    by_channels = None if vx is None or vy is None else np.hypot(vx, vy)
    sides = (("magnitude", _MODULATED), ("agc", _MODULATED))
    for name, values, least in (
        *((name, record.column(name), least) for name, least in sides),
        ("the radius of vx, vy", by_channels, _CHANNELS_MODULATED),
    ):
        if values is None or not np.isfinite(values).all() or float(np.median(values)) <= 0.0:
            continue
        share, error, order = _modulation(record, values)
        if share - times_sure() * error > 0.0 and share > least:
            return f"{name} goes up and down by {100.0 * share:.0f} % with order {order} of the turn"
    return None


def _modulation(record: Record, values: Array) -> tuple[float, float, int]:
    """The larger of orders 1 and 2 in a column (m,) as a share of its mean, its standard error, and which one it is."""
    relation = record.relation
    assert relation is not None
    fit = fitted([np.ones_like(values), *waves(np.radians(relation.travel_deg), (1, 2))], values)
    size, error = amplitudes(fit, 1, 2)
    best = int(np.argmax(size))
    mean = abs(float(fit.values[0]))
    return float(size[best]) / mean, float(error[best]) / mean, best + 1


def _large_orders(record: Record) -> str | None:
    relation = record.relation
    assert relation is not None
    if relation.fit.values.size < 6:
        return None
    size, error = amplitudes(relation.fit, 2, 2)
    best = int(np.argmax(size))
    if size[best] - times_sure() * error[best] < _FAR_OFF_DEG:
        return None
    return f"the error has {size[best]:.1f} deg of order {best + 1}"
