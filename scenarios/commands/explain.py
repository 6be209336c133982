"""``halltwin explain``: what the simulation gets wrong about a measured sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from diagnosis import Explanation, explain
from diagnosis.report.console import show
from diagnosis.report.page import page
from scenarios.commands.outputs import HTML, JSON, PICTURE, TOML, OutputFiles, json_text
from scenarios.commands.progress import INTERRUPTED, ended_by_interrupt, progress_line
from twin.files import twin_text


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """What to write; None where not asked for. ``force``: also in place of files of others."""

    json: Path | None = None
    report: Path | None = None
    extended: Path | None = None
    plot: Path | None = None
    force: bool = False


def run(path: Path, *, twin: Path | None, outputs: Outputs, effect_files: Sequence[Path] = (), seed: int) -> None:
    """The command: print the answer, write what was asked for. Raises UserError before anything is written."""
    files = OutputFiles.checked(
        [(outputs.json, JSON), (outputs.report, HTML), (outputs.extended, TOML), (outputs.plot, PICTURE)],
        inputs=[path, twin, *effect_files],
        force=outputs.force,
    )
    found = _explained(path, twin=twin, effects=effect_files, seed=seed)
    answer = found.to_dict()
    try:
        show(answer)
    finally:
        # Whatever becomes of what is printed: the search took minutes.
        files.write(
            {
                outputs.json: lambda: json_text(answer),
                outputs.report: lambda: page(found.discovery, answer),
                outputs.extended: lambda: twin_text(found.extended),
                outputs.plot: found.plot,
            }
        )
    if answer["cut_short"] is not None:
        raise SystemExit(INTERRUPTED)


def _explained(path: Path, **given: Any) -> Explanation:
    """The answer, with a line that says where the search stands; Ctrl-C gives the answer so far, twice none."""
    with ended_by_interrupt(), progress_line("Ctrl-C: the answer so far") as listener:
        return explain(path, **given, progress=listener, on_interrupt="answer")
