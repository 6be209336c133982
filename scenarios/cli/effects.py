"""Commands on the catalogue of effects and on effects of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import EffectFiles, Force, written


def causes(
    markdown: Annotated[bool, typer.Option("--markdown", help="Print the tables of the guide, as Markdown.")] = False,
    effects: EffectFiles = None,
) -> None:
    """List the causes that the twin can simulate and the search can name."""
    from scenarios.commands.causes import run

    run(markdown=markdown, effect_files=effects or ())


def new_effect(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the effect, e.g. gear_mesh.")],
    output: Annotated[
        Path | None, written("Python file to write; without it NAME.py.", "-o", "--output", metavar="FILE.py")
    ] = None,
    answer: Annotated[
        Path | None,
        typer.Option(
            "--from", metavar="ANSWER", help="Answer of explain (--json) whose unnamed structure it is shaped after."
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Write the skeleton of an effect of your own: a file that passes the contract, to write your physics into."""
    from scenarios.commands.new_effect import run

    run(name, output=output, answer=answer, force=force)


def check_effect(
    file: Annotated[Path, typer.Argument(metavar="FILE.py", help="Python file that declares effects.")],
) -> None:
    """Check what an effect of your own promises: null, shapes, batches, seeds, documentation."""
    from scenarios.commands.new_effect import check_run

    check_run(file)
