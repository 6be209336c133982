"""A log with one angle alone: there is nothing that the sensor is held against."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from diagnosis.setup.finding import Finding
from diagnosis.setup.record import Record


def missing_reference(record: Record) -> Finding | None:
    """A sensor's angle without a reference."""
    if "reference_deg" in record.columns or "measured_deg" not in record.columns:
        return None
    return _finding("the log holds one angle, and no reference", record)


def hardly_a_reference(what: str, record: Record, *, option: str) -> Finding:
    """A column that follows the sensor's angle and is hardly a reference, for what is odd about it."""
    found = _finding(what, record)
    return replace(found, remedy=f"{found.remedy}; if it is a reference all the same, say it", columns=option)


def _finding(what: str, record: Record) -> Finding:
    return Finding(
        kind="no_reference",
        level="note",
        what=what,
        evidence=f"{int(np.isfinite(record.columns['measured_deg']).sum())} readings of the sensor alone",
        consequence="an error is a difference from a reference: without one it is told only against the shaft's own "
        "even turning, and its zero, slow drift and what a reversal leaves are not told at all",
        remedy="record a reference encoder, a stepper's count or a jig's angle beside it, as reference_deg; or let the "
        "shaft coast down and record time_s: explain and compensate take such a log",
    )
