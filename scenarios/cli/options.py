"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

OUTPUTS = "What is written"
RUNNING = "How it is run"
"""Groups of options in the help text: those in neither decide what the answer is."""


def fail_on_option(words: str) -> Any:
    """``--fail-on`` with the words that a command knows."""
    return typer.Option(
        "--fail-on",
        metavar="WHAT",
        help=f"End with exit code 1 where this is found: {words}; may be repeated.",
        rich_help_panel=RUNNING,
    )


Seed = Annotated[
    int, typer.Option(min=0, metavar="N", help="Seed of everything random; the same seed gives the same bytes.")
]
EffectFiles = Annotated[
    list[Path] | None,
    typer.Option("--effects", metavar="FILE.py", help="Python file with effects of your own; may be repeated."),
]

# What is run: the motion of the shaft.
Turns = Annotated[int, typer.Option(metavar="N", help="Turns in each direction.")]
Points = Annotated[int, typer.Option(metavar="N", help="Readings a turn.")]
BothDirections = Annotated[bool, typer.Option("--both-directions", help="And back over the same angles.")]
SpeedRpm = Annotated[
    list[float] | None,
    typer.Option(metavar="RPM", help="Speed in rpm; may be repeated. 0, the default: stop and measure."),
]
Temperatures = Annotated[
    str, typer.Option(metavar="C,C,...", help="Temperatures in C, e.g. 25,60,85. Without: not recorded.")
]

# What is written.
Json = Annotated[Path | None, typer.Option(metavar="FILE", help="Write the answer as JSON.", rich_help_panel=OUTPUTS)]
ErrorPlot = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", help="Draw the error in deg before and after: .png, .svg or .pdf.", rich_help_panel=OUTPUTS
    ),
]
SweepFile = Annotated[
    Path,
    typer.Option("-o", "--output", metavar="FILE", help="Sweep to write: .csv or .csv.gz.", rich_help_panel=OUTPUTS),
]
PictureFolder = Annotated[
    Path,
    typer.Option(
        "-o", "--output", metavar="FOLDER", help="Folder for the picture and its data.", rich_help_panel=OUTPUTS
    ),
]
StudyFolder = Annotated[
    Path,
    typer.Option(
        "-o", "--output", metavar="FOLDER", help="Folder of the study; run again to go on.", rich_help_panel=OUTPUTS
    ),
]

Force = Annotated[
    bool,
    typer.Option("--force", help="Replace files that are there, whoever wrote them.", rich_help_panel=OUTPUTS),
]

# How it is run.
Workers = Annotated[
    int | None,
    typer.Option(metavar="N", help="Worker processes; without it one for each core.", rich_help_panel=RUNNING),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="ADDRESS",
        help="Hand the work to a Dask cluster: its address, or 'local' to start one.",
        rich_help_panel=RUNNING,
    ),
]
