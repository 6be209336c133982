"""The sweep that the page explains: from the command line, or a file that was dropped."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from scenarios.commands.inputs import ENDINGS, SweepFiles, sweep_paths
from scenarios.lab.dropped import kept
from scenarios.lab.server import Upload
from twin.errors import UserError
from twin.shown_name import shown_name, shown_path

_EXAMPLE = Path(__file__).parents[1] / "data" / "bench_sweep.csv"


@dataclass(frozen=True)
class Recording:
    """A sweep's file, what it is called, and how a command line would name it."""

    path: Path
    name: str
    shown: str


def named(name: str) -> Recording:
    """The sweep of the command line, read once to see that it is one. Raises UserError."""
    found = sweep_paths([name])
    if len(found) != 1:
        raise UserError(f"{name}: stands for {len(found)} sweeps; the page explains one: give one file")
    SweepFiles([name]).recording(found[0])
    return Recording(found[0], shown_name(found[0]), shown_path(found[0]))


def example() -> Recording:
    """The sweep of the worked example, which comes with the program."""
    here = Path.cwd()
    path = Path(os.path.relpath(_EXAMPLE, here)) if _EXAMPLE.is_relative_to(here) else _EXAMPLE
    return Recording(_EXAMPLE, _EXAMPLE.name, shown_path(path))


def dropped(upload: Upload, folder: Path) -> Recording:
    """A file that was dropped on the page, not yet read. Raises UserError for what no sweep is called."""
    path, name = kept(upload, folder, stem="sweep", endings=ENDINGS)
    return Recording(path, name, name)
