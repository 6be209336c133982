"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Seed = Annotated[int, typer.Option(min=0, help="Seed of everything random; the same seed gives the same bytes.")]
EffectFiles = Annotated[
    list[Path] | None, typer.Option("--effects", help="Python file with effects of your own; may be repeated.")
]

# What is run: the motion of the shaft.
Turns = Annotated[int, typer.Option(help="Turns in each direction.")]
Points = Annotated[int, typer.Option(help="Readings a turn.")]
BothDirections = Annotated[bool, typer.Option("--both-directions", help="And back over the same angles.")]
SpeedRpm = Annotated[list[float] | None, typer.Option(help="Speed; may be repeated. 0: stop and measure.")]
Temperatures = Annotated[str, typer.Option(help="Temperatures in C, e.g. 25,60,85.")]

# What is written.
Json = Annotated[Path | None, typer.Option(help="Write the answer as JSON.")]
Force = Annotated[bool, typer.Option("--force", help="Replace files that are there, whoever wrote them.")]
ErrorPlot = Annotated[Path | None, typer.Option(help="Draw the error before and after: .png, .svg or .pdf.")]
SweepFile = Annotated[Path, typer.Option("-o", "--output", help="Sweep to write: CSV or .csv.gz.")]
PictureFolder = Annotated[Path, typer.Option("-o", "--output", help="Folder for the picture and its data.")]
StudyFolder = Annotated[Path, typer.Option("-o", "--output", help="Folder of the study; run again to go on.")]

# Where a study runs.
Workers = Annotated[int | None, typer.Option(help="Worker processes; without it one for each core.")]
Scheduler = Annotated[
    str | None, typer.Option(help="Hand the work to a Dask cluster: its address, or 'local' to start one.")
]
