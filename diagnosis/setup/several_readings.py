"""A log that can be read in several ways: which these are, and what is wrong with it in whichever way it is read."""

from __future__ import annotations

from dataclasses import replace

from diagnosis.setup.checks import AMBIGUOUS, Checked, checked
from diagnosis.setup.finding import Finding
from diagnosis.setup.of_log import LogRecord


def checked_log(read: LogRecord) -> Checked:
    """Make every check of a log; of one that can be read in several ways those findings hold that all of them have.

    What is found in some ways alone may be made by the reading: with sensor and reference exchanged they are swapped.
    """
    first = checked(read.record, read.findings)
    if not read.otherwise:
        return first
    rest = [checked(one.record, one.findings) for one in read.otherwise]
    found = [_ambiguous(read)]
    for finding in first.findings:
        alike = [[one for one in other.findings if one.kind == finding.kind] for other in rest]
        if all(alike):
            same = all(one[0].columns == finding.columns for one in alike)
            found.append(finding if same else replace(finding, columns=""))
    return Checked(tuple(found), first.not_checked)


def _ambiguous(read: LogRecord) -> Finding:
    options = (read.read_as, *(one.read_as for one in read.otherwise))
    return Finding(
        kind=AMBIGUOUS,
        what="the log can be read in several ways",
        evidence=f"{len(options)} statements fit its names and values equally well",
        consequence="none is taken: what follows holds for all of them, and what depends on the choice is not told",
        remedy="say which is meant, or name the columns reference_deg and measured_deg, in degrees",
        options=options,
    )
