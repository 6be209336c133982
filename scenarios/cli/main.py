"""The command line: options only. What a command does lives in the file of its name, imported when it is called."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from scenarios.cli.effects import EffectFiles, check_effect, new_effect
from scenarios.cli.options import BothDirections, Points, Seed, SpeedRpm, Temperatures, Turns
from scenarios.cli.studies import design, generate, recover

app = typer.Typer(
    name="halltwin",
    help="A digital twin of a Hall angle sensor that says what its own simulation gets wrong, and why.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


@app.command()
def explain(
    sweep: Annotated[Path, typer.Argument(help="Measured sweep: CSV or .csv.gz.")],
    twin: Annotated[Path | None, typer.Option(help="Hold the sweep against this twin as it is.")] = None,
    json: Annotated[Path | None, typer.Option(help="Write the answer as JSON.")] = None,
    report: Annotated[Path | None, typer.Option(help="Write a self-contained HTML report.")] = None,
    extended: Annotated[Path | None, typer.Option(help="Write the extended twin (TOML).")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the error before and after: .png, .svg or .pdf.")] = None,
    effects: EffectFiles = None,
    seed: Seed = 0,
) -> None:
    """Say what the simulation gets wrong about a measured sweep, name the cause, extend the twin, measure the gain."""
    from scenarios.commands.explain import run

    run(
        sweep,
        twin=twin,
        json_path=json,
        report=report,
        extended=extended,
        plot=plot,
        effect_files=effects or (),
        seed=seed,
    )


@app.command()
def causes(
    markdown: Annotated[bool, typer.Option("--markdown", help="As the tables of the guide.")] = False,
    effects: EffectFiles = None,
) -> None:
    """List the causes that the twin can simulate and the search can name."""
    from scenarios.commands.causes import run

    run(markdown=markdown, effect_files=effects or ())


@app.command()
def simulate(
    twin: Annotated[str, typer.Argument(help="Twin TOML, or the name of a preset.")] = "imc-14bit",
    output: Annotated[Path, typer.Option("-o", "--output", help="Sweep to write: CSV or .csv.gz.")] = Path("sweep.csv"),
    motion: Annotated[Path | None, typer.Option(help="Simulate on the motion of this recorded sweep.")] = None,
    turns: Turns = 1,
    points: Points = 360,
    both_directions: BothDirections = False,
    speed_rpm: SpeedRpm = None,
    temperatures: Temperatures = "",
    channels: Annotated[bool, typer.Option(help="Record vx and vy as well.")] = True,
    reference_lines: Annotated[int | None, typer.Option(help="Lines of the reference encoder (4 counts each).")] = None,
    trace: Annotated[Path | None, typer.Option(help="Write every intermediate signal as CSV.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the trace: .png, .svg or .pdf.")] = None,
    effects: EffectFiles = None,
    seed: Seed = 0,
) -> None:
    """Simulate a sweep from a twin, on a protocol or on a recorded motion."""
    from scenarios.commands.protocol import Protocol, numbers
    from scenarios.commands.simulate import run

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
        output,
        recorded=motion,
        protocol=protocol,
        seed=seed,
        reference_lines=reference_lines,
        trace_path=trace,
        plot_path=plot,
        effect_files=effects or (),
    )


@app.command()
def diagnose(
    sweeps: Annotated[list[str], typer.Argument(help="Sweep files, globs or folders.")],
    json: Annotated[Path | None, typer.Option(help="Write the answer as JSON.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw points and fitted curve: .png, .svg or .pdf.")] = None,
    convergence: Annotated[Path | None, typer.Option(help="Draw the swarm's convergence.")] = None,
    seed: Seed = 0,
) -> None:
    """Quantify the paper's error factors of one or many sweeps: values, intervals, what cannot be known."""
    from scenarios.commands.diagnose import run

    run(sweeps, json_path=json, plot=plot, convergence=convergence, seed=seed)


@app.command()
def spinning(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the picture and its data.")],
    seed: Seed = 0,
) -> None:
    """Show the spinning current phase by phase: the offset before and after, the noise with its 1/f corner moved."""
    from scenarios.commands.spinning import run

    run(output, seed=seed)


@app.command()
def paper(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for table and figures.")],
) -> None:
    """Regenerate Table 1 and Figures 3 to 9 of the paper from the twin."""
    from scenarios.commands.paper import run

    run(output)


@app.command()
def compensate(
    source: Annotated[Path, typer.Argument(help="Measured sweep, or twin TOML.")],
    header: Annotated[Path | None, typer.Option(help="Write a C header with fixed-point code.")] = None,
    table: Annotated[Path | None, typer.Option(help="Write a table as CSV.")] = None,
    points: Annotated[int, typer.Option(help="Length of the table.")] = 64,
    toml: Annotated[Path | None, typer.Option(help="Write the coefficients as TOML.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the error before and after: .png, .svg or .pdf.")] = None,
    check: Annotated[list[str] | None, typer.Option(help="Sweep, glob or folder to test on; may be repeated.")] = None,
    temperature: Annotated[float, typer.Option(help="Temperature in C that a twin is corrected for.")] = 25.0,
    tolerance: Annotated[float, typer.Option(help="Largest error in deg from orders left out.")] = 1e-3,
    prefix: Annotated[str, typer.Option(help="Prefix of the C names.")] = "halltwin",
    effects: EffectFiles = None,
    seed: Seed = 0,
) -> None:
    """Turn a sweep or a twin into a continuous correction, and measure it on readings it never saw."""
    from scenarios.commands.compensate import Outputs, run

    outputs = Outputs(header=header, table=table, points=points, toml=toml, plot=plot, prefix=prefix)
    run(
        source,
        outputs=outputs,
        check=check or (),
        temperature_c=temperature,
        tolerance_deg=tolerance,
        effect_files=effects or (),
        seed=seed,
    )


