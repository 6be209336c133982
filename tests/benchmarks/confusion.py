"""The confusion matrix of one or several studies, as picture and table.

    python -m tests.benchmarks.confusion study1.json study2.json -o confusion.svg --table confusion.md

A row for everything that was hidden, a column for everything that was named. Each hidden cause counts once: where its
own name was given, else where the name of an entry was given that says it cannot be told from it, else where a name
was given that fits nothing hidden, else at "nothing". Names given beside all that was hidden have a row of their own.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from tests.hidden.catalogue import CAUSES

Kind = Literal["named", "not told apart", "wrong", "missed"]
KINDS: tuple[Kind, ...] = ("named", "not told apart", "missed", "wrong")
"""From best to worst; a clean sweep that nothing is named for is "named"."""
NOTHING, BESIDE, CLEAN = "nothing", "(beside it all)", "(clean)"
COLOURS = {"named": "#9ecae1", "not told apart": "#fdd49e", "missed": "#d9d9d9", "wrong": "#ef8a80"}
EXPLAINED = {
    "named": "the hidden cause named",
    "not told apart": "another name, said not to be told from the hidden cause",
    "missed": "hidden, and nothing named for it",
    "wrong": "named, and not hidden",
}


@dataclass(frozen=True)
class Cell:
    """One outcome: what was hidden, what was named for it, and what that is worth."""

    hidden: str
    given: str
    kind: Kind


def cells(result: Mapping[str, Any]) -> list[Cell]:
    """The outcomes of one draw, as a study records it."""
    truth = result["truth"]
    given = list(zip(result["names"], result["indistinguishable_from"], strict=True))
    tolerated = set(truth.get("tolerated", ()))
    if not truth["causes"]:
        named = [name for name, _ in given if name not in tolerated]
        return [Cell(CLEAN, name, "wrong") for name in named] or [Cell(CLEAN, NOTHING, "named")]
    found: list[Cell] = []
    open_to: list[str] = []
    for hidden in truth["causes"]:
        own = next((entry for entry in given if entry[0] == hidden), None)
        if own is None:
            open_to.append(hidden)
            continue
        given.remove(own)
        found.append(Cell(hidden, hidden, "named"))
    for hidden in list(open_to):
        other = next((entry for entry in given if hidden in entry[1]), None)
        if other is not None:
            given.remove(other)
            open_to.remove(hidden)
            found.append(Cell(hidden, other[0], "not told apart"))
    surplus = [name for name, _ in given if name not in tolerated]
    for hidden in open_to:
        found.append(Cell(hidden, surplus.pop(0), "wrong") if surplus else Cell(hidden, NOTHING, "missed"))
    return found + [Cell(BESIDE, name, "wrong") for name in surplus]


@dataclass(frozen=True)
class Confusion:
    """Counts by row, column and kind."""

    counts: Mapping[tuple[str, str, Kind], int]

    @property
    def rows(self) -> list[str]:
        """What was hidden: causes in the catalogue's order, then what has no name."""
        present = {hidden for hidden, _, _ in self.counts}
        return [one for one in (*CAUSES, "unnamed", CLEAN, BESIDE) if one in present]

    @property
    def columns(self) -> list[str]:
        """What was named, the hidden causes first so that agreement is the diagonal."""
        present = {given for _, given, _ in self.counts} | {one for one in self.rows if one not in (CLEAN, BESIDE)}
        known = [one for one in (*CAUSES, "unnamed") if one in present]
        return [*known, *sorted(present - {*known, NOTHING}), NOTHING]

    def kinds(self, row: str, column: str) -> dict[Kind, int]:
        """Counts of a cell that are not zero, from best to worst."""
        every: dict[Kind, int] = {kind: self.counts.get((row, column, kind), 0) for kind in KINDS}
        return {kind: count for kind, count in every.items() if count}


def confusion(results: Iterable[Mapping[str, Any]]) -> Confusion:
    """The matrix of these draws; those whose answer failed count as nothing named."""
    counts: Counter[tuple[str, str, Kind]] = Counter()
    for result in results:
        counts.update((cell.hidden, cell.given, cell.kind) for cell in cells(result))
    return Confusion(dict(counts))


