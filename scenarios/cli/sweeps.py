"""Commands on measured sweeps: what the simulation gets wrong, the error factors, their drift, a correction."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import (
    Columns,
    EffectFiles,
    ErrorPlot,
    Force,
    Json,
    MaxSize,
    PolePairs,
    Seed,
    fail_on_option,
    written,
)
from scenarios.cli.reproduce import command_line

MagnetText = Annotated[
    str | None,
    typer.Option(
        "--magnet",
        metavar="NAME=VALUE,...",
        help="The magnet for which mm and mT are counted, as in the table magnet of a twin, e.g. "
        "diameter_mm=6,height_mm=2.5,grade=N35H.",
    ),
]


def explain(
    context: typer.Context,
    sweeps: Annotated[
        list[str],
        typer.Argument(
            metavar="SWEEP...",
            help="Measured sweep: .csv, .csv.gz or .parquet. Several, globs or folders: recordings of one device, "
            "explained together.",
        ),
    ],
    each: Annotated[bool, typer.Option("--each", help="Explain several sweeps one by one instead.")] = False,
    twin: Annotated[
        str | None,
        typer.Option(
            metavar="TWIN", help="Ask what has changed since this twin of the device: a TOML file or a preset."
        ),
    ] = None,
    magnet: MagnetText = None,
    air_gap: Annotated[
        str | None, typer.Option(metavar="mm,...", help="Air gap in mm; of several recordings one for each.")
    ] = None,
    mounting: Annotated[
        str | None,
        typer.Option(
            metavar="deg,...", help="By how much the sensor was turned about the shaft, in deg: one for each recording."
        ),
    ] = None,
    pole_pairs: PolePairs = None,
    json: Json = None,
    report: Annotated[
        Path | None,
        written("Write a self-contained HTML report."),
    ] = None,
    extended: Annotated[Path | None, written("Write the extended twin (TOML).")] = None,
    plot: ErrorPlot = None,
    force: Force = False,
    effects: EffectFiles = None,
    columns: Columns = None,
    max_size: MaxSize = "2GB",
    budget: Annotated[
        float,
        typer.Option(
            metavar="SECONDS",
            help="End the search after so much computing, in s for each recording, and answer with what it holds; inf: "
            "search to its end.",
        ),
    ] = 120.0,
    seed: Seed = 0,
    fail_on: Annotated[
        list[str] | None,
        fail_on_option(
            "cause, the NAME of one, unexplained, changed or other-device (--twin), rejected (rows), fault or note "
            "(of the set-up), or the KIND of one such as pole_pairs"
        ),
    ] = None,
) -> None:
    """Say what the simulation gets wrong about a measured sweep, name the cause, extend the twin, measure the gain."""
    from scenarios.commands.explain import Outputs, Search, run
    from scenarios.commands.inputs import SweepFiles
    from scenarios.commands.known import Known
    from twin.bounded_input import bytes_of

    run(
        SweepFiles(sweeps, bytes_of(max_size), columns, pole_pairs),
        each=each,
        known=Known(twin=twin, magnet=magnet, air_gap=air_gap, turned=mounting),
        outputs=Outputs(json=json, report=report, extended=extended, plot=plot, force=force),
        search=Search(effect_files=effects or (), budget_s=budget, seed=seed),
        fail_on=fail_on or (),
        command=command_line(context),
    )


def diagnose(
    context: typer.Context,
    sweeps: Annotated[list[str], typer.Argument(metavar="SWEEPS...", help="Sweep files, globs or folders.")],
    json: Json = None,
    plot: Annotated[
        Path | None,
        written("Draw points and fitted curve, error in deg: .png, .svg or .pdf."),
    ] = None,
    convergence: Annotated[
        Path | None,
        written("Draw the swarm's convergence: .png, .svg or .pdf."),
    ] = None,
    band: Annotated[
        str | None,
        typer.Option(
            metavar="deg|TWIN",
            help="Discard particles that leave this band (Eq. 11): Delta E in deg, or a twin or preset that it is "
            "computed from (Eq. 7).",
        ),
    ] = None,
    swarm: Annotated[
        bool,
        typer.Option(
            "--swarm", help="Search by the paper's particle swarm, also where descents from several starts agree."
        ),
    ] = False,
    twin: Annotated[
        str | None,
        typer.Option(
            metavar="TWIN", help="Twin TOML or preset: its magnet, its air gap and which way its output counts."
        ),
    ] = None,
    output_sense: Annotated[
        int | None,
        typer.Option(
            metavar="+1|-1", help="Which way the output counts: +1 where it is atan2(y, x) of the channels, -1 against."
        ),
    ] = None,
    magnet: MagnetText = None,
    air_gap: Annotated[
        str | None,
        typer.Option(metavar="mm,mm,...", help="Air gap in mm of each sweep in order, or of the first one."),
    ] = None,
    air_gap_error: Annotated[
        float | None, typer.Option(metavar="mm", help="Standard uncertainty of an air gap in mm. Without: 0.05.")
    ] = None,
    force: Force = False,
    columns: Columns = None,
    max_size: MaxSize = "2GB",
    seed: Seed = 0,
    fail_on: Annotated[
        list[str] | None, fail_on_option("undetermined (factors), gross-errors, or rejected (rows)")
    ] = None,
) -> None:
    """Quantify the paper's error factors of one or many sweeps: values, intervals, what cannot be known."""
    from scenarios.commands.diagnose import Outputs, run
    from scenarios.commands.inputs import SweepFiles
    from scenarios.commands.known import Known
    from twin.bounded_input import bytes_of

    run(
        SweepFiles(sweeps, bytes_of(max_size), columns),
        outputs=Outputs(json=json, plot=plot, convergence=convergence, force=force),
        seed=seed,
        band=band,
        swarm=swarm,
        known=Known(
            twin=twin, output_sense=output_sense, magnet=magnet, air_gap=air_gap, air_gap_error_mm=air_gap_error
        ),
        fail_on=fail_on or (),
        command=command_line(context),
    )


