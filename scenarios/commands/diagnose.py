"""``halltwin diagnose``: the paper's error factors of one or many sweeps, with what each figure is worth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from diagnosis import diagnose_many
from scenarios.commands.fail_on import DIAGNOSE, asked, in_diagnoses, raise_found
from scenarios.commands.inputs import SweepFiles, check_panels
from scenarios.commands.outputs import JSON, PICTURE, OutputFiles, json_text
from scenarios.commands.progress import progress_line
from scenarios.commands.terminal import terminal_width


def run(
    given: SweepFiles,
    *,
    json_path: Path | None = None,
    plot: Path | None = None,
    convergence: Path | None = None,
    force: bool = False,
    seed: int = 0,
    fail_on: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """Diagnose what the names stand for; print the answer; write JSON and pictures where asked."""
    words = asked(fail_on, DIAGNOSE)
    paths = given.paths()
    files = OutputFiles.checked([(json_path, JSON), (plot, PICTURE), (convergence, PICTURE)], inputs=paths, force=force)
    read = given.read(paths)
    check_panels(plot, len(read.sweeps))
    with progress_line() as listener:
        found = diagnose_many(read.sweeps, seed=seed, progress=listener)
    found = replace(found, made=replace(found.made, command=command))
    answer = {**found.to_dict(), "unusable": read.listed()}
    try:
        for line in (found.summary(terminal_width()), *read.lines):
            print(line)
    finally:
        files.write({json_path: lambda: json_text(answer), plot: found.plot, convergence: found.plot_convergence})
    for written in files.formats:
        print(f"wrote {written}")
    raise_found(words, in_diagnoses(answer))
    read.raise_unusable()
