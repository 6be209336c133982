"""What all readings of a long record show beside what its searched part does: as plain values, and in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnosis.discovery.whole_record import WholeRecord
from diagnosis.report.answer import cause_entry
from diagnosis.report.rounded import rounded
from diagnosis.report.wording import plain

TITLE = "What all readings show beside"


def whole_answer(whole: WholeRecord | None) -> dict[str, Any]:
    """The part of the answer; empty where the record was searched in full, or is no longer than that."""
    if whole is None:
        return {}
    found, means = whole.found, whole.means
    told = {
        "readings": means.readings,
        "means": len(means.sweep),
        "readings_a_mean": means.each,
        "heldout_rms_deg": found.extended_held_deg,
        "causes": [cause_entry(found, cause) for cause in found.causes],
        "cut_short": found.cut_short,
    }
    return {"whole_record": rounded(told)}


def whole_words(answer: Mapping[str, Any]) -> str:
    """How all readings were looked at, and that nothing is there where nothing is; empty without them."""
    whole = answer.get("whole_record")
    if whole is None:
        return ""
    said = (
        f"{whole['readings']} readings as {whole['means']} means of some {plain(whole['readings_a_mean'], 2)}, by "
        "angle, direction and twelfth of the record"
    )
    if whole["cut_short"]:
        said += "; the search was ended early"
    return said if whole["causes"] else f"{said}: nothing beyond the above"
