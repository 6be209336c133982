"""Commands at scale: training sweeps, the choice of a magnet, what comes back of known causes, whole batches."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import (
    BothDirections,
    Columns,
    Force,
    Json,
    MaxSize,
    Points,
    PolePairs,
    Scheduler,
    Seed,
    SpeedRpm,
    StudyFolder,
    Temperatures,
    Turns,
    Workers,
    fail_on_option,
    written,
)
from scenarios.cli.reproduce import command_line


def generate(
    output: StudyFolder,
    sweeps: Annotated[int, typer.Option("-n", "--sweeps", metavar="N", help="How many sweeps.")] = 10_000,
    twin: Annotated[
        str, typer.Option(metavar="TWIN", help="Twin TOML or preset that sweeps are drawn around.")
    ] = "paper-encoder",
    cause: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Draw only this cause; may be repeated.")
    ] = None,
    most_causes: Annotated[
        int, typer.Option(metavar="N", help="Most causes in a sweep; none is as likely as any number.")
    ] = 3,
    strength: Annotated[
        str, typer.Option(metavar="deg:deg", help="Strengths in deg, low:high, log-uniform.")
    ] = "0.02:0.3",
    noise: Annotated[
        str, typer.Option(metavar="deg:deg", help="RMS noise in deg, low:high, log-uniform.")
    ] = "0.003:0.05",
    turns: Turns = 1,
    points: Points = 360,
    both_directions: BothDirections = False,
    speed_rpm: SpeedRpm = None,
    temperatures: Temperatures = "",
    channels: Annotated[bool, typer.Option("--channels", help="Store the two channels as well.")] = False,
    chunk: Annotated[int, typer.Option(metavar="N", help="Sweeps that are computed and stored at a time.")] = 1000,
    workers: Workers = None,
    scheduler: Scheduler = None,
    seed: Seed = 0,
) -> None:
    """Write labelled training sweeps of a twin: error curves, causes, strengths and parameters, as a Zarr store."""
    from scenarios.commands.intervals import interval
    from scenarios.commands.protocol import Protocol, numbers
    from scenarios.studies.machines import Machines
    from scenarios.studies.training.draw import Ranges
    from scenarios.studies.training.job import Training
    from scenarios.studies.training.recipe import recipe_of
    from scenarios.studies.training.run import run

    protocol = Protocol(
        turns=turns,
        points=points,
        both_directions=both_directions,
        speeds_rpm=speed_rpm or [0.0],
        temperatures_c=numbers("temperatures", temperatures),
    )
    ranges = Ranges(
        strength_deg=interval("strength", strength, example="0.02:0.3"),
        noise_deg=interval("noise", noise, example="0.003:0.05"),
        most=most_causes,
    )
    recipe = recipe_of(twin, protocol=protocol, ranges=ranges, causes=cause or (), seed=seed)
    job = Training(recipe=recipe, sweeps=sweeps, chunk=chunk, channels=channels)
    run(job, output, Machines(workers=workers, scheduler=scheduler))


def design(
    context: typer.Context,
    max_error: Annotated[float, typer.Option(metavar="deg", help="Largest angle error in deg.")] = 0.5,
    tolerance: Annotated[
        str,
        typer.Option(
            metavar="LIST",
            help="Mounting tolerances, NAME=VALUE with commas: off_axis, magnet_off_axis, air_gap in mm, tilt, "
            "magnet_tilt in deg, stray in mT.",
        ),
    ] = "off_axis=0.3mm, tilt=1deg",
    temperature: Annotated[str, typer.Option(metavar="C:C", help="Temperatures in C, low:high.")] = "-40:125",
    window: Annotated[
        str, typer.Option(metavar="mT:mT", help="Field that the sensor works in, in mT, low:high.")
    ] = "30:90",
    twin: Annotated[
        str, typer.Option(metavar="TWIN", help="Twin TOML or preset of the sensor, with a magnet.")
    ] = "imc-14bit",
    shape: Annotated[
        str, typer.Option(metavar="SHAPE", help="Shape of the magnet: cylinder, ring or block.")
    ] = "cylinder",
    grade: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Grade of the magnet; may be repeated. Without: N35H.")
    ] = None,
    diameter: Annotated[
        str, typer.Option(metavar="mm", help="Diameter in mm: low:high:step, or numbers with commas.")
    ] = "3:10:0.5",
    height: Annotated[str, typer.Option(metavar="mm", help="Height in mm, likewise.")] = "2.5",
    remanence: Annotated[str, typer.Option(metavar="T", help="Remanence in T, likewise; 0: the grade's.")] = "0",
    bore: Annotated[float, typer.Option(metavar="mm", help="Inner diameter of a ring in mm.")] = 2.0,
    air_gap: Annotated[str, typer.Option(metavar="mm", help="Air gap in mm, likewise.")] = "0.5:4:0.25",
    off_axis: Annotated[str, typer.Option(metavar="mm", help="Sensor off the shaft's axis in mm, likewise.")] = "0",
    tilt: Annotated[str, typer.Option(metavar="deg", help="Sensor's tilt in deg, likewise.")] = "0",
    magnet_off_axis: Annotated[
        str, typer.Option(metavar="mm", help="Magnet off the shaft's axis in mm, likewise.")
    ] = "0",
    magnet_tilt: Annotated[str, typer.Option(metavar="deg", help="Magnet's tilt in deg, likewise.")] = "0",
    stray: Annotated[str, typer.Option(metavar="mT", help="Stray field in mT, likewise.")] = "0",
    sampling: Annotated[
        str, typer.Option(metavar="WORD", help="Designs: grid of all values, or lhs or sobol between them.")
    ] = "grid",
    count: Annotated[int, typer.Option(metavar="N", help="Designs of lhs or sobol.")] = 256,
    mountings: Annotated[int, typer.Option(metavar="N", help="Mountings drawn for each design.")] = 200,
    min_yield: Annotated[
        float, typer.Option(metavar="SHARE", help="Share of mountings, 0 to 1, that must keep error and window.")
    ] = 0.99,
    best: Annotated[int, typer.Option(metavar="N", help="How many designs to list.")] = 10,
    output: StudyFolder = Path("design"),
    plot: Annotated[bool, written("Draw the map.", metavar=None)] = True,
    force: Force = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    seed: Seed = 0,
) -> None:
    """Find magnets and distances that keep an error over temperature and mounting tolerances, and map them."""
    from scenarios.studies.design.options import demand_of, space_of
    from scenarios.studies.design.run import Results, run
    from scenarios.studies.machines import Machines

    axes = {
        "diameter_mm": diameter,
        "height_mm": height,
        "remanence_T": remanence,
        "air_gap_mm": air_gap,
        "off_axis_mm": off_axis,
        "tilt_deg": tilt,
        "magnet_off_axis_mm": magnet_off_axis,
        "magnet_tilt_deg": magnet_tilt,
        "stray_mT": stray,
    }
    run(
        twin,
        output,
        space=space_of(
            axes,
            shape=shape,
            grades=tuple(grade or ("N35H",)),
            bore_mm=bore,
            sampling=sampling,
            count=count,
            seed=seed,
        ),
        demand=demand_of(
            max_error_deg=max_error,
            window=window,
            temperature=temperature,
            tolerance=tolerance,
            mountings=mountings,
            min_yield=min_yield,
        ),
        results=Results(best=best, plot=plot, force=force, command=command_line(context)),
        machines=Machines(workers=workers, scheduler=scheduler),
        seed=seed,
    )


def recover(
    context: typer.Context,
    output: StudyFolder,
    cause: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="baseline, clean, or a cause; may be repeated.")
    ] = None,
    noise: Annotated[str, typer.Option(metavar="deg,deg,...", help="RMS noise in deg.")] = "0.01,0.03,0.1",
    points: Annotated[str, typer.Option(metavar="N,N,...", help="Readings a turn.")] = "36,90,360",
    turns: Annotated[str, typer.Option(metavar="N,N,...", help="Turns in each direction.")] = "2",
    amplitude: Annotated[
        str, typer.Option(metavar="deg,deg,...", help="Amplitudes of the hidden cause in deg.")
    ] = "0.05",
    fits: Annotated[int, typer.Option(metavar="N", help="Sweeps of a baseline cell.")] = 200,
    sweeps: Annotated[
        int, typer.Option(metavar="N", help="Sweeps of every other cell: each is a search of seconds.")
    ] = 5,
    plot: Annotated[bool, written("Draw the maps.", metavar=None)] = True,
    force: Force = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    seed: Seed = 0,
) -> None:
    """Map how well known parameters and hidden causes come back: bias, RMS against the bound, coverage, power."""
    from scenarios.commands.intervals import values, whole_values
    from scenarios.studies.machines import Machines
    from scenarios.studies.recovery.cells import Grid
    from scenarios.studies.recovery.run import run

    grid = Grid(
        causes=tuple(cause or ("baseline", "clean", "saturation", "hysteresis")),
        noises_deg=values("noise", noise),
        points=whole_values("points", points),
        turns=whole_values("turns", turns),
        amplitudes_deg=values("amplitude", amplitude),
        fits=fits,
        sweeps=sweeps,
        seed=seed,
    )
    run(
        grid,
        output,
        plot=plot,
        force=force,
        machines=Machines(workers=workers, scheduler=scheduler),
        command=command_line(context),
    )


def fleet(
    context: typer.Context,
    devices: Annotated[
        list[str],
        typer.Argument(metavar="DEVICES...", help="Sweeps, one file a device: files, globs or folders."),
    ],
    output: StudyFolder = Path("fleet"),
    json: Json = None,
    report: Annotated[Path | None, written("Write one HTML page of all devices.")] = None,
    table: Annotated[
        Path | None, written("Write the figures of every device as Parquet: .parquet; needs the extra formats.")
    ] = None,
    explained: Annotated[
        str,
        typer.Option(
            "--explain", metavar="apart|all|none", help="Devices that are explained in full: those that stand apart."
        ),
    ] = "apart",
    order: Annotated[
        str,
        typer.Option(
            metavar="name|given|COLUMN",
            help="Order of production: numbers in the names, as given, or the first value of a column.",
        ),
    ] = "name",
    output_sense: Annotated[
        int | None,
        typer.Option(metavar="1|-1", help="Which way the outputs count: 1 where they are atan2(y, x). Without: told."),
    ] = None,
    force: Force = False,
    columns: Columns = None,
    pole_pairs: PolePairs = None,
    max_size: MaxSize = "2GB",
    workers: Workers = None,
    scheduler: Scheduler = None,
    seed: Seed = 0,
    fail_on: Annotated[list[str] | None, fail_on_option("apart, change, cause, or the NAME of a cause")] = None,
) -> None:
    """Ask many devices at once: what they share and how they scatter, which stand apart, and since when."""
    from scenarios.commands.inputs import SweepFiles
    from scenarios.studies.fleet.run import Asked, Outputs, run
    from scenarios.studies.machines import Machines
    from twin.bounded_input import bytes_of

    run(
        SweepFiles(devices, bytes_of(max_size), columns, pole_pairs),
        output,
        what=Asked(order=order, explained=explained, output_sense=output_sense, seed=seed),
        outputs=Outputs(json=json, report=report, table=table, force=force),
        machines=Machines(workers=workers, scheduler=scheduler),
        fail_on=fail_on or (),
        command=command_line(context),
    )
