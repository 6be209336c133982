"""The command of the bench on a CAN bus."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import (
    BothDirections,
    EffectFiles,
    Force,
    Points,
    Seed,
    SpeedRpm,
    SweepFile,
    Temperatures,
    Turns,
    fail_on_option,
    running,
    written,
)
from scenarios.cli.reproduce import command_line


def bench(
    context: typer.Context,
    output: SweepFile = Path("bench.csv"),
    closed_loop: Annotated[
        bool,
        typer.Option(
            "--closed-loop", help="Measure, explain, compensate, measure again; files are named after the sweep."
        ),
    ] = False,
    plot: Annotated[Path | None, written("Draw the closed loop: .png, .svg or .pdf.")] = None,
    twin: Annotated[
        str | None,
        typer.Option(
            metavar="TWIN", help="Encoder on the virtual bench: twin TOML or preset; without it paper-encoder."
        ),
    ] = None,
    hide: Annotated[
        list[str] | None,
        typer.Option(
            metavar="EFFECT",
            help="Effect to hide in it, EFFECT:PARAMETER=VALUE[,...], e.g. saturation:k_percent=2; may be repeated.",
        ),
    ] = None,
    points: Points = 360,
    turns: Turns = 1,
    both_directions: BothDirections = False,
    speed_rpm: SpeedRpm = None,
    temperatures: Temperatures = "",
    spin: Annotated[
        str | None,
        typer.Option(
            metavar="HOW",
            help="No reference on the bus: log time_s and the Hall encoder alone, of a shaft that coasts from "
            "--speed-rpm (coast) or turns evenly at it (steady).",
        ),
    ] = None,
    spin_time: Annotated[
        float | None, typer.Option(metavar="s", help="Time in s at each speed of a spin. Without: 8.")
    ] = None,
    rate: Annotated[
        float | None, typer.Option(metavar="Hz", help="Readings a second of a spin. Without: 1000.")
    ] = None,
    settle: Annotated[float, typer.Option(metavar="s", help="Time in s from the last step to a reading.")] = 0.3,
    channels: Annotated[bool, typer.Option(help="The encoder sends vx and vy as well.")] = True,
    chamber: Annotated[bool, typer.Option(help="A climate chamber on the bus tells the temperature.")] = True,
    interface: Annotated[str, typer.Option(metavar="NAME", help="Interface of python-can.")] = "virtual",
    channel: Annotated[str | None, typer.Option(metavar="NAME", help="Its channel, e.g. can0.")] = None,
    bus_option: Annotated[
        list[str] | None, typer.Option(metavar="KEY=VALUE", help="Further option of the interface; may be repeated.")
    ] = None,
    serve: Annotated[
        float | None,
        typer.Option(metavar="s", help="Be the virtual bench for other processes for so many s; 0: until Ctrl-C."),
    ] = None,
    record: Annotated[Path | None, written("Record the bus: .asc, .blf, .csv, .db, .log or .trc.")] = None,
    replay: Annotated[
        Path | None, typer.Option(metavar="LOG", help="Make the sweep from such a log instead of measuring.")
    ] = None,
    restart: Annotated[bool, running("Begin anew, do not go on with a broken run.", "--restart")] = False,
    force: Force = False,
    timeout: Annotated[float, typer.Option(metavar="s", help="Time in s to wait for an answer.")] = 0.2,
    attempts: Annotated[int, typer.Option(metavar="N", help="How often to ask a silent node.")] = 15,
    manifest: Annotated[
        float, typer.Option(metavar="deg", help="Reject readings this far off the typical error, in deg.")
    ] = 20.0,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FAULT",
            help="Fault on the bus, KIND[:NODE][=VALUE], e.g. lost=0.02, silent:hall; may be repeated.",
        ),
    ] = None,
    real_time: Annotated[bool, running("Motions take the time they would take.", "--real-time")] = False,
    effects: EffectFiles = None,
    seed: Seed = 0,
    fail_on: Annotated[
        list[str] | None, fail_on_option("missed (the closed loop did not reach its aim of 0.2 deg)")
    ] = None,
) -> None:
    """Measure on a bench over CAN, virtual by default: stepper, reference encoder, Hall encoder, climate chamber."""
    from scenarios.bench.command import Options, run

    run(
        Options(
            output=output,
            twin=twin,
            hide=hide or (),
            points=points,
            turns=turns,
            both_directions=both_directions,
            speeds_rpm=speed_rpm or (0.0,),
            temperatures=temperatures,
            settle_s=settle,
            spin=spin,
            spin_time_s=spin_time,
            rate_Hz=rate,
            channels=channels,
            chamber=chamber,
            closed_loop=closed_loop,
            plot=plot,
            record=record,
            replay=replay,
            restart=restart,
            force=force,
            serve=serve,
            interface=interface,
            channel=channel,
            bus_options=bus_option or (),
            faults=fault or (),
            timeout_s=timeout,
            attempts=attempts,
            manifest_deg=manifest,
            real_time=real_time,
            effect_files=effects or (),
            seed=seed,
            fail_on=fail_on or (),
            command=command_line(context),
        )
    )
