"""An answer in the words that the page shows: those of the terminal and the report, each figure the answer's own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnosis.report import statements, sweep_words
from diagnosis.report.change_words import change_name
from diagnosis.report.rivals_words import rivals_words
from diagnosis.report.wording import assumed_words, chance


def told_of(answer: Mapping[str, Any]) -> dict[str, Any]:
    """Verdict, figures, causes and what to measure next."""
    return {
        "name": answer["sweep"]["name"],
        "verdict": answer["verdict"],
        "verdict_words": statements.verdict_words(answer),
        "sweep_words": ", ".join(sweep_words.sweep_facts(answer["sweep"])),
        "read_words": _read_words(answer["sweep"]),
        "cut_short": answer["cut_short"],
        "figures": {
            "measured_deg": answer["baseline"]["fitted_error_rms_deg"],
            "baseline_deg": answer["baseline"]["fitted_rms_deg"],
            "baseline_held_out_deg": answer["baseline"]["heldout_rms_deg"],
            "extended_held_out_deg": answer["extended"]["heldout_rms_deg"],
            "gain": answer["extended"]["gain"],
            "noise_floor_deg": answer["noise_floor_deg"] if statements.floor_is_known(answer) else None,
        },
        "held_against": answer["sweep"]["held_against"],
        "changed": [
            f"{change_name(change)}: held-out {statements.held_words(change)} deg" for change in answer["changed"]
        ],
        "causes": [_cause(answer, cause) for cause in answer["causes"]],
        "factors": [row._asdict() for row in statements.factor_rows(answer)],
        "setup": [
            f"{one['what']}: {one['evidence']}; {one['remedy']}" for one in answer["setup"] if one["level"] == "fault"
        ],
        "next": _next(answer),
    }


def _read_words(sweep: Mapping[str, Any]) -> str:
    """By which guess a log under names of its own was read; empty for a sweep's own columns."""
    if sweep["read_as"] is None:
        return ""
    granted = f"; taken for granted: {'; '.join(sweep['notes'])}" if sweep["notes"] else ""
    unused = f"; not used: {', '.join(sweep['not_used'])}" if sweep["not_used"] else ""
    return f" Read as {sweep['read_as']}{granted}{unused}."


def _cause(answer: Mapping[str, Any], cause: Mapping[str, Any]) -> dict[str, Any]:
    """One cause in words."""
    said = (assumed_words(cause), statements.single_rows_words(cause), rivals_words(cause))
    return {
        "name": cause["name"],
        "stage": cause["stage"],
        "parameters": statements.parameter_lines(answer, cause),
        "held_out": statements.held_words(cause),
        "false_alarm": chance(cause["false_alarm_probability"]),
        "said": [statements.sentence(words) for words in said if words],
    }


def _parting(cause: Mapping[str, Any]) -> dict[str, str]:
    """What parts a cause from those that explain the readings as well."""
    todo = cause["to_tell_apart"]
    if todo.startswith("from "):
        # It says itself what each step tells the cause from.
        return {"do": f"tell {cause['name'].replace('_', ' ')} {todo}", "why": ""}
    return {"do": todo, "why": f"tells {cause['name']} from {', '.join(cause['indistinguishable_from'])}"}


def _next(answer: Mapping[str, Any]) -> list[dict[str, str]]:
    """What to measure next: what parts causes that these readings cannot, then what would show further ones."""
    found = [_parting(cause) for cause in answer["causes"] if cause["to_tell_apart"]]
    for names, _, todo in statements.not_visible(answer["not_visible"]):
        found.append({"do": todo, "why": f"would show {', '.join(names)}"})
    return found
