"""The checks of a set-up, in the order in which a person would look: is there a signal, in which units, when."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.setup.channels import mid_range, swapped_channels
from diagnosis.setup.clock import backwards, jitter_of_time, unit_of_time
from diagnosis.setup.closure import turn_not_closed
from diagnosis.setup.field import off_centre, too_strong, too_weak
from diagnosis.setup.finding import Finding
from diagnosis.setup.frozen import frozen
from diagnosis.setup.instant import read_late
from diagnosis.setup.link import lost_frames, other_status
from diagnosis.setup.magnet_presence import axial_magnet, missing_magnet
from diagnosis.setup.missing_reference import missing_reference
from diagnosis.setup.ratio import counts_a_turn, counts_the_other_way, pole_pairs, units
from diagnosis.setup.record import Record
from diagnosis.setup.roles import coarse_reference, swapped_roles
from diagnosis.setup.sampling import aliased_frequency, aliased_order, few_points, part_of_a_turn
from diagnosis.setup.sensor_alone import by_reading, gaps_in_time, no_turning, other_turn
from diagnosis.setup.typing_error import typing_error
from diagnosis.setup.word import OF_WORD, without_faults_of_word
from twin.sweep import Sweep


@dataclass(frozen=True)
class Check:
    """One check: the kinds that it finds, what it asks of a record, and the columns without which it says nothing.

    Of angles with a finding that ``ends``, no further check of angles means anything.
    """

    kinds: tuple[str, ...]
    find: Callable[[Record], Finding | None]
    needs: tuple[str, ...] = ("reference_deg", "measured_deg")
    ends: bool = False


_CLOCK = ("reference_deg", "measured_deg", "time_s")
_CHANNELS = ("reference_deg", "measured_deg", "vx", "vy")
CHECKS: tuple[Check, ...] = (
    Check(("no_reference",), missing_reference, ()),
    Check(("frozen",), frozen, ends=True),
    Check(("units",), units, ends=True),
    Check(("axial_magnet",), axial_magnet, ends=True),
    Check(("no_magnet",), missing_magnet, ends=True),
    Check(("pole_pairs",), pole_pairs),
    Check(("wrong_counts",), counts_a_turn),
    Check(("other_way",), counts_the_other_way),
    Check(("mid_range",), mid_range, _CHANNELS),
    Check(("swapped_channels",), swapped_channels, _CHANNELS),
    Check(("swapped_roles",), swapped_roles),
    Check(("coarse_reference",), coarse_reference),
    Check(("read_late",), read_late, ("reference_deg", "measured_deg", "speed_rpm")),
    Check(("weak_field",), too_weak),
    Check(("strong_field",), too_strong),
    Check(("off_centre",), off_centre),
    Check(("turn_not_closed",), turn_not_closed),
    Check(("typing_error",), typing_error),
    Check(("few_points",), few_points),
    Check(("part_of_a_turn",), part_of_a_turn),
    Check(("aliased_order",), aliased_order),
    Check(("aliased_frequency",), aliased_frequency, _CLOCK),
    Check(("time_backwards",), backwards, _CLOCK),
    Check(("time_unit",), unit_of_time, _CLOCK),
    Check(("time_coarse", "time_jitter"), jitter_of_time, _CLOCK),
    Check(("lost_frames",), lost_frames, ("frame",)),
    Check(("other_status",), other_status, ("status",)),
)
"""Every check, in order."""
_ALONE, _ALONE_CLOCK = ("measured_deg",), ("measured_deg", "time_s")
WITHOUT_REFERENCE: tuple[Check, ...] = (
    Check(("no_turning",), no_turning, _ALONE),
    Check(("units", "wrong_counts"), other_turn, _ALONE),
    Check(("gaps_in_time",), gaps_in_time, _ALONE_CLOCK),
    Check(("time_backwards",), by_reading(backwards), _ALONE_CLOCK),
    Check(("time_unit",), by_reading(unit_of_time), _ALONE_CLOCK),
    Check(("time_coarse", "time_jitter"), by_reading(jitter_of_time), _ALONE_CLOCK),
)
"""Checks that take the place of those of the same kinds where the sensor stands alone."""
AMBIGUOUS = "ambiguous"
"""Of a log that can be read in several ways, see :mod:`diagnosis.setup.several_readings`."""
KINDS = tuple(
    dict.fromkeys((AMBIGUOUS, *OF_WORD, *(kind for check in (*CHECKS, *WITHOUT_REFERENCE) for kind in check.kinds)))
)
"""The words of all findings."""


@dataclass(frozen=True)
class Checked:
    """What the checks found, and which could not be made, each with the columns that it lacks."""

    findings: tuple[Finding, ...]
    not_checked: dict[str, tuple[str, ...]]


def checked(record: Record, found_before: tuple[Finding, ...] = ()) -> Checked:
    """Make every check that the record's columns allow; what was found as it was read stands before the rest.

    Faults of the words are told first and taken off: what they do to a reading is no fault of magnet or reference.
    """
    of_words, record = without_faults_of_word(record)
    findings = [*found_before, *of_words]
    lacking: dict[str, tuple[str, ...]] = {}
    ended = False
    alone = () if "reference_deg" in record.columns else WITHOUT_REFERENCE
    replaced = {kind for check in alone for kind in check.kinds}
    told = {finding.kind for finding in found_before}
    for check in (*(one for one in CHECKS if not replaced & set(one.kinds)), *alone):
        if told >= set(check.kinds):
            continue
        if ended and "reference_deg" in check.needs:
            continue
        missing = tuple(name for name in check.needs if name not in record.columns)
        if missing:
            lacking.update(dict.fromkeys(check.kinds, missing))
            continue
        found = check.find(record)
        if found is not None:
            findings.append(found)
            ended = ended or check.ends
    return Checked(tuple(findings), lacking)


def checked_sweep(sweep: Sweep) -> tuple[Finding, ...]:
    """What is wrong with the set-up of a sweep; of several recordings with each, by its number.

    Faults of the word are left out: ``explain`` names them as causes.
    """
    if sweep.recordings is None:
        return _of_turn(sweep) + _but_of_words(checked(Record.of(sweep)))
    rows = np.arange(len(sweep))
    alone = replace(sweep, recordings=None)
    return tuple(
        replace(finding, evidence=f"recording {number}: {finding.evidence}")
        for number, part in enumerate(sweep.recordings.slices, 1)
        for one in (alone.part(rows[part]),)
        for finding in _of_turn(one) + _but_of_words(checked(Record.of(one)))
    )


def _of_turn(sweep: Sweep) -> tuple[Finding, ...]:
    """Of an estimated motion, whether the readings begin anew with the turn: the motion is made of them."""
    found = None if sweep.estimated is None else other_turn(Record.of(sweep))
    return () if found is None else (found,)


def _but_of_words(found: Checked) -> tuple[Finding, ...]:
    return tuple(finding for finding in found.findings if finding.kind not in OF_WORD)