def compensate(
    sources: Annotated[
        list[str],
        typer.Argument(
            metavar="SOURCES...",
            help="Measured sweep, or sweeps of one sensor at several temperatures; or a twin TOML or preset.",
        ),
    ],
    header: Annotated[
        Path | None,
        written("Write a C header with fixed-point code.", metavar="FILE.h"),
    ] = None,
    table: Annotated[Path | None, written("Write a table in deg as CSV.")] = None,
    points: Annotated[int, written("Rows of the table.", metavar="N")] = 64,
    toml: Annotated[Path | None, written("Write the coefficients as TOML.")] = None,
    plot: ErrorPlot = None,
    check: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SWEEPS",
            help="Sweep, glob or folder to test the correction on; may be repeated. Exit code 1 where it makes the "
            "error larger.",
        ),
    ] = None,
    temperature: Annotated[
        str | None,
        typer.Option(
            metavar="C|C:C",
            help="Temperature in C that a twin is corrected for, or low:high of a span of them. Without: 25.",
        ),
    ] = None,
    tolerance: Annotated[float, typer.Option(metavar="deg", help="Largest error in deg from orders left out.")] = 1e-3,
    prefix: Annotated[str, written("Prefix of the C names.", metavar="NAME")] = "halltwin",
    force: Force = False,
    effects: EffectFiles = None,
    columns: Columns = None,
    max_size: MaxSize = "2GB",
    seed: Seed = 0,
    fail_on: Annotated[
        list[str] | None, fail_on_option("worse (the error is larger with the correction, on held-out readings too)")
    ] = None,
) -> None:
    """Turn sweeps or a twin into a continuous correction, and measure it on readings it never saw.

    Over several temperatures each factor is told sensitive or immune, and the correction follows the sensitive ones.
    """
    from scenarios.commands.compensate import Outputs, run
    from scenarios.commands.inputs import SweepFiles
    from twin.bounded_input import bytes_of

    outputs = Outputs(header=header, table=table, points=points, toml=toml, plot=plot, prefix=prefix, force=force)
    run(
        sources,
        outputs=outputs,
        check=SweepFiles(check or (), bytes_of(max_size), columns),
        temperature=temperature,
        tolerance_deg=tolerance,
        effect_files=effects or (),
        seed=seed,
        fail_on=fail_on or (),
    )


