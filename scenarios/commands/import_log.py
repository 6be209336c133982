"""``halltwin import``: a log with names and units of its own as a sweep."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from scenarios.commands.outputs import SWEEP, OutputFiles
from twin.logs.read import Log, read_log
from twin.recording_file import recording_of
from twin.shown_name import shown_name
from twin.spin import Spin
from twin.sweep import Sweep
from twin.sweep_file import csv_text


def run(log: Path, *, output: Path | None, columns: str | None, force: bool, max_bytes: int) -> None:
    """Read the log, say on standard error what was taken for what, and write the sweep where it was asked for.

    Raises UserError before anything is written: for a log that cannot be read, that two statements fit, or that
    holds no sweep.
    """
    files = OutputFiles.checked([(output, SWEEP)], inputs=[log], force=force)
    found = read_log(log, columns=columns, max_bytes=max_bytes)
    sweep = recording_of(found.columns, name=shown_name(log))
    for line in told(found, sweep):
        print(line, file=sys.stderr)
    # Rows that cannot be used stand in the sweep, too: their numbers are those of the log.
    kept = {name: values for name, values in found.columns.items() if name in sweep.columns}
    files.write({output: lambda: csv_text(kept)})
    files.tell_written()


def told(log: Log, sweep: Sweep | Spin) -> Iterator[str]:
    """What was read as what, in lines: the statement that says so, what was taken for granted, and what is not used."""
    lost = f", {len(sweep.rejected)} of them with missing cells" if sweep.rejected else ""
    yield f"{sweep.name}: {sweep.rows} rows{lost}; {'; '.join(log.table.notes) or 'columns by their names'}"
    yield f'read as: --columns "{log.guess.text}"'
    for note in log.guess.notes:
        yield f"taken for granted: {note}"
    empty = [name for name in log.columns if name not in sweep.columns]
    unused = [*log.guess.unused, *log.table.left, *(f"{name} (empty)" for name in empty)]
    yield f"not used: {', '.join(unused) or 'nothing is left'}"
