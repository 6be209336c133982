"""The command that serves the page."""

from __future__ import annotations

from typing import Annotated

import typer

from scenarios.cli.options import running


def lab(
    sweep: Annotated[
        str | None, typer.Argument(metavar="[SWEEP]", help="Measured sweep to explain: .csv, .csv.gz or .parquet.")
    ] = None,
    twin: Annotated[
        str | None,
        typer.Option(
            metavar="TWIN",
            help="Twin to begin with, which the sweep is held against: a TOML file or a preset. Without: imc-14bit, "
            "and the sweep is explained by itself.",
        ),
    ] = None,
    port: Annotated[int, running("Port to listen at; 0: a free one.", metavar="N")] = 0,
    browser: Annotated[bool, running("Open the page in a browser.")] = True,
) -> None:
    """Open a local page on which the twin is live: drag the magnet, see field, error and yield; explain a sweep.

    It listens on this machine alone, at an address with a secret in it, until Ctrl-C.
    """
    from scenarios.lab.command import run

    run(sweep, twin=twin, port=port, browser=browser)
