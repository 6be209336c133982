"""Commands on measured sweeps: what the simulation gets wrong, the error factors, their drift, a correction."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.options import EffectFiles, ErrorPlot, Force, Json, Seed


def explain(
    sweep: Annotated[Path, typer.Argument(help="Measured sweep: CSV or .csv.gz.")],
    twin: Annotated[Path | None, typer.Option(help="Hold the sweep against this twin as it is.")] = None,
    json: Json = None,
    report: Annotated[Path | None, typer.Option(help="Write a self-contained HTML report.")] = None,
    extended: Annotated[Path | None, typer.Option(help="Write the extended twin (TOML).")] = None,
    plot: ErrorPlot = None,
    force: Force = False,
    effects: EffectFiles = None,
    seed: Seed = 0,
) -> None:
    """Say what the simulation gets wrong about a measured sweep, name the cause, extend the twin, measure the gain."""
    from scenarios.commands.explain import Outputs, run

    run(
        sweep,
        twin=twin,
        outputs=Outputs(json=json, report=report, extended=extended, plot=plot, force=force),
        effect_files=effects or (),
        seed=seed,
    )


def diagnose(
    sweeps: Annotated[list[str], typer.Argument(help="Sweep files, globs or folders.")],
    json: Json = None,
    plot: Annotated[Path | None, typer.Option(help="Draw points and fitted curve: .png, .svg or .pdf.")] = None,
    convergence: Annotated[Path | None, typer.Option(help="Draw the swarm's convergence.")] = None,
    force: Force = False,
    seed: Seed = 0,
) -> None:
    """Quantify the paper's error factors of one or many sweeps: values, intervals, what cannot be known."""
    from scenarios.commands.diagnose import run

    run(sweeps, json_path=json, plot=plot, convergence=convergence, force=force, seed=seed)


def compensate(
    source: Annotated[Path, typer.Argument(help="Measured sweep, or twin TOML.")],
    header: Annotated[Path | None, typer.Option(help="Write a C header with fixed-point code.")] = None,
    table: Annotated[Path | None, typer.Option(help="Write a table as CSV.")] = None,
    points: Annotated[int, typer.Option(help="Length of the table.")] = 64,
    toml: Annotated[Path | None, typer.Option(help="Write the coefficients as TOML.")] = None,
    plot: ErrorPlot = None,
    check: Annotated[list[str] | None, typer.Option(help="Sweep, glob or folder to test on; may be repeated.")] = None,
    temperature: Annotated[float, typer.Option(help="Temperature in C that a twin is corrected for.")] = 25.0,
    tolerance: Annotated[float, typer.Option(help="Largest error in deg from orders left out.")] = 1e-3,
    prefix: Annotated[str, typer.Option(help="Prefix of the C names.")] = "halltwin",
    force: Force = False,
    effects: EffectFiles = None,
    seed: Seed = 0,
) -> None:
    """Turn a sweep or a twin into a continuous correction, and measure it on readings it never saw."""
    from scenarios.commands.compensate import Outputs, run

    outputs = Outputs(header=header, table=table, points=points, toml=toml, plot=plot, prefix=prefix, force=force)
    run(
        source,
        outputs=outputs,
        check=check or (),
        temperature_c=temperature,
        tolerance_deg=tolerance,
        effect_files=effects or (),
        seed=seed,
    )


def monitor(
    sweeps: Annotated[list[str], typer.Argument(help="Sweep files, globs or folders in order, or one with turns.")],
    run_length: Annotated[float, typer.Option(help="Sweeps between false alarms, on average.")] = 500.0,
    json: Annotated[Path | None, typer.Option(help="Write the series and the charts as JSON.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the charts: .png, .svg or .pdf.")] = None,
    force: Force = False,
    seed: Seed = 0,
) -> None:
    """Chart the error factors over a series of sweeps and say which one drifts, and since when."""
    from scenarios.commands.monitor import run

    run(sweeps, run_length=run_length, json_path=json, plot=plot, force=force, seed=seed)
