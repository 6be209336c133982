"""The command that shows the guide."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import Force, written


def guide(
    page: Annotated[str | None, typer.Argument(metavar="[PAGE]", help="Page to print. Without: the index.")] = None,
    output: Annotated[
        Path | None,
        written("Write all pages as HTML into this folder, with pictures.", "-o", "--output", metavar="FOLDER"),
    ] = None,
    force: Force = False,
) -> None:
    """Print a page of the guide, or write all of it as HTML, with the Python reference and each cause's footprint."""
    from scenarios.commands.guide.run import run

    run(page, folder=output, force=force)