@app.command()
def monitor(
    sweeps: Annotated[list[str], typer.Argument(help="Sweep files, globs or folders in order, or one with turns.")],
    run_length: Annotated[float, typer.Option(help="Sweeps between false alarms, on average.")] = 500.0,
    json: Annotated[Path | None, typer.Option(help="Write the series and the charts as JSON.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Draw the charts: .png, .svg or .pdf.")] = None,
    seed: Seed = 0,
) -> None:
    """Chart the error factors over a series of sweeps and say which one drifts, and since when."""
    from scenarios.commands.monitor import run

    run(sweeps, run_length=run_length, json_path=json, plot=plot, seed=seed)


@app.command()
def hardware(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the picture and its data.")],
    twin: Annotated[str, typer.Argument(help="Twin TOML or preset, for its magnet.")] = "imc-14bit",
    effects: EffectFiles = None,
    seed: Seed = 0,
) -> None:
    """Run one turn through magnet, concentrator, spun plates, converter, CORDIC and link, in the hardware's units."""
    from scenarios.commands.hardware import run_command

    run_command(twin, output, effect_files=effects or (), seed=seed)


@app.command()
def bench(
    output: Annotated[Path, typer.Option("-o", "--output", help="Sweep to write: CSV or .csv.gz.")] = Path("bench.csv"),
    closed_loop: Annotated[
        bool, typer.Option("--closed-loop", help="Measure, explain, compensate, measure again.")
    ] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw the closed loop: .png, .svg or .pdf.")] = None,
    twin: Annotated[str | None, typer.Option(help="Encoder on the virtual bench: twin TOML or preset.")] = None,
    hide: Annotated[
        list[str] | None, typer.Option(help="Effect to hide in it, EFFECT:PARAMETER=VALUE[,...]; may be repeated.")
    ] = None,
    points: Points = 360,
    turns: Turns = 1,
    both_directions: BothDirections = False,
    speed_rpm: SpeedRpm = None,
    temperatures: Temperatures = "",
    settle: Annotated[float, typer.Option(help="Time in s from the last step to a reading.")] = 0.3,
    channels: Annotated[bool, typer.Option(help="The encoder sends vx and vy as well.")] = True,
    chamber: Annotated[bool, typer.Option(help="A climate chamber on the bus tells the temperature.")] = True,
    interface: Annotated[str, typer.Option(help="Interface of python-can.")] = "virtual",
    channel: Annotated[str | None, typer.Option(help="Its channel, e.g. can0.")] = None,
    bus_option: Annotated[
        list[str] | None, typer.Option(help="Further option of the interface, KEY=VALUE; may be repeated.")
    ] = None,
    serve: Annotated[float | None, typer.Option(help="Be the virtual bench for other processes for so many s.")] = None,
    record: Annotated[Path | None, typer.Option(help="Record the bus: .asc, .blf, .csv, .db, .log or .trc.")] = None,
    replay: Annotated[Path | None, typer.Option(help="Make the sweep from such a log instead.")] = None,
    restart: Annotated[bool, typer.Option("--restart", help="Do not go on with a broken run.")] = False,
    timeout: Annotated[float, typer.Option(help="Time in s to wait for an answer.")] = 0.2,
    attempts: Annotated[int, typer.Option(help="How often to ask a silent node.")] = 15,
    manifest: Annotated[float, typer.Option(help="Reject readings this far off the typical error, in deg.")] = 20.0,
    fault: Annotated[
        list[str] | None, typer.Option(help="Fault on the bus, KIND[:NODE][=VALUE], e.g. lost=0.02, silent:hall.")
    ] = None,
    real_time: Annotated[bool, typer.Option("--real-time", help="Motions take the time they would take.")] = False,
    effects: EffectFiles = None,
    seed: Seed = 0,
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
            channels=channels,
            chamber=chamber,
            closed_loop=closed_loop,
            plot=plot,
            record=record,
            replay=replay,
            restart=restart,
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
        )
    )


for command in (new_effect, check_effect, generate, design, recover):
    app.command()(command)


def main() -> None:
    """Run the command line; a mistake of the user's is one line on stderr and exit code 2."""
    # The matrices here are small: a thread of their own for each core costs more than it brings.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        app()
    except (OSError, ValueError) as error:
        # twin loads numpy, which --help need not wait for.
        from twin.errors import UserError

        if isinstance(error, OSError) and error.filename is not None:
            said = f"{error.filename}: {error.strerror}; give another path"
        elif isinstance(error, UserError):
            said = str(error)
        else:
            raise
        # Names of files and cells may hold line breaks and control characters; the message stays one line.
        line = " ".join(said.split())
        print(f"halltwin: {''.join(c if c.isprintable() else '?' for c in line)}", file=sys.stderr)
        raise SystemExit(2) from None


if __name__ == "__main__":
    main()
