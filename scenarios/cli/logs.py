"""The commands on logs of any kind: into the columns of a sweep, and what is wrong with their set-up."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import Columns, Force, Json, MaxSize, PolePairs, fail_on_option, written
from scenarios.cli.reproduce import command_line


def import_log(
    log: Annotated[
        Path,
        typer.Argument(
            metavar="LOG",
            help="A log (CSV of any dialect, XLSX, MAT, NPZ, HDF5, Parquet, MDF, TDMS, of a bus) or a firmware table.",
        ),
    ],
    output: Annotated[
        Path | None, written("Sweep to write: .csv or .csv.gz; without it the guess is told alone.", "-o", "--output")
    ] = None,
    columns: Columns = None,
    force: Force = False,
    max_size: MaxSize = "2GB",
) -> None:
    """Read a log with names and units of its own as a sweep, and say with which --columns every command reads it.

    What the columns mean is guessed from names, units and values; of two guesses that fit, both are told, none taken.
    """
    from scenarios.commands.import_log import run
    from twin.bounded_input import bytes_of

    run(log, output=output, columns=columns, force=force, max_bytes=bytes_of(max_size))


def doctor(
    context: typer.Context,
    log: Annotated[
        Path,
        typer.Argument(metavar="LOG", help="A sweep, or a log of any kind that halltwin import reads."),
    ],
    columns: Columns = None,
    pole_pairs: PolePairs = None,
    json: Json = None,
    force: Force = False,
    fail_on: Annotated[
        list[str] | None, fail_on_option("fault, note, or the KIND of a finding such as axial_magnet")
    ] = None,
    max_size: MaxSize = "2GB",
) -> None:
    """Check the set-up of a recording: magnet, pole pairs, senses, units, counts, clock, frames, points a turn.

    Each finding says what it is seen in, what becomes of an answer with it, and what to do.
    """
    from scenarios.commands.doctor import run
    from twin.bounded_input import bytes_of

    run(
        log,
        columns=columns,
        pole_pairs=pole_pairs,
        json=json,
        force=force,
        max_bytes=bytes_of(max_size),
        fail_on=fail_on or (),
        command=command_line(context),
    )
