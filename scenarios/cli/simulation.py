"""Commands that simulate: a sweep of a twin, the chain in hardware units, the spinning current, the paper's figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import (
    BothDirections,
    EffectFiles,
    Force,
    MaxSize,
    PictureFolder,
    Points,
    Seed,
    SpeedRpm,
    SweepFile,
    Temperatures,
    Turns,
    written,
)


def simulate(
    twin: Annotated[str, typer.Argument(metavar="TWIN", help="Twin TOML or preset.")] = "imc-14bit",
    output: SweepFile = Path("sweep.csv"),
    motion: Annotated[
        Path | None,
        typer.Option(metavar="SWEEP", help="Simulate on the motion of this recorded sweep, in place of the protocol."),
    ] = None,
    turns: Turns = 1,
    points: Points = 360,
    both_directions: BothDirections = False,
    speed_rpm: SpeedRpm = None,
    temperatures: Temperatures = "",
    channels: Annotated[bool, typer.Option(help="Record vx and vy as well.")] = True,
    reference_lines: Annotated[
        int | None,
        typer.Option(metavar="N", help="Lines of the reference encoder (4 counts each). Without: as the twin says."),
    ] = None,
    air_gap: Annotated[
        float | None,
        typer.Option(
            metavar="mm",
            help="Air gap in mm, in place of the twin's: what is constant in volts is then another share of the field.",
        ),
    ] = None,
    mounting: Annotated[
        float | None,
        typer.Option(
            metavar="deg",
            help="Turn of the sensor about the shaft in deg: its errors turn with it, the reference's do not.",
        ),
    ] = None,
    trace: Annotated[Path | None, written("Write every intermediate signal with its unit as CSV.")] = None,
    plot: Annotated[Path | None, written("Draw the trace: .png, .svg or .pdf.")] = None,
    force: Force = False,
    effects: EffectFiles = None,
    max_size: MaxSize = "2GB",
    seed: Seed = 0,
) -> None:
    """Simulate a sweep from a twin, on a protocol or on a recorded motion."""
    from scenarios.commands.protocol import Protocol, numbers
    from scenarios.commands.simulate import Instead, Outputs, run
    from twin.bounded_input import bytes_of

    protocol = Protocol(
        turns=turns,
        points=points,
        both_directions=both_directions,
        speeds_rpm=speed_rpm or [0.0],
        temperatures_c=numbers("temperatures", temperatures),
        channels=channels,
    )
    run(
        twin,
        Outputs(sweep=output, trace=trace, plot=plot, force=force),
        recorded=motion,
        max_bytes=bytes_of(max_size),
        protocol=protocol,
        seed=seed,
        instead=Instead(reference_lines=reference_lines, air_gap_mm=air_gap, mounting_deg=mounting),
        effect_files=effects or (),
    )


def hardware(
    output: PictureFolder,
    twin: Annotated[
        str, typer.Argument(metavar="TWIN", help="Twin TOML or preset, for its magnet, disk and plates.")
    ] = "imc-14bit",
    force: Force = False,
    effects: EffectFiles = None,
    seed: Seed = 0,
) -> None:
    """Run one turn through magnet, concentrator, spun plates, converter, CORDIC and link, in the hardware's units."""
    from scenarios.commands.hardware import run_command

    run_command(twin, output, effect_files=effects or (), force=force, seed=seed)


def spinning(
    output: PictureFolder,
    force: Force = False,
    seed: Seed = 0,
) -> None:
    """Show the spinning current phase by phase: the offset before and after, the noise with its 1/f corner moved."""
    from scenarios.commands.spinning import run

    run(output, force=force, seed=seed)


def paper(
    output: Annotated[Path, written("Folder for tables and figures.", "-o", "--output", metavar="FOLDER")],
    cases: Annotated[
        int, typer.Option(metavar="N", help="Random cases that the swarm is tried on; the paper has 100.")
    ] = 100,
    force: Force = False,
    seed: Seed = 0,
) -> None:
    """Reproduce the paper: Tables 1 and 2, Figures 3 to 9, 13, 14, 16, its search and discard rule; held against it."""
    from scenarios.commands.paper.run import run

    run(output, cases=cases, seed=seed, force=force)
