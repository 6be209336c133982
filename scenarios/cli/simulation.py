"""Commands that simulate: a sweep of a twin, the chain in hardware units, the spinning current, the paper's figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

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
    coast: Annotated[
        bool,
        typer.Option("--coast", help="Let the shaft coast down instead, and log time_s and measured_deg alone."),
    ] = False,
    start_rpm: Annotated[
        float | None, typer.Option(metavar="rpm", help="Speed in rpm at which the shaft is let go. Without: 3000.")
    ] = None,
    stop_rpm: Annotated[
        float | None,
        typer.Option(metavar="rpm", help="Speed in rpm at which the log ends. Without: a tenth of the start speed."),
    ] = None,
    coast_time: Annotated[
        float | None, typer.Option(metavar="s", help="Time in s from one to the other. Without: 5.")
    ] = None,
    dry_share: Annotated[
        float | None,
        typer.Option(
            metavar="SHARE",
            help="Share of the friction at the start that is dry; the rest falls with the speed. Without: 0.5.",
        ),
    ] = None,
    rate: Annotated[
        float | None, typer.Option(metavar="Hz", help="Readings a second of a coast. Without: 2000.")
    ] = None,
    reference: Annotated[
        bool | None,
        typer.Option(help="Record reference_deg and turn, which take a reference. Without: yes, except of a coast."),
    ] = None,
    channels: Annotated[
        bool | None, typer.Option(help="Record vx and vy as well. Without: yes, except of a coast.")
    ] = None,
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
    noise: Annotated[
        float | None,
        typer.Option(metavar="deg", help="White noise of a reading in deg RMS, in place of the twin's."),
    ] = None,
    trace: Annotated[Path | None, written("Write every intermediate signal with its unit as CSV.")] = None,
    plot: Annotated[Path | None, written("Draw the trace: .png, .svg or .pdf.")] = None,
    force: Force = False,
    effects: EffectFiles = None,
    max_size: MaxSize = "2GB",
    seed: Seed = 0,
) -> None:
    """Simulate a sweep from a twin, on a protocol, on a recorded motion, or of a shaft that coasts down."""
    from scenarios.commands.coast import Coast, refuse_protocol, refuse_without_coast
    from scenarios.commands.protocol import Protocol, numbers
    from scenarios.commands.simulate import Instead, Outputs, run
    from twin.bounded_input import bytes_of

    coasts: dict[str, Any] = {
        "start_rpm": start_rpm,
        "stop_rpm": stop_rpm,
        "time_s": coast_time,
        "dry_share": dry_share,
        "rate_Hz": rate,
    }
    given = {name: value for name, value in coasts.items() if value is not None}
    protocol: Protocol | Coast
    if coast:
        refuse_protocol(
            {
                "--motion": motion is not None,
                "--turns": turns != 1,
                "--points": points != 360,
                "--both-directions": both_directions,
                "--speed-rpm": bool(speed_rpm),
                "--temperatures": bool(temperatures.strip()),
            }
        )
        protocol = Coast(**given, channels=bool(channels))
    else:
        refuse_without_coast(given)
        protocol = Protocol(
            turns=turns,
            points=points,
            both_directions=both_directions,
            speeds_rpm=speed_rpm or [0.0],
            temperatures_c=numbers("temperatures", temperatures),
            channels=channels is not False,
        )
    run(
        twin,
        Outputs(
            sweep=output, trace=trace, plot=plot, reference=not coast if reference is None else reference, force=force
        ),
        recorded=motion,
        max_bytes=bytes_of(max_size),
        protocol=protocol,
        seed=seed,
        instead=Instead(reference_lines=reference_lines, air_gap_mm=air_gap, mounting_deg=mounting, noise_deg=noise),
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
