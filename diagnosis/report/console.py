"""The answer of ``halltwin explain`` as a person reads it in a terminal."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from diagnosis.report import statements
from diagnosis.report.change_words import change_line, change_name, change_rivals_words
from diagnosis.report.motion import motion_words
from diagnosis.report.over_class import in_factors_words, open_words
from diagnosis.report.recordings import recordings_notes, recordings_table, where_words
from diagnosis.report.rivals_words import rivals_words
from diagnosis.report.row_counts import explained_rows
from diagnosis.report.setup_words import setup_block
from diagnosis.report.statements import FactorRow
from diagnosis.report.sweep_words import sweep_facts
from diagnosis.report.whole_record import TITLE, whole_words
from diagnosis.report.wording import assumed_words, chance

_ALL_SAID = ("adequate", "explained")
"""Verdicts that leave nothing open."""
_NARROW = 72
"""Characters from which on two factors stand beside each other."""
_WRONG = "What the simulation gets wrong"
_CHANGED = "What has changed since the twin"
_HEADS = ("held-out RMS, deg", "false alarm")
_PLACE = 3
"""Characters of a cause's number."""
_GAPS = 9
"""Those between the columns of the causes, and behind the last one."""
_WIDE = 120
"""Characters of a terminal on which three factors stand beside each other; no column moves further apart beyond."""


def show(answer: Mapping[str, Any], console: Console | None = None) -> None:
    """Print an answer: sweep, baseline, causes, verdict, and what this sweep cannot show."""
    console = console or Console(highlight=False)
    parts = [
        _sweep(answer["sweep"]),
        _motion(answer),
        _setup(answer),
        _baseline(answer, beside=3 if console.width >= _WIDE else 2 if console.width >= _NARROW else 1),
        _changes(answer, width=min(console.width, _WIDE)),
        _causes(answer, width=min(console.width, _WIDE)),
        _whole_record(answer, width=min(console.width, _WIDE)),
        _verdict(answer),
        _recordings(answer),
        _invisible(answer),
    ]
    for number, part in enumerate(part for part in parts if part is not None):
        if number:
            console.print()
        console.print(part, crop=False)


def text(answer: Mapping[str, Any], *, width: int) -> str:
    """What :func:`show` prints, in lines of this many characters, without colours."""
    out = io.StringIO()
    show(answer, Console(file=out, width=width, highlight=False, color_system=None, force_jupyter=False))
    return out.getvalue().removesuffix("\n")


def _sweep(sweep: Mapping[str, Any]) -> RenderableType:
    said = f"{', '.join(sweep_facts(sweep))}; {explained_rows(sweep)}"
    return Text.assemble((sweep["name"], "bold"), "   ", said)


def _motion(answer: Mapping[str, Any]) -> RenderableType | None:
    """How the motion was come by where no reference was recorded; None where one was."""
    said = motion_words(answer)
    return Group(*(_indented(f"{words}.") for words in said)) if said else None


def _setup(answer: Mapping[str, Any]) -> RenderableType | None:
    """What of the set-up has to be mended; None where nothing has."""
    faults = [found for found in answer["setup"] if found["level"] == "fault"]
    return setup_block(faults, "Set-up, to be mended first") if faults else None


def _baseline(answer: Mapping[str, Any], *, beside: int) -> RenderableType:
    rows = statements.factor_rows(answer)
    table = _extended(rows, statements.after_head(answer)) if rows[0].after else _plain(rows, beside=beside)
    said = filter(None, (statements.moved_words(answer), open_words(answer), statements.senses_words(answer)))
    return Group(
        Text(statements.baseline_words(answer), "bold"),
        _indented(statements.floor_words(answer)),
        Padding(table, (0, 0, 0, 2)),
        *map(_indented, said),
    )


def _indented(words: str) -> RenderableType:
    return Padding(Text(words), (0, 0, 0, 2))


def _plain(rows: Iterable[FactorRow], *, beside: int) -> Table:
    """The factors, several beside each other."""
    table = _grid(3 * beside)
    cells = [(row.label, f"{row.before} ({row.flag})" if row.flag else row.before) for row in rows]
    for start in range(0, len(cells), beside):
        table.add_row(*(cell for pair in cells[start : start + beside] for cell in (*pair, "")))
    return table


def _grid(columns: int) -> Table:
    """A table without lines, whose cells are wrapped where they have no room, and never cut."""
    table = Table.grid(padding=(0, 2, 0, 0))
    for _ in range(columns):
        table.add_column(overflow="fold")
    return table


def _extended(rows: Iterable[FactorRow], after: str) -> Table:
    """The factors before the causes and with them, or in the twin and in this sweep."""
    table = _grid(4)
    table.add_row("", Text("before", "dim"), Text(after, "dim"), "")
    for row in rows:
        table.add_row(row.label, row.before, row.after, row.flag)
    return table


@dataclass(frozen=True)
class _Entry:
    """One row of a list with its figures, and the lines below it."""

    name: str
    figures: tuple[str, str]
    lines: list[str]


