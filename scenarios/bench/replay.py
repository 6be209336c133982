"""A recorded bus log read again: the same frames, the same readings, the same sweep."""

from __future__ import annotations

from pathlib import Path

from scenarios.bench.bus_log import check_log_name
from scenarios.bench.measure import Measured
from scenarios.bench.pretreatment import MANIFEST_DEG, pretreat, sweep_text
from scenarios.bench.readings import Assembler
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
) -> Measured:
    """Write the sweep of a log in one of python-can's formats. Raises UserError."""
    import can

    check_log_name(log)
    files = OutputFiles.checked([(output, MEASURED)], inputs=[log], force=force)
    if not log.is_file():
        raise UserError(f"{log}: no such file; give a log that --record wrote, or another of python-can's formats")
    assembler = Assembler(channels=channels, chamber=chamber)
    try:
        with can.LogReader(str(log)) as reader:
            for message in reader:
                assembler.feed(message)
    # The readers raise what their formats' parsers raise.
    except Exception as error:
        raise UserError(f"{log.name}: cannot be read as a bus log ({' '.join(str(error).split())})") from None
    if not assembler.readings:
        raise UserError(
            f"{log.name}: holds {assembler.counts['frames']} frames of the bench and no complete reading"
            "; try --no-channels or --no-chamber, where these were not on the bus"
        )
    pretreated = pretreat(assembler.readings, manifest_deg=manifest_deg)
    files.write({output: sweep_text(pretreated.kept)})
    return Measured(pretreated, assembler.counts, 0)
