"""Options that several commands share."""

from __future__ import annotations

from typing import Annotated

import typer

Seed = Annotated[int, typer.Option(min=0, help="Seed of everything random; the same seed gives the same bytes.")]
Turns = Annotated[int, typer.Option(help="Turns in each direction.")]
Points = Annotated[int, typer.Option(help="Readings a turn.")]
BothDirections = Annotated[bool, typer.Option("--both-directions", help="And back over the same angles.")]
SpeedRpm = Annotated[list[float] | None, typer.Option(help="Speed; may be repeated. 0: stop and measure.")]
Temperatures = Annotated[str, typer.Option(help="Temperatures in C, e.g. 25,60,85.")]