def export(
    context: typer.Context,
    sources: Annotated[
        list[str],
        typer.Argument(
            metavar="SOURCES...",
            help="Twin TOML, such as explain --extended writes, or preset; or measured sweep, or sweeps of one sensor "
            "at several temperatures.",
        ),
    ],
    target: Annotated[
        str,
        typer.Option(
            "--for",
            metavar="TARGET[:N]",
            help="What loads it, and of how many entries: simplefoc (N, without: 200), moteus (256, or 32 floats), "
            "klipper (N full steps, 200), mechaduino (16384), magalpha (MA600, 32), c (N, 64), autosar (N, 32), "
            "lut (N, 64). ODrive and VESC take no table: asked for, the reason is told.",
        ),
    ],
    output: Annotated[
        Path | None,
        written(
            "Table to write: .cfg for moteus and klipper, .csv for lut, .h for the others; without it the errors are "
            "told alone.",
            "-o",
            "--output",
        ),
    ] = None,
    json: Json = None,
    plot: ErrorPlot = None,
    name: Annotated[
        str, written("Name in the file: prefix of C names, section of Klipper.", metavar="NAME")
    ] = "halltwin",
    check: Annotated[
        list[str] | None,
        typer.Option(
            metavar="SWEEPS",
            help="Sweep, glob or folder to test the table on; may be repeated. Exit code 1 where it makes the error "
            "larger.",
        ),
    ] = None,
    temperature: Annotated[
        float, typer.Option(metavar="C", help="Temperature in C for which the table is made.")
    ] = 25.0,
    least: Annotated[
        str,
        typer.Option(metavar="worst|rms", help="What the entries are chosen for: the smallest worst error, or RMS."),
    ] = "worst",
    force: Force = False,
    effects: EffectFiles = None,
    columns: Columns = None,
    max_size: MaxSize = "2GB",
    seed: Seed = 0,
    fail_on: Annotated[
        list[str] | None, fail_on_option("worse (the error is larger with the table, on held-out readings too)")
    ] = None,
) -> None:
    """Write the correction of a twin or of sweeps as the table that a drive or sensor loads, on its axis and its sign.

    The entries are chosen for the drive's own interpolation, read back by a model of it, and judged on readings that
    they were not made of. What no table removes is told beside it.
    """
    from scenarios.commands.export import Outputs, run
    from scenarios.commands.export_made import Asked
    from scenarios.commands.inputs import SweepFiles
    from twin.bounded_input import bytes_of

    run(
        sources,
        wish=Asked.checked(target, least, temperature, name),
        outputs=Outputs(table=output, json=json, plot=plot, force=force),
        check=SweepFiles(check or (), bytes_of(max_size), columns),
        effect_files=effects or (),
        seed=seed,
        fail_on=fail_on or (),
        command=command_line(context),
    )


def monitor(
    context: typer.Context,
    sweeps: Annotated[
        list[str],
        typer.Argument(metavar="SWEEPS...", help="Sweep files, globs or folders in order, or one with turns."),
    ],
    run_length: Annotated[
        float, typer.Option(metavar="SWEEPS", help="Sweeps between two false alarms, on average.")
    ] = 500.0,
    json: Annotated[
        Path | None,
        written("Write the series and the charts as JSON."),
    ] = None,
    plot: Annotated[
        Path | None,
        written("Draw the charts: .png, .svg or .pdf."),
    ] = None,
    force: Force = False,
    columns: Columns = None,
    max_size: MaxSize = "2GB",
    seed: Seed = 0,
    fail_on: Annotated[list[str] | None, fail_on_option("drift, or the NAME of a factor that drifts")] = None,
) -> None:
    """Chart the error factors over a series of sweeps: which one drifts, since which sweep, in which direction."""
    from scenarios.commands.inputs import SweepFiles
    from scenarios.commands.monitor import run
    from twin.bounded_input import bytes_of

    run(
        SweepFiles(sweeps, bytes_of(max_size), columns),
        run_length=run_length,
        json_path=json,
        plot=plot,
        force=force,
        seed=seed,
        fail_on=fail_on or (),
        command=command_line(context),
    )
