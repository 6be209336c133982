"""Print how many 95 % intervals hold the truth, by cause and parameter, of one study or of several together.

    python -m tests.hidden.coverage_table study.json another.json

Only answers that were right count. ``half width`` is the median over the intervals, in the parameter's unit and over
the size of the truth: intervals that hold the truth too often are as wrong as those that do too seldom.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from statistics import median

from rich.console import Console
from rich.table import Table

from .coverage import Interval, measured, pooled

NORMAL_95 = 1.959964


def share_between(hits: int, total: int) -> tuple[float, float]:
    """95 % interval of a share, by hits of a total (Wilson's)."""
    square = NORMAL_95**2
    middle = (hits + 0.5 * square) / (total + square)
    half = NORMAL_95 * math.sqrt(hits * (total - hits) / total + 0.25 * square) / (total + square)
    return max(middle - half, 0.0), min(middle + half, 1.0)


def _row(name: str, intervals: Sequence[Interval]) -> tuple[str, ...]:
    """One line of the table."""
    total = len(intervals)
    below, above = (sum(one.miss == side for one in intervals) for side in (-1, 1))
    hits = total - below - above
    low, high = share_between(hits, total)
    figures = (f"{hits}/{total}", f"{hits / total:.3f}", f"{low:.3f} to {high:.3f}", str(below or ""), str(above or ""))
    if name == "all measured":
        return (name, *figures, "", "")
    relative = [one.half_width / abs(one.truth) for one in intervals if one.truth]
    share = f"{median(relative):.2g}" if relative and not name.partition(",")[0].endswith("phase_deg") else ""
    return (name, *figures, f"{median(one.half_width for one in intervals):.2g}", share)


def table(records: Iterable[Mapping[str, Interval]]) -> Table:
    """Share of intervals that hold the truth, its 95 % interval, on which side it was missed, and how wide they are."""
    found = pooled(records)
    every = found.pop("all measured", None)
    made = Table(title="95 % intervals that hold the truth, answers that were right", title_justify="left")
    made.add_column("parameter", no_wrap=True)
    for heading in ("held", "share", "95 %", "truth below", "above", "half width", "of the truth"):
        made.add_column(heading, justify="right")
    for name in sorted(name for name in found if measured(name)):
        made.add_row(*_row(name, found[name]))
    if every is not None:
        made.add_section()
        made.add_row(*_row("all measured", every))
        made.add_section()
    for name in sorted(name for name in found if not measured(name)):
        made.add_row(*_row(name, found[name]))
    return made


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    made = argparse.ArgumentParser(prog="python -m tests.hidden.coverage_table", description=__doc__.splitlines()[0])
    made.add_argument("studies", nargs="+", type=Path, help="files that python -m tests.hidden.study -o wrote")
    made.add_argument("--set", default="", help="comma-separated sets to keep")
    options = made.parse_args(arguments)
    only = frozenset(one for one in options.set.split(",") if one)
    drawn: dict[tuple[str, str], Mapping[str, Interval]] = {}
    for path in options.studies:
        for result in json.loads(path.read_text(encoding="utf-8"))["results"]:
            if result["verdict"] == "right" and (not only or result["group"] in only):
                # the same draw in two files counts once
                intervals = {label: Interval(**given) for label, given in result["intervals"].items()}
                drawn[result["group"], result["command"]] = intervals
    console = Console() if Console().is_terminal else Console(width=160)
    console.print(table(drawn.values()))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
