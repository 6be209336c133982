"""Hold an answer of `halltwin explain` against the truth of a draw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

VERDICTS = ("right", "honest unnamed", "missed", "extra", "wrong name")
"""From the best to the worst. Honest unnamed: of what has a name it was said that there is something, and no name."""


def named(answer: Mapping[str, Any]) -> list[frozenset[str]]:
    """For each cause of the answer its name and the names it says it cannot be told from."""
    return [frozenset({entry["name"], *entry.get("indistinguishable_from", ())}) for entry in answer["causes"]]


def _most_matched(truth: Sequence[str], given: Sequence[frozenset[str]]) -> set[int]:
    """Positions in `given` of a largest one-to-one match with the truth."""
    taken: dict[int, str] = {}

    def place(name: str, seen: set[int]) -> bool:
        for position, names in enumerate(given):
            if name not in names or position in seen:
                continue
            seen.add(position)
            if position not in taken or place(taken[position], seen):
                taken[position] = name
                return True
        return False

    for name in truth:
        place(name, set())
    return set(taken)


def verdict(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> str:
    """One of VERDICTS.

    An entry of the answer fits a cause of the truth if it bears its name or lists it among those it
    cannot be told from. What the truth tolerates may be given or left out. Where several answers are
    right, the verdict is that against the one which comes nearest.
    """
    right_ones = truth.get("answers", [truth["causes"]])
    tolerated = frozenset(truth.get("tolerated", ()))
    best = min((_against(answer, list(causes), tolerated) for causes in right_ones), key=VERDICTS.index)
    if best == "wrong name" and truth.get("named", False):
        besides = {entry["name"] for entry in answer["causes"]} - tolerated
        return "honest unnamed" if besides == {"unnamed"} else best
    return best


def _against(answer: Mapping[str, Any], causes: Sequence[str], tolerated: frozenset[str]) -> str:
    """The verdict where these causes are the right ones."""
    matched = _most_matched(causes, named(answer))
    surplus = [
        position
        for position, entry in enumerate(answer["causes"])
        if position not in matched and entry["name"] not in tolerated
    ]
    short = len(matched) < len(causes)
    if short and surplus:
        return "wrong name"
    if short:
        return "missed"
    return "extra" if surplus else "right"


def right(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> bool:
    """Every cause matched one to one, and nothing besides."""
    return verdict(answer, truth) == "right"
