"""What has changed of a given twin, in words: each takes an entry of the answer, or the answer, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnosis.report.wording import around, figure, label, unit_shown
from twin.baseline import FACTORS

OTHER_DEVICE = "This is not that device's twin"


def change_name(change: Mapping[str, Any]) -> str:
    """A parameter of the twin that has changed, as people read it: a factor's name, or an effect's and its own."""
    effect, _, name = change["parameter"].rpartition(".")
    factor = next((one.label for one in FACTORS if (one.key, one.param) == (effect, name)), "")
    return factor or f"{effect.replace('#', ' ')} {label(name)}"


def change_line(change: Mapping[str, Any]) -> str:
    """What a parameter was and is, and whose it is."""
    told = {"value": change["is"], "low": change["low"], "high": change["high"]}
    value, half = figure(told)
    # To the digits of what it is: the two are compared.
    was, _ = figure(around(told, change["was"]) if half else {**told, **around(told, change["was"])})
    unit = unit_shown(change["unit"])
    before, after = (" ".join(part for part in parts if part) for parts in ((was, unit), (value, half, unit)))
    return f"was {before}, is {after}; it belongs to the {change['owner']}"


def change_rivals_words(answer: Mapping[str, Any], change: Mapping[str, Any]) -> str:
    """What a change cannot be told from; of another device's twin nobody has looked for it."""
    rivals = change["indistinguishable_from"]
    if not rivals and answer["other_device"]:
        return ""
    return f"cannot be told from: {', '.join(rivals) if rivals else 'nothing else that was searched'}"


def other_device_words(answer: Mapping[str, Any]) -> str:
    """That the given twin is another device's; empty where it is not."""
    if not answer["other_device"]:
        return ""
    moved = sum(change["owner"] == "device" for change in answer["changed"])
    if moved == 0:
        return f"{OTHER_DEVICE}, or it is wired otherwise: it counts the other way. "
    return f"{OTHER_DEVICE}: {moved} parameters that belong to a device are others. "