def markdown(matrix: Confusion) -> str:
    """One line a row: how often it was hidden and named, and where the rest went."""
    lines = ["| hidden | draws | named | not told apart | missed | wrong names |", "|---|---:|---:|---:|---:|---|"]
    for row in matrix.rows:
        sums: Counter[str] = Counter()
        elsewhere: dict[str, list[str]] = {"not told apart": [], "wrong": []}
        for column in matrix.columns:
            for kind, count in matrix.kinds(row, column).items():
                sums[kind] += count
                if kind in elsewhere:
                    elsewhere[kind].append(f"{column} {count}")
        total = "" if row == BESIDE else str(sum(sums.values()))
        named = "" if row == BESIDE else str(sums["named"])
        lines.append(
            f"| {row} | {total} | {named} | {', '.join(elsewhere['not told apart'])} "
            f"| {sums['missed'] or ''} | {', '.join(elsewhere['wrong'])} |"
        )
    return "\n".join(lines) + "\n"


def plot(matrix: Confusion, path: Path) -> None:
    """The matrix with its counts. UserError where the picture cannot be drawn."""
    from diagnosis.report.plotting import save, style

    plt = style(path)
    rows, columns = matrix.rows, matrix.columns
    figure, axes = plt.subplots(figsize=(max(1.9 + 0.225 * len(columns), 5.5), 2.3 + 0.2 * len(rows)))
    for down, row in enumerate(rows):
        for across, column in enumerate(columns):
            kinds = matrix.kinds(row, column)
            if not kinds:
                continue
            worst = list(kinds)[-1]
            axes.add_patch(plt.Rectangle((across - 0.5, down - 0.5), 1, 1, color=COLOURS[worst], lw=0))
            axes.text(across, down, str(sum(kinds.values())), ha="center", va="center", fontsize=7)
    axes.set_xlim(-0.5, len(columns) - 0.5)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.set_xticks(range(len(columns)), columns, rotation=90, fontsize=7)
    axes.set_yticks(range(len(rows)), rows, fontsize=7)
    axes.set_xticks([k - 0.5 for k in range(len(columns) + 1)], minor=True)
    axes.set_yticks([k - 0.5 for k in range(len(rows) + 1)], minor=True)
    axes.grid(which="minor", color="0.88", lw=0.5)
    axes.tick_params(which="both", length=0)
    axes.xaxis.tick_top()
    axes.xaxis.set_label_position("top")
    axes.set_xlabel("named by the answer, number of draws", fontsize=8.5)
    axes.set_ylabel("hidden in the sweep", fontsize=8.5)
    for spine in axes.spines.values():
        spine.set_color("0.7")
    samples = [plt.Rectangle((0, 0), 1, 1, color=COLOURS[kind]) for kind in KINDS]
    axes.legend(
        samples,
        [EXPLAINED[kind] for kind in KINDS],
        loc="upper center",
        bbox_to_anchor=(0.4, -0.01),
        ncol=2,
        fontsize=7.5,
        frameon=False,
    )
    figure.tight_layout()
    save(figure, path)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    made = argparse.ArgumentParser(prog="python -m tests.benchmarks.confusion", description=__doc__.splitlines()[0])
    made.add_argument("studies", nargs="+", type=Path, help="JSON files of tests.hidden.study")
    made.add_argument("-o", "--output", type=Path, help="picture: .svg, .png or .pdf")
    made.add_argument("--table", type=Path, help="the same as a Markdown table")
    options = made.parse_args(arguments)
    results = [result for path in options.studies for result in json.loads(path.read_text(encoding="utf-8"))["results"]]
    matrix = confusion(results)
    text = markdown(matrix)
    if options.table is not None:
        options.table.write_text(text, encoding="utf-8")
    if options.output is not None:
        plot(matrix, options.output)
    if options.table is None and options.output is None:
        print(text, end="")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
