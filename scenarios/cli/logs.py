"""The command on logs of any kind: into the columns of a sweep."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import Columns, Force, MaxSize, written


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