def _causes(answer: Mapping[str, Any], *, width: int) -> RenderableType | None:
    return _listed(_WRONG, _cause_entries(answer, answer["causes"]), width=width)


def _cause_entries(answer: Mapping[str, Any], causes: Iterable[Mapping[str, Any]]) -> list[_Entry]:
    return [
        _Entry(cause["name"], _figures(cause, cause["false_alarm_probability"]), _details(answer, cause))
        for cause in causes
    ]


def _whole_record(answer: Mapping[str, Any], *, width: int) -> RenderableType | None:
    """What all readings of a long record show beside; None where all of them were searched."""
    said = whole_words(answer)
    if not said:
        return None
    listed = _listed(TITLE, _cause_entries(answer, answer["whole_record"]["causes"]), width=width)
    return Group(listed or Text(TITLE, "bold"), _indented(f"{said}."))


def _changes(answer: Mapping[str, Any], *, width: int) -> RenderableType | None:
    """What of a given twin has changed."""
    return _listed(
        _CHANGED,
        [
            _Entry(
                change_name(change),
                _figures(change, change["p"]),
                [*filter(None, (change_line(change), change_rivals_words(answer, change)))],
            )
            for change in answer["changed"]
        ],
        width=width,
    )


def _figures(step: Mapping[str, Any], probability: float | None) -> tuple[str, str]:
    return statements.held_words(step), chance(probability)


def _listed(title: str, entries: Sequence[_Entry], *, width: int) -> RenderableType | None:
    """Entries under a title, with their figures in columns where there is room; None where there are none."""
    if not entries:
        return None
    widths = [max(map(len, column)) for column in zip(_HEADS, *(entry.figures for entry in entries), strict=True)]
    unbroken = [*title.split(), *(word for entry in entries for word in entry.name.split())]
    longest = max(map(len, unbroken))
    if width < _PLACE + sum(widths) + _GAPS + longest:
        return _below_each_other(title, entries)
    head = _columns(width, widths)
    head.add_row("", Text(title, "bold"), *_HEADS)
    parts: list[RenderableType] = [head]
    for number, entry in enumerate(entries, 1):
        row = _columns(width, widths)
        row.add_row(str(number), Text(entry.name, "bold"), *entry.figures)
        parts.append(row)
        parts.extend(Padding(Text(line), (0, 0, 0, 5)) for line in entry.lines)
    return Group(*parts)


def _below_each_other(title: str, entries: Sequence[_Entry]) -> RenderableType:
    """Entries on a terminal that is too narrow for columns: no name is cut, every figure on a line of its own."""
    parts: list[RenderableType] = [Text(title, "bold")]
    for number, entry in enumerate(entries, 1):
        parts.append(Text.assemble(f"{number:{_PLACE}}  ", (entry.name, "bold")))
        lines = [f"{head}: {figure}" for head, figure in zip(_HEADS, entry.figures, strict=True)]
        parts.extend(Padding(Text(line), (0, 0, 0, 5)) for line in (*lines, *entry.lines))
    return Group(*parts)


def _columns(width: int, figures: Sequence[int]) -> Table:
    """Number, name, held-out RMS, chance: the same widths for every cause, so that they stand in columns."""
    table = Table.grid(padding=(0, 2, 0, 0))
    table.width = width
    table.add_column(justify="right", width=_PLACE)
    table.add_column(ratio=1)
    table.add_column(width=figures[0] + 1, no_wrap=True)
    table.add_column(width=figures[1], no_wrap=True)
    return table


def _details(answer: Mapping[str, Any], cause: Mapping[str, Any]) -> list[str]:
    """A cause's parameters and what else it might be; structure without a name in words."""
    lines = statements.parameter_lines(answer, cause)
    figures = (assumed_words(cause), where_words(cause), statements.single_rows_words(cause))
    return [*lines, *filter(None, (*figures, rivals_words(cause)))]


def _verdict(answer: Mapping[str, Any]) -> RenderableType:
    verdict = answer["verdict"]
    said = f". {statements.verdict_words(answer)}"
    style = "green" if verdict in _ALL_SAID else "yellow"
    return Text.assemble(("Verdict: ", "bold"), (verdict, f"bold {style}"), said)


def _recordings(answer: Mapping[str, Any]) -> RenderableType | None:
    """Several recordings side by side; None for a single one."""
    heads, rows = recordings_table(answer)
    if not rows:
        return None
    table = _grid(len(heads))
    table.add_row(*(Text(head, "dim") for head in heads))
    for row in rows:
        table.add_row(*row)
    return Group(Text("The recordings, RMS error in deg", "bold"), table, *map(_indented, recordings_notes(answer)))


def _invisible(answer: Mapping[str, Any]) -> RenderableType | None:
    said = statements.invisible_words(answer)
    where = statements.recordings_shown(answer)
    words = filter(None, (said and f"Not visible in {where}: {said}", in_factors_words(answer)))
    return Text(". ".join(words), "dim") if said else None
