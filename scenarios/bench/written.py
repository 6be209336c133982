"""The files that a run on the bench leaves, and which of them may be replaced.

What was measured is replaced only with ``--force``: nobody can compute it again. A run that was broken off goes on with
the files that it wrote itself, which it knows by the digests in its journal.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from scenarios.bench.bus_log import LOG_FORMATS
from scenarios.bench.journal import finished_path, running_path
from scenarios.bench.journal_reader import written_by_run
from scenarios.commands.outputs import JSON, MEASURED, PICTURE, TOML, Format, OutputFiles, check_ending
from twin.ending import ending_of
from twin.errors import UserError
from twin.whole_file import is_stream

_LOG = Format("logs", (".jsonl",), marked=False)
_BUS_LOG = Format("bus logs", LOG_FORMATS, marked=False)


def part_path(output: Path, part: str, suffix: str) -> Path:
    """The name of one of the files of a closed loop."""
    name = output.name[: len(output.name) - len(ending_of(output))]
    return output.with_name(f"{name}-{part}{suffix}")


def record_path(record: Path, part: str) -> Path:
    """The name of the bus log of one half of a closed loop."""
    return record.with_name(f"{record.stem}-{part}{record.suffix}")


def files_of_measurement(
    output: Path, *, record: Path | None = None, inputs: Sequence[str | Path] = (), force: bool = False
) -> OutputFiles:
    """The sweep, its log, and the bus log. Raises UserError where one of them cannot or must not be written."""
    if is_stream(output):
        raise UserError(f"{output}: is no file; a measurement keeps its readings beside its sweep: give a file's name")
    given = [*_measured(output), (record, _BUS_LOG)]
    return OutputFiles.checked(given, inputs=inputs, force=force, unfinished=_unfinished(output))


def files_of_spin(
    output: Path, *, record: Path | None = None, inputs: Sequence[str | Path] = (), force: bool = False
) -> OutputFiles:
    """The log of a spin, and the bus log. Raises UserError as above."""
    return OutputFiles.checked([(output, MEASURED), (record, _BUS_LOG)], inputs=inputs, force=force)


def files_of_loop(
    output: Path,
    *,
    record: Path | None = None,
    plot: Path | None = None,
    inputs: Sequence[str | Path] = (),
    force: bool = False,
) -> OutputFiles:
    """Both sweeps with their logs, twin, correction, report and picture. Raises UserError as above."""
    check_ending(output, MEASURED)
    before, after = (part_path(output, part, ".csv") for part in ("before", "after"))
    given = [
        *_measured(before),
        (part_path(output, "twin", ".toml"), TOML),
        (part_path(output, "correction", ".toml"), TOML),
        *_measured(after),
        (part_path(output, "report", ".json"), JSON),
        (plot, PICTURE),
    ]
    if record is not None:
        given += [(record_path(record, part), _BUS_LOG) for part in ("before", "after")]
    return OutputFiles.checked(given, inputs=inputs, force=force, unfinished=_unfinished(before, after))


def _measured(sweep: Path) -> Iterator[tuple[Path, Format]]:
    yield sweep, MEASURED
    yield finished_path(sweep), _LOG


def _unfinished(*sweeps: Path) -> dict[Path, set[str]]:
    """The files that a run which broke off says to have written, each with the digests of what it wrote there."""
    found: dict[Path, set[str]] = {}
    for sweep in sweeps:
        for name, digests in written_by_run(running_path(sweep)).items():
            found.setdefault(sweep.with_name(name), set()).update(digests)
    return found
