"""Commands that run studies at scale: training sweeps, the choice of a magnet, what comes back of known causes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import (
    BothDirections,
    Force,
    Points,
    Scheduler,
    Seed,
    SpeedRpm,
    StudyFolder,
    Temperatures,
    Turns,
    Workers,
)


def generate(
    output: StudyFolder,
    sweeps: Annotated[int, typer.Option("-n", "--sweeps", help="How many sweeps.")] = 10_000,
    twin: Annotated[str, typer.Option(help="Twin TOML or preset that sweeps are drawn around.")] = "paper-encoder",
    cause: Annotated[list[str] | None, typer.Option(help="Draw only this cause; may be repeated.")] = None,
    most_causes: Annotated[int, typer.Option(help="Most causes in a sweep; none is as likely as any number.")] = 3,
    strength: Annotated[str, typer.Option(help="Strengths in deg, log-uniform.")] = "0.02:0.3",
    noise: Annotated[str, typer.Option(help="RMS noise in deg, log-uniform.")] = "0.003:0.05",
    turns: Turns = 1,
    points: Points = 360,
    both_directions: BothDirections = False,
    speed_rpm: SpeedRpm = None,
    temperatures: Temperatures = "",
    channels: Annotated[bool, typer.Option("--channels", help="Store the two channels as well.")] = False,
    chunk: Annotated[int, typer.Option(help="Sweeps a chunk.")] = 1000,
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
    ranges = Ranges(strength_deg=interval("strength", strength), noise_deg=interval("noise", noise), most=most_causes)
    recipe = recipe_of(twin, protocol=protocol, ranges=ranges, causes=cause or (), seed=seed)
    job = Training(recipe=recipe, sweeps=sweeps, chunk=chunk, channels=channels)
    run(job, output, Machines(workers=workers, scheduler=scheduler))


def design(
    max_error: Annotated[float, typer.Option(help="Largest angle error in deg.")] = 0.5,
    tolerance: Annotated[
        str, typer.Option(help="Mounting tolerances: off_axis, tilt, magnet_off_axis, magnet_tilt, air_gap, stray.")
    ] = "off_axis=0.3mm, tilt=1deg",
    temperature: Annotated[str, typer.Option(help="Temperatures in C.")] = "-40:125",
    window: Annotated[str, typer.Option(help="Field that the sensor works in, in mT.")] = "30:90",
    twin: Annotated[str, typer.Option(help="Twin TOML or preset of the sensor, with a magnet.")] = "imc-14bit",
    shape: Annotated[str, typer.Option(help="cylinder, ring or block.")] = "cylinder",
    grade: Annotated[list[str] | None, typer.Option(help="Grade of the magnet; may be repeated.")] = None,
    diameter: Annotated[str, typer.Option(help="mm: low:high:step, or numbers with commas.")] = "3:10:0.5",
    height: Annotated[str, typer.Option(help="mm.")] = "2.5",
    remanence: Annotated[str, typer.Option(help="T, in place of the grade's; 0: the grade's.")] = "0",
    bore: Annotated[float, typer.Option(help="Inner diameter of a ring in mm.")] = 2.0,
    air_gap: Annotated[str, typer.Option(help="mm.")] = "0.5:4:0.25",
    off_axis: Annotated[str, typer.Option(help="Sensor off the shaft's axis, mm.")] = "0",
    tilt: Annotated[str, typer.Option(help="Sensor's tilt, deg.")] = "0",
    magnet_off_axis: Annotated[str, typer.Option(help="Magnet off the shaft's axis, mm.")] = "0",
    magnet_tilt: Annotated[str, typer.Option(help="Magnet's tilt, deg.")] = "0",
    stray: Annotated[str, typer.Option(help="Stray field, mT.")] = "0",
    sampling: Annotated[str, typer.Option(help="grid of all values, or lhs or sobol between them.")] = "grid",
    count: Annotated[int, typer.Option(help="Designs of lhs or sobol.")] = 256,
    mountings: Annotated[int, typer.Option(help="Mountings drawn for each design.")] = 200,
    min_yield: Annotated[float, typer.Option(help="Share of mountings that must keep error and window.")] = 0.99,
    best: Annotated[int, typer.Option(help="How many designs to list.")] = 10,
    output: StudyFolder = Path("design"),
    plot: Annotated[bool, typer.Option(help="Draw the map.")] = True,
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
        results=Results(best=best, plot=plot, force=force),
        machines=Machines(workers=workers, scheduler=scheduler),
        seed=seed,
    )


def recover(
    output: StudyFolder,
    cause: Annotated[list[str] | None, typer.Option(help="baseline, clean, or a cause; may be repeated.")] = None,
    noise: Annotated[str, typer.Option(help="RMS noise in deg.")] = "0.01,0.03,0.1",
    points: Annotated[str, typer.Option(help="Readings a turn.")] = "36,90,360",
    turns: Annotated[str, typer.Option(help="Turns in each direction.")] = "2",
    amplitude: Annotated[str, typer.Option(help="Amplitudes of the hidden cause in deg.")] = "0.05",
    fits: Annotated[int, typer.Option(help="Sweeps of a baseline cell.")] = 200,
    sweeps: Annotated[int, typer.Option(help="Sweeps of every other cell: each is a search of seconds.")] = 5,
    plot: Annotated[bool, typer.Option(help="Draw the maps.")] = True,
    force: Force = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    seed: Seed = 0,
) -> None:
    """Map how well known parameters and hidden causes come back: bias, RMS against the bound, coverage, power."""
    from scenarios.commands.intervals import values
    from scenarios.studies.machines import Machines
    from scenarios.studies.recovery.cells import Grid
    from scenarios.studies.recovery.run import run

    grid = Grid(
        causes=tuple(cause or ("baseline", "clean", "saturation", "hysteresis")),
        noises_deg=values("noise", noise),
        points=tuple(int(value) for value in values("points", points)),
        turns=tuple(int(value) for value in values("turns", turns)),
        amplitudes_deg=values("amplitude", amplitude),
        fits=fits,
        sweeps=sweeps,
        seed=seed,
    )
    run(grid, output, plot=plot, force=force, machines=Machines(workers=workers, scheduler=scheduler))
