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


def written(help_text: str, *names: str, metavar: str | None = "FILE") -> Any:
    """An option that names what is written."""
    return typer.Option(*names, metavar=metavar, help=help_text, rich_help_panel=OUTPUTS)


def running(help_text: str, *names: str, metavar: str | None = None) -> Any:
    """An option that says how the work is done and leaves the answer as it is."""
    return typer.Option(*names, metavar=metavar, help=help_text, rich_help_panel=RUNNING)


Seed = Annotated[
    int, typer.Option(min=0, metavar="N", help="Seed of everything random; the same seed gives the same bytes.")
]
EffectFiles = Annotated[
    list[Path] | None,
    typer.Option("--effects", metavar="FILE.py", help="Python file with effects of your own; may be repeated."),
]

Columns = Annotated[
    str | None,
    typer.Option(
        "--columns",
        metavar="TEXT",
        help="Which columns of a log are those of a sweep, by name or place, factor and unit, as halltwin import "
        "prints it: 'reference_deg=enc_counts*360/40000, measured_deg=angle:rad'.",
    ),
]

PolePairs = Annotated[
    int | None,
    typer.Option(
        "--pole-pairs",
        min=1,
        metavar="P",
        help="How often the field at the sensor turns in a turn of the shaft: a ring of P pole pairs, a resolver of P "
        "speeds. An angle or the channels may turn as often.",
    ),
]

# What is run: the motion of the shaft.
Turns = Annotated[int, typer.Option(metavar="N", help="Turns in each direction.")]
Points = Annotated[int, typer.Option(metavar="N", help="Readings a turn.")]
BothDirections = Annotated[bool, typer.Option("--both-directions", help="And back over the same angles.")]
SpeedRpm = Annotated[
    list[float] | None,
    typer.Option(metavar="rpm", help="Speed in rpm; may be repeated. 0, the default: stop and measure."),
]
Temperatures = Annotated[
    str, typer.Option(metavar="C,C,...", help="Temperatures in C, e.g. 25,60,85. Without: not recorded.")
]

# What is written.
Json = Annotated[Path | None, written("Write the answer as JSON.")]
ErrorPlot = Annotated[Path | None, written("Draw the error in deg before and after: .png, .svg or .pdf.")]
SweepFile = Annotated[Path, written("Sweep to write: .csv or .csv.gz.", "-o", "--output")]
PictureFolder = Annotated[Path, written("Folder for the picture and its data.", "-o", "--output", metavar="FOLDER")]
StudyFolder = Annotated[Path, written("Folder of the study; run again to go on.", "-o", "--output", metavar="FOLDER")]
Force = Annotated[bool, written("Replace files that are there, whoever wrote them.", "--force", metavar=None)]

# How it is run.
MaxSize = Annotated[
    str,
    running("Most bytes of a sweep after decompression, e.g. 500MB; more is refused.", "--max-size", metavar="SIZE"),
]
Workers = Annotated[int | None, running("Worker processes; without it one for each core.", metavar="N")]
Scheduler = Annotated[
    str | None,
    running("Hand the work to a Dask cluster: its address, or 'local' to start one.", metavar="ADDRESS"),
]
