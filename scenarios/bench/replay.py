"""A recorded bus log read again: the same frames, the same readings, the same sweep, or the same log of a spin."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from scenarios.bench.bus_log import check_log_name
from scenarios.bench.measure import Measured
from scenarios.bench.messages import messages
from scenarios.bench.pretreatment import MANIFEST_DEG, pretreat, sweep_text
from scenarios.bench.readings import Assembler, Collector
from scenarios.bench.spin import SpinAssembler, Spun, spin_text
from scenarios.commands.outputs import MEASURED, OutputFiles
from twin.errors import UserError


def replay(
    log: Path,
    output: Path,
    *,
    channels: bool = True,
    chamber: bool = True,
    manifest_deg: float = MANIFEST_DEG,
    force: bool = False,
) -> Measured | Spun:
    """Write the sweep of a log in one of python-can's formats, or the spin's where it is one's. Raises UserError."""
    check_log_name(log)
    files = OutputFiles.checked([(output, MEASURED)], inputs=[log], force=force)
    if not log.is_file():
        raise UserError(f"{log}: no such file; give a log that --record wrote, or another of python-can's formats")
    # What a run asks for first tells which it was: no need to read on.
    names = (messages().name_of(message) for message in _frames(log))
    first = next((name for name in names if name in (SpinAssembler.request, Assembler.request)), None)
    if first == SpinAssembler.request:
        spun = SpinAssembler(channels=channels)
        _feed(spun, log, "--no-channels, where these")
        files.write({output: spin_text(spun.readings)})
        return Spun(len(spun.readings), spun.counts)
    assembler = Assembler(channels=channels, chamber=chamber)
    _feed(assembler, log, "--no-channels or --no-chamber, where these")
    pretreated = pretreat(assembler.readings, manifest_deg=manifest_deg)
    files.write({output: sweep_text(pretreated.kept)})
    return Measured(pretreated, assembler.counts, 0)


def _frames(log: Path) -> Iterator[Any]:
    """The frames of a log one after another. Raises UserError."""
    import can

    try:
        with can.LogReader(str(log)) as reader:
            yield from reader
    # The readers raise what their formats' parsers raise.
    except Exception as error:
        raise UserError(f"{log.name}: cannot be read as a bus log ({' '.join(str(error).split())})") from None


def _feed(assembler: Collector[Any], log: Path, unless: str) -> None:
    """Have the frames of a log made into readings. Raises UserError where none is complete."""
    for message in _frames(log):
        assembler.feed(message)
    if not assembler.readings:
        raise UserError(
            f"{log.name}: holds {assembler.counts['frames']} frames of the bench and no complete reading"
            f"; try {unless} were not on the bus"
        )
