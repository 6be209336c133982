"""Do the 95 % intervals of an answer hold what was put in?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from rich.table import Table


def held(answer: Mapping[str, Any], truth: Mapping[str, Any]) -> dict[str, bool]:
    """For "cause.parameter" of every cause named as it is: does its interval hold the truth?

    Phases are compared on the circle. Parameters that only one side gives are passed over.
    """
    found = {}
    for entry in answer["causes"]:
        put_in = truth["parameters"].get(entry["name"], {})
        for name, given in entry.get("parameters", {}).items():
            if name not in put_in or not isinstance(given, Mapping):
                continue
            low, high = given.get("low"), given.get("high")
            if low is None or high is None:
                continue
            actual = float(put_in[name])
            if name.endswith("phase_deg"):
                middle = 0.5 * (low + high)
                actual = middle + (actual - middle + 180.0) % 360.0 - 180.0
            # the file itself is rounded at the sixth digit
            found[f"{entry['name']}.{name}"] = bool(low - 1e-6 * abs(low) <= actual <= high + 1e-6 * abs(high))
    return found


def table(records: Iterable[Mapping[str, bool]]) -> Table:
    """Share of intervals that held the truth, by cause and parameter."""
    counts: dict[str, tuple[int, int]] = {}
    for record in records:
        for name, inside in record.items():
            hits, total = counts.get(name, (0, 0))
            counts[name] = (hits + inside, total + 1)
    made = Table(title="95 % intervals that hold the truth, answers that were right", title_justify="left")
    made.add_column("parameter", no_wrap=True)
    made.add_column("held", justify="right")
    made.add_column("share", justify="right")
    for name, (hits, total) in sorted(counts.items()):
        made.add_row(name, f"{hits}/{total}", f"{hits / total:.2f}")
    return made
