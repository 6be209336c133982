"""How many readings there are, and what became of each: unusable, left out of the fits, or fitted; the counts add up.

What is said is made of the content of the JSON and of nothing else, so that all commands say the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from twin.sweep import Sweep

MOST_LISTED = 100
"""Rows that the JSON lists by their number; how many more there are is said beside the list."""
MOST_TOLD = 5
"""Rows that a sentence lists by their number."""
_MOST_SWEEPS = 5


def counts_of(sweep: Sweep, glitch_rows: Sequence[int]) -> dict[str, Any]:
    """The counts of a sweep of which these rows, by their numbers, were set aside as gross errors, as plain values."""
    return {
        "rows": sweep.rows,
        "rejected": len(sweep.rejected),
        "rejected_rows": {str(row): why for row, why in list(sweep.rejected.items())[:MOST_LISTED]},
        "rejected_rows_left_out": max(len(sweep.rejected) - MOST_LISTED, 0),
        "glitch_rows": list(glitch_rows),
        "fitted": len(sweep) - len(glitch_rows),
    }


def explained_rows(sweep: Mapping[str, Any]) -> str:
    """What became of the readings of a sweep that was explained."""
    wild, touched, doubt = (sweep.get(key, 0) for key in ("wild", "touched", "direction_in_doubt"))
    return _counted(
        [
            rejected_words(sweep),
            wild and f"{_alone(wild)} ({rows_listed(sweep['wild_rows'], wild)})",
            touched and f"{touched} touched by a cause of single readings",
            doubt and f"{doubt} of a direction in doubt",
        ],
        fitted=sweep["fitted"],
        everything="all of them fitted" if sweep.get("set_aside") else "all fitted",
    )


def diagnosed_rows(sweep: Mapping[str, Any]) -> str:
    """What became of the readings of a sweep that the error model was fitted to."""
    gross = sweep["glitch_rows"]
    return _counted(
        [rejected_words(sweep), gross and f"{_errors(len(gross))} set aside ({rows_listed(gross, len(gross))})"],
        fitted=sweep["fitted"],
    )


def left_out_words(sweeps: Sequence[Mapping[str, Any]]) -> str:
    """Which of several sweeps were not fitted whole, and how many readings are missing; empty where none."""
    told = []
    for sweep in sweeps:
        rejected, gross = sweep["rejected"], len(sweep["glitch_rows"])
        counts = [f"{rejected} rejected" if rejected else "", _errors(gross) if gross else ""]
        if any(counts):
            told.append(f"{' and '.join(filter(None, counts))} in {sweep['sweep']}")
    if not told:
        return ""
    more = f", and some in {len(told) - _MOST_SWEEPS} more" if len(told) > _MOST_SWEEPS else ""
    return f"readings that were not fitted: {', '.join(told[:_MOST_SWEEPS])}{more}"


def rejected_words(sweep: Mapping[str, Any]) -> str:
    """How many rows could not be used, which, and why; empty where all could."""
    if not sweep["rejected"]:
        return ""
    rows_by_reason: dict[str, list[str]] = {}
    for row, why in sweep["rejected_rows"].items():
        rows_by_reason.setdefault(why, []).append(row)
    listed = [f"{rows_listed(rows, len(rows))}: {why}" for why, rows in rows_by_reason.items()]
    more = sweep.get("rejected_rows_left_out", 0)
    if more:
        listed.append(f"and {more} more")
    return f"{sweep['rejected']} rejected ({'; '.join(listed)})"


def rows_listed(rows: Sequence[object], count: int, most: int = MOST_TOLD) -> str:
    """The first few of so many rows, and how many more there are."""
    more = count - min(len(rows), most)
    told = ", ".join(str(row) for row in rows[:most])
    return f"{'row' if count == 1 else 'rows'} {told}{f' and {more} more' if more else ''}"


def _counted(left_out: Iterable[str | int | Sequence[object]], *, fitted: int, everything: str = "all fitted") -> str:
    """What is left out, and how many readings the fits are made of."""
    told = [part for part in left_out if isinstance(part, str) and part]
    return f"{', '.join(told)}; {fitted} fitted" if told else everything


def _alone(count: int) -> str:
    return f"{count} {'stands' if count == 1 else 'stand'} alone"


def _errors(count: int) -> str:
    return f"{count} gross {'error' if count == 1 else 'errors'}"
