"""Whether sensor and reference are read at the same instant: a delay, times the speed, is an error."""

from __future__ import annotations

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.harmonics import fitted, times_sure, waves
from diagnosis.setup.record import Record
from twin.angles import Array

_FEWEST = 64
_TWO_SPEEDS = 0.2
"""Share of the fastest by which speeds differ at least: at one speed a delay is a part of the zero."""
_LEAST_DEG = 0.5
"""Of less it is the delay of a sensor, which the search names; of more one of the two is read late."""
_DEG_PER_S = 6.0
"""Of one revolution a minute."""


def read_late(record: Record) -> Finding | None:
    """An error that grows with the speed, of sensor and reference that are not read together."""
    relation, speed = record.relation, record.column("speed_rpm")
    if relation is None or not relation.follows or speed is None or speed.size < _FEWEST:
        return None
    if not np.isfinite(speed).all() or np.quantile(np.abs(speed), 0.98) <= 0.0:
        return None
    way = np.sign(np.diff(relation.travel_deg, prepend=2.0 * relation.travel_deg[0] - relation.travel_deg[1]))
    signed = np.abs(speed) * way
    slow, fast = np.quantile(np.abs(speed), [0.02, 0.98])
    if fast - slow <= _TWO_SPEEDS * fast:
        return None
    late = _delay(signed, way, relation.error_at_one_deg, np.radians(relation.travel_deg))
    if late is None:
        return None
    delay_s, moved_deg = late
    if moved_deg < _LEAST_DEG:
        return None
    which = "the sensor" if delay_s * relation.ratio < 0.0 else "the reference"
    return Finding(
        kind="read_late",
        level="note",
        what=f"{which} is read later than the other",
        evidence=f"the error moves by {moved_deg:.2f} deg between {slow:.3g} and {fast:.3g} rpm, as with "
        f"{abs(delay_s) * 1e3:.3g} ms between the two",
        consequence="at speed the delay stands in the zero, and it is a part of whatever latency is named",
        remedy="latch both at one signal, or stamp each and interpolate",
    )


def _delay(speed_rpm: Array, way: Array, error_deg: Array, shaft_rad: Array) -> tuple[float, float] | None:
    """The delay [s] of an error (n,) that goes with the speed, and its size [deg]; None where a slope fits better."""
    rest = [np.ones_like(speed_rpm), *([way] if np.ptp(way) > 0.0 else []), *waves(shaft_rad, (1, 2, 3, 4))]
    fit = fitted([rest[0], speed_rpm, *rest[1:]], error_deg)
    if fit.sigma > fitted([*rest, shaft_rad - float(np.mean(shaft_rad))], error_deg).sigma:
        return None
    slope, error = float(fit.values[1]), float(fit.errors[1])
    if abs(slope) <= times_sure() * error:
        return None
    size = np.abs(speed_rpm)
    return slope / _DEG_PER_S, abs(slope) * float(np.quantile(size, 0.98) - np.quantile(size, 0.02))
