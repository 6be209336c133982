"""Faults of the word that a link delivers: told by the words themselves, and taken off ahead of all other checks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.setup.finding import Finding, rows_shown
from diagnosis.setup.frozen import frozen
from diagnosis.setup.harmonics import FALSE_ALARM
from diagnosis.setup.record import FEWEST, Record
from twin.angles import radians
from twin.words import InWords, WordFault, Words, faults_of

OF_WORD = ("error_code", "word_bit", "dead_zone")
"""The causes of the link that stand in single words, whatever the shaft does."""


@dataclass(frozen=True)
class _Said:
    what: str
    consequence: str
    remedy: str


_SAID = {
    "error_code": _Said(
        "a fixed word stands in the place of some readings",
        "these readings are no angles; explain, diagnose and compensate leave them out, a control that uses them jumps",
        "look for lost or timed-out transfers on the link, and leave these rows out",
    ),
    "word_bit": _Said(
        "a bit of the word is not read as what it is",
        "the reading jumps by whole bits, which no error of the sensor is; explain and compensate take it off",
        "check the length, order and shift of the word where it is decoded, the clock's edge, and the line itself",
    ),
    "dead_zone": _Said(
        "a part of the word's range is never read",
        "the angle stands still there; no correction brings it back",
        "set the sensor's start and stop positions and its output range to the whole turn",
    ),
}


def without_faults_of_word(record: Record) -> tuple[tuple[Finding, ...], Record]:
    """What is wrong with the words, and the record without it: readings told back, lost ones left out.

    Parameters
    ----------
    record : Record
        Both angles in degrees, or else nothing is found.

    Returns
    -------
    tuple of Finding, Record
        The very same record where nothing is found.
    """
    from twin.catalogue import CATALOGUE

    finders = {e.name: e.in_words for e in CATALOGUE if e.name in OF_WORD and e.in_words is not None}
    both = record.both
    if both.size < FEWEST:
        return (), record
    words = Words(radians(record.reference_deg), radians(record.measured_deg), np.ones(both.size, dtype=bool))
    faults = faults_of(words, finders, float(np.log(FALSE_ALARM)))
    faults = tuple(one for one in faults if not _stood_still_once(record, *one))
    if not faults:
        return (), record
    found = _findings(record, faults, finders)
    measured = record.columns["measured_deg"].copy()
    for _, fault in faults:
        words = words.without(fault)
        measured[both[fault.touched]] = np.degrees(words.measured[fault.touched]) % 360.0
    for _, fault in faults:
        measured[both[fault.lost]] = np.nan
    return found, replace(record, columns={**record.columns, "measured_deg": measured})


def _stood_still_once(record: Record, name: str, fault: WordFault) -> bool:
    """Whether a range is missing because the reading stood still once, over more than a word's dead zone has.

    Within a single turn a column that is frozen leaves the same gap; a dead zone holds in every turn.
    """
    stretch = frozen(record) if name == "dead_zone" else None
    if stretch is None:
        return False
    touched = np.flatnonzero(fault.touched)
    return bool(np.all(np.diff(touched) == 1)) and set(record.rows(touched)) <= set(stretch.rows)


def _findings(
    record: Record, faults: tuple[tuple[str, WordFault], ...], finders: Mapping[str, InWords]
) -> tuple[Finding, ...]:
    found = []
    for name, fault in faults:
        rows = record.rows(np.flatnonzero(fault.touched))
        said = _SAID[name]
        seen = rows_shown(rows) if finders[name].rows_listed else f"{len(rows)} of {record.both.size} readings"
        found.append(
            Finding(
                kind=name,
                what=said.what,
                evidence=f"{finders[name].said(fault.values)}: {seen}",
                consequence=said.consequence,
                remedy=said.remedy,
                rows=rows,
            )
        )
    return tuple(found)
