"""The command that serves the page."""

from __future__ import annotations

from typing import Annotated

import typer

from scenarios.cli.options import running


def lab(
    twin: Annotated[
        str | None,
        typer.Option(metavar="TWIN", help="Twin to begin with: a TOML file or a preset; without it imc-14bit."),
    ] = None,
    port: Annotated[int, running("Port to listen at; 0: a free one.", metavar="N")] = 0,
    browser: Annotated[bool, running("Open the page in a browser.")] = True,
) -> None:
    """Open a local page on which the twin is live: drag the magnet, and see field, error and yield follow.

    It listens on this machine alone, at an address with a secret in it, until Ctrl-C.
    """
    from scenarios.lab.command import run

    run(twin=twin, port=port, browser=browser)
