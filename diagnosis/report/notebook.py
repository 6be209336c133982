"""The answer as a notebook shows it: the verdict and a table of the causes."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from diagnosis.report.change_words import change_line, change_name
from diagnosis.report.statements import extends, parameter_lines, verdict_words
from diagnosis.report.tables import number, table
from diagnosis.report.wording import chance

_HEADS = ("cause", "parameters", "held-out RMS before / deg", "after / deg", "chance of a false alarm")


def notebook_html(answer: Mapping[str, Any]) -> str:
    """A fragment of HTML that takes its looks from the notebook."""
    name, verdict = escape(answer["sweep"]["name"]), escape(answer["verdict"])
    said = f"<p><b>{name}: {verdict}.</b> {escape(verdict_words(answer))}</p>"
    if not extends(answer):
        return said
    rows = [
        [
            escape(change_name(change)),
            escape(change_line(change)),
            number(change["heldout_rms_deg_before"]),
            number(change["heldout_rms_deg_after"]),
            number(change["p"], chance(change["p"])),
        ]
        for change in answer["changed"]
    ]
    rows += [
        [
            escape(cause["name"]),
            "<br>".join(map(escape, parameter_lines(answer, cause))),
            number(cause["heldout_rms_deg_before"]),
            number(cause["heldout_rms_deg_after"]),
            number(cause["false_alarm_probability"], chance(cause["false_alarm_probability"])),
        ]
        for cause in answer["causes"]
    ]
    return said + table(_HEADS, rows, numbers=(2, 3, 4), stacked=False)
