"""``--fail-on``: what a script asks about, and whether an answer holds it.

Every command answers with exit code 0, whatever it found, and with 2 where it cannot answer. What is named by
``--fail-on`` turns the first into 1, after everything was written.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from twin.errors import UserError
from twin.known_names import nearest
from twin.shown import shown


class FoundError(Exception):
    """The command has answered, and ends with exit code 1: what was asked about was found, or a file was left out."""


def asked(given: Sequence[str], known: Iterable[str]) -> tuple[str, ...]:
    """The words of the option, which may hold several with commas between. Raises UserError for an unknown one."""
    words = tuple(dict.fromkeys(word.strip() for text in given for word in text.split(",")))
    listed = list(dict.fromkeys(known))
    for word in words:
        if word not in listed:
            raise UserError(f"--fail-on is {shown(word)}{nearest(word, listed)}; expected among {', '.join(listed)}")
    return words


def raise_found(words: Iterable[str], found: Mapping[str, str]) -> None:
    """Raise FoundError where one of the words was found; ``found`` says in words what."""
    hits = [f"{word} ({found[word]})" if found[word] != word else word for word in words if word in found]
    if hits:
        raise FoundError(f"found {', '.join(hits)}, as --fail-on asks")


# ---- what the answers hold --------------------------------------------------------------------------------------

EXPLAIN = ("cause", "unexplained", "changed", "other-device", "rejected")
"""Beside these the name of any cause, and those of the set-up."""
DIAGNOSE = ("undetermined", "gross-errors", "rejected")
MONITOR = ("drift",)
"""Beside it the name of any factor."""
COMPENSATE = ("worse",)
EXPORT = ("worse",)
DOCTOR = ("fault", "note")
"""Of the set-up; beside these the kind of any finding."""
BENCH = ("missed",)


def in_explanation(answer: Mapping[str, Any]) -> dict[str, str]:
    """What an answer of ``explain`` holds; a cause also where the sweep cannot tell it from one that was named."""
    named = [cause for cause in answer["causes"] if cause["name"] != "unnamed"]
    found = {cause["name"]: cause["name"] for cause in named}
    for cause in named:
        for rival in cause["indistinguishable_from"]:
            found.setdefault(rival, f"cannot be told from {cause['name']}")
    if named:
        found["cause"] = ", ".join(cause["name"] for cause in named)
    if len(named) < len(answer["causes"]):
        found["unexplained"] = "structure without a name"
    elif answer.get("misfits"):
        found["unexplained"] = f"held against {answer['misfits'][0]['against']}, {answer['misfits'][0]['what']}"
    if answer["changed"]:
        found["changed"] = ", ".join(change["parameter"] for change in answer["changed"])
    if answer["other_device"]:
        found["other-device"] = "the twin is another device's"
    # A word that is a cause too, as time_jitter, is found where either is.
    found = in_setup(answer) | found
    return found | _rejected(answer["sweep"]["name"], answer["sweep"]["rejected"])


def in_setup(answer: Mapping[str, Any]) -> dict[str, str]:
    """What an answer holds, for ``--fail-on``."""
    found = {finding["kind"]: finding["what"] for finding in answer["setup"]}
    for level in DOCTOR:
        kinds = [finding["kind"] for finding in answer["setup"] if finding["level"] == level]
        if kinds:
            found[level] = ", ".join(kinds)
    return found


def in_diagnoses(answer: Mapping[str, Any]) -> dict[str, str]:
    """What an answer of ``diagnose`` holds; of many sweeps the first one with it is told."""
    found: dict[str, str] = {}
    for sweep in reversed(answer["sweeps"]):
        name = sweep["sweep"]
        weak = [factor for factor, told in sweep["parameters"].items() if _undetermined(told)]
        if weak:
            found["undetermined"] = f"{', '.join(weak)} of {name}"
        if sweep["glitch_rows"]:
            found["gross-errors"] = f"{len(sweep['glitch_rows'])} in {name}"
        found |= _rejected(name, sweep["rejected"])
    return found


def in_loop(report: Mapping[str, Any]) -> dict[str, str]:
    """What the report of a closed loop holds."""
    if report["reached"]:
        return {}
    return {"missed": f"largest error {report['after']['largest_deg']:.3f} deg, aim {report['aim_deg']:g} deg"}


def _undetermined(parameter: Mapping[str, Any]) -> bool:
    """Whether the readings leave a factor open: at the model's limit, or without a bound on one side."""
    ends = (parameter["low"], parameter["high"], *parameter.get("profile", ()))
    return bool(parameter["at_bound"]) or None in ends


def _rejected(name: str, rows: int) -> dict[str, str]:
    return {"rejected": f"{rows} {'row' if rows == 1 else 'rows'} of {name}"} if rows else {}
