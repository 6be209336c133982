"""The answer of ``halltwin explain`` as a person reads it in a terminal."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from diagnosis.report.wording import (
    BASELINE_LABELS,
    chance,
    explained_percent,
    instances,
    not_visible,
    parameter_line,
    plain,
    rejected_words,
    structure_words,
    verdict_words,
    with_unit,
)

_VERDICT_STYLE = {"adequate": "green", "explained": "green", "partly explained": "yellow", "unnamed": "yellow"}


def show(answer: Mapping[str, Any], console: Console | None = None) -> None:
    """Print an answer: sweep, baseline, causes, verdict, and what this sweep cannot show."""
    console = console or Console(highlight=False)
    parts = [_sweep(answer["sweep"]), _baseline(answer), _causes(answer), _verdict(answer), _not_visible(answer)]
    for number, part in enumerate(part for part in parts if part is not None):
        if number:
            console.print()
        console.print(part)


def text(answer: Mapping[str, Any], *, width: int) -> str:
    """What :func:`show` prints, in lines of this many characters, without colours."""
    out = io.StringIO()
    show(answer, Console(file=out, width=width, highlight=False, color_system=None, force_jupyter=False))
    return out.getvalue().removesuffix("\n")


def _sweep(sweep: Mapping[str, Any]) -> RenderableType:
    turns = sweep["turns"]
    said = [
        f"{sweep['rows']} readings",
        f"{plain(turns, 2 if turns < 10 else 3)} {'turn' if turns < 1.05 else 'turns'}",
    ]
    if "directions" in sweep:
        said.append("both directions" if sweep["directions"] == 2 else "one direction")
    if "points_per_turn" in sweep:
        said.append(f"{plain(360.0 / sweep['points_per_turn'], 2)} deg apart")
    if sweep["output_bits"] is not None:
        said.append(f"output on a {sweep['output_bits']}-bit grid")
    wild = f"; {sweep['wild']} stand alone and were not fitted" if sweep.get("wild") else ""
    return Text.assemble((sweep["name"], "bold"), "   ", ", ".join(said), f"; {rejected_words(sweep)}{wild}")


def _baseline(answer: Mapping[str, Any]) -> RenderableType:
    baseline = answer["baseline"]
    before = answer["sweep"].get("error_rms_deg")
    after = baseline["rms_deg"]
    model = "The given twin" if answer["sweep"].get("held_against") == "given twin" else "The paper's error model"
    head = f"{model} leaves {plain(after)} deg RMS"
    if before is not None:
        share = f"{explained_percent(before, after):.0f} % of the error"
        head = f"{model} explains {share}: {plain(before)} -> {plain(after)} deg RMS"
    floor = Text(f"noise floor {plain(answer['noise_floor_deg'])} deg RMS")
    table = Table.grid(padding=(0, 2, 0, 0))
    cells = []
    for name, (label, unit, scale) in BASELINE_LABELS.items():
        parameter = baseline["parameters"][name]
        flag = " (at its bound)" if parameter["at_bound"] else ""
        cells.append((label, with_unit(parameter, unit, scale) + flag))
    for left, right in zip(cells[::2], cells[1::2], strict=True):
        table.add_row(left[0], left[1], "", right[0], right[1])
    return Group(Text(head, "bold"), Padding(floor, (0, 0, 0, 2)), Padding(table, (0, 0, 0, 2)))


def _causes(answer: Mapping[str, Any]) -> RenderableType | None:
    if not answer["causes"]:
        return None
    head = _columns()
    head.add_row("", Text("What the simulation gets wrong", "bold"), "held-out RMS, deg", "false alarm")
    parts: list[RenderableType] = [head]
    for number, cause in enumerate(answer["causes"], 1):
        row = _columns()
        held = f"{plain(cause['heldout_rms_deg_before'])} -> {plain(cause['heldout_rms_deg_after'])}"
        row.add_row(str(number), Text(cause["name"], "bold"), held, chance(cause["false_alarm_probability"]))
        parts.append(row)
        parts.extend(Padding(Text(line), (0, 0, 0, 5)) for line in _details(answer, cause))
    return Group(*parts)


def _columns() -> Table:
    """Number, name, held-out RMS, chance: the same widths for every cause, so that they stand in columns."""
    table = Table.grid(expand=True, padding=(0, 2, 0, 0))
    table.add_column(justify="right", width=3)
    table.add_column(ratio=1)
    table.add_column(width=18, no_wrap=True)
    table.add_column(width=11, no_wrap=True)
    return table


def _details(answer: Mapping[str, Any], cause: Mapping[str, Any]) -> list[str]:
    """A cause's parameters and what else it might be; structure without a name in words."""
    if cause["name"] == "unnamed":
        return [structure_words(structure) for structure in answer["unexplained"]["structure"]]
    lines = [line for line in map(parameter_line, instances(cause["parameters"])) if line]
    rows = cause.get("rows", [])
    if rows:
        lines.append(f"{'row' if len(rows) == 1 else 'rows'} {', '.join(map(str, rows[:8]))}{' ...' * (len(rows) > 8)}")
    rivals = cause["indistinguishable_from"]
    if rivals:
        part = f". To tell them apart: {cause['to_tell_apart']}" if cause["to_tell_apart"] else ""
        lines.append(f"cannot be told from: {', '.join(rivals)}{part}")
    else:
        lines.append("cannot be told from: nothing else that was searched")
    return lines


def _verdict(answer: Mapping[str, Any]) -> RenderableType:
    verdict = answer["verdict"]
    return Text.assemble(
        ("Verdict: ", "bold"), (verdict, f"bold {_VERDICT_STYLE[verdict]}"), f". {verdict_words(answer)}"
    )


def _not_visible(answer: Mapping[str, Any]) -> RenderableType | None:
    groups = not_visible(answer["not_visible"])
    if not groups:
        return None
    said = "; ".join(f"{', '.join(names)} ({missing})" for names, missing, _ in groups)
    return Text(f"Not visible in this sweep: {said}", "dim")
