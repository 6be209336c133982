"""halltwin bench: measure on a virtual or real bench, close the loop, replay a log, or be the bench for others."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenarios.bench.hidden import DEFAULT_TWIN, HIDDEN, hidden_encoder
from scenarios.bench.spin_options import COAST, check_spin, refuse_reference, refuse_sweeps
from scenarios.commands.once import check_once
from twin.errors import UserError

if TYPE_CHECKING:
    from scenarios.bench.closed_loop import Loop
    from scenarios.bench.faults import Fault, Opener
    from scenarios.bench.measure import Measured, Measurement
    from scenarios.bench.readings import Reading
    from scenarios.bench.sequence import Patience
    from scenarios.bench.spin import SpinJob, Spun
    from scenarios.commands.outputs import OutputFiles
    from twin.chain import Chain


@dataclass(frozen=True, kw_only=True)
class Options:
    """The options of the command, as given; ``heard`` is called with the sweep's name and all readings after each."""

    output: Path
    twin: str | None = None
    hide: Sequence[str] = ()
    points: int = 360
    turns: int = 1
    both_directions: bool = False
    speeds_rpm: Sequence[float] = (0.0,)
    temperatures: str = ""
    settle_s: float = 0.3
    spin: str | None = None
    spin_time_s: float | None = None
    rate_Hz: float | None = None
    channels: bool = True
    chamber: bool = True
    closed_loop: bool = False
    plot: Path | None = None
    record: Path | None = None
    replay: Path | None = None
    restart: bool = False
    force: bool = False
    serve: float | None = None
    interface: str = "virtual"
    channel: str | None = None
    bus_options: Sequence[str] = ()
    faults: Sequence[str] = ()
    timeout_s: float = 0.2
    attempts: int = 15
    manifest_deg: float = 20.0
    real_time: bool = False
    effect_files: Sequence[Path] = ()
    seed: int = 0
    fail_on: Sequence[str] = ()
    command: str | None = None
    heard: Callable[[str, list[Reading]], None] | None = None


def run(options: Options) -> None:
    """Do what the options ask for. Raises UserError."""
    for package, name in (("can", "python-can"), ("cantools", "cantools")):
        if find_spec(package) is None:
            raise UserError(f"the bench needs {name}; pip install '.[bench]' in the checkout")
    from scenarios.bench.buses import Interface, parse_options
    from scenarios.bench.faults import parse

    if options.fail_on and (options.replay is not None or options.serve is not None or not options.closed_loop):
        raise UserError("--fail-on asks about the closed loop; give --closed-loop")
    check_spin(options.spin, {"--spin-time": options.spin_time_s, "--rate": options.rate_Hz})
    if options.replay is not None:
        _replay(options)
        return
    faults = [fault for text in options.faults for fault in parse(text)]
    check_once("--fault", (f"{fault.kind}:{fault.node}" for fault in faults))
    open_bus = Interface(options.interface, options.channel, parse_options(options.bus_options)).opener()
    if options.serve is not None:
        _serve(options, open_bus, faults)
        return
    if options.spin is not None:
        _spin(options, open_bus, faults)
        return
    _measure(options, open_bus, faults)


def _measurement(options: Options, encoder: Chain | None, faults: Sequence[Fault]) -> Measurement:
    from scenarios.bench.bus_log import check_log_name
    from scenarios.bench.measure import Measurement
    from scenarios.bench.plan import Plan
    from scenarios.commands.protocol import numbers
    from twin.limits import require_within

    patience = _patience(options)
    require_within("manifest", options.manifest_deg, 0.0, 180.0, "deg")
    if options.record is not None:
        check_log_name(options.record)
    if options.temperatures and not options.chamber:
        raise UserError("--temperatures needs the climate chamber; leave --no-chamber out")
    plan = Plan(
        points=options.points,
        turns=options.turns,
        # The closed loop corrects to the middle between both directions, so it has to see both.
        both_directions=options.both_directions or options.closed_loop,
        speeds_rpm=tuple(options.speeds_rpm),
        temperatures_c=tuple(numbers("temperatures", options.temperatures)),
        settle_s=options.settle_s,
    )
    return Measurement(
        plan=plan,
        output=options.output,
        files=_files(options),
        twin=_twin_name(options),
        settings=settings_of(options, encoder, faults),
        channels=options.channels,
        chamber=options.chamber,
        patience=patience,
        record=options.record,
        manifest_deg=options.manifest_deg,
        heard=options.heard,
    )


def _files(options: Options) -> OutputFiles:
    from scenarios.bench.written import files_of_loop, files_of_measurement

    inputs = [name for name in (options.twin, *options.effect_files) if name is not None]
    if options.closed_loop:
        return files_of_loop(
            options.output, record=options.record, plot=options.plot, inputs=inputs, force=options.force
        )
    return files_of_measurement(options.output, record=options.record, inputs=inputs, force=options.force)


def _measure(options: Options, open_bus: Opener, faults: Sequence[Fault]) -> None:
    from scenarios.bench.buses import with_bench_faults
    from scenarios.bench.measure import journal_of, measure
    from scenarios.commands.fail_on import BENCH, asked
    from scenarios.commands.file_lock import alone
    from scenarios.commands.interrupt import interruptible

    if options.plot is not None and not options.closed_loop:
        raise UserError("--plot draws the closed loop; give --closed-loop, or draw the sweep with halltwin explain")
    words = asked(options.fail_on, BENCH)
    encoder = _encoder(options, faults)
    job = _measurement(options, encoder, faults)
    own_bus = with_bench_faults(open_bus, faults, options.seed)
    kept = f"the readings so far are kept beside {job.output}: run again with the same options to go on"
    lock = job.output.with_name(f"{job.output.name}.lock")
    with (
        interruptible(lambda: kept),
        alone(lock, busy=f"{job.output}: another halltwin measures into it; wait until it ends"),
    ):
        if not options.closed_loop:
            with (
                contextlib.closing(journal_of(job, restart=options.restart)) as journal,
                _bench(options, encoder, open_bus, faults, start=len(journal.readings)),
            ):
                measured = measure(job, journal, own_bus)
            _report(job.output, measured)
            _tell_written(job)
            return
        # Noise is drawn anew for each pose, so both measurements may share a bench and a seed.
        with _bench(options, encoder, open_bus, faults, start=0):
            _close_loop(options, job, own_bus, words)


def _close_loop(options: Options, job: Measurement, own_bus: Opener, words: Sequence[str]) -> None:
    """Measure, explain, compensate, measure again; raise FoundError where what the words ask about was found."""
    from scenarios.bench.closed_loop import lines, run_loop, summary
    from scenarios.commands.fail_on import in_loop, raise_found
    from twin.extensions import effects_with

    loop = run_loop(
        job,
        own_bus,
        restart=options.restart,
        effects=effects_with(options.effect_files),
        seed=options.seed,
        command=options.command,
        say=print,
    )
    for line in lines(loop):
        print(line)
    job.files.write({options.plot: lambda: _picture(loop)})
    _tell_written(job)
    raise_found(words, in_loop(summary(loop)))


def _spin(options: Options, open_bus: Opener, faults: Sequence[Fault]) -> None:
    """Spin the shaft of a bench without a reference, and write what the encoder alone says."""
    from scenarios.bench.buses import with_bench_faults
    from scenarios.bench.spin import measure_spin

    job = _spin_job(options)
    encoder = _encoder(options, faults)
    if encoder is not None:
        refuse_reference(faults)
    with _bench(options, encoder, open_bus, faults, start=0):
        spun = measure_spin(job, with_bench_faults(open_bus, faults, options.seed))
    _report_spin(options.output, spun)
    if options.record is not None:
        print(f"wrote {options.record}")


def _spin_job(options: Options) -> SpinJob:
    from scenarios.bench.spin import SpinJob, SpinPlan
    from scenarios.bench.written import files_of_spin

    refuse_sweeps(
        {
            "--closed-loop": options.closed_loop,
            "--plot": options.plot is not None,
            "--points": options.points != Options.points,
            "--turns": options.turns != Options.turns,
            "--temperatures": bool(options.temperatures),
            "--settle": options.settle_s != Options.settle_s,
            "--restart": options.restart,
        }
    )
    speeds = tuple(options.speeds_rpm)
    figures = {
        "time_s": options.spin_time_s,
        "rate_Hz": options.rate_Hz,
        "speeds_rpm": None if speeds == Options.speeds_rpm else speeds,
    }
    given: dict[str, Any] = {name: value for name, value in figures.items() if value is not None}
    plan = SpinPlan(coast=options.spin == COAST, both_directions=options.both_directions, **given)
    inputs = [name for name in (options.twin, *options.effect_files) if name is not None]
    return SpinJob(
        plan=plan,
        output=options.output,
        files=files_of_spin(options.output, record=options.record, inputs=inputs, force=options.force),
        channels=options.channels,
        patience=_patience(options),
        record=options.record,
    )


def _patience(options: Options) -> Patience:
    from scenarios.bench.sequence import Patience
    from twin.limits import require_within

    require_within("timeout", options.timeout_s, 1e-3, 3600.0, "s")
    require_within("attempts", options.attempts, 1, 1e6, whole=True)
    return Patience(timeout_s=options.timeout_s, attempts=options.attempts)


def _picture(loop: Loop) -> Any:
    from scenarios.bench.closed_loop_plot import loop_figure

    return loop_figure(loop)


def _tell_written(job: Measurement) -> None:
    """Name the files that have not been named."""
    for path in job.files.formats:
        if path != job.output:
            print(f"wrote {path}")


def _encoder(options: Options, faults: Sequence[Fault]) -> Chain | None:
    """The encoder of the virtual bench; None where the nodes are on the bus already. Raises UserError."""
    if options.interface != "virtual":
        if options.twin is not None or options.hide or any(fault.node != "bench" for fault in faults):
            raise UserError(
                f"--twin, --hide and --fault of a node are for the virtual bench; on {options.interface} "
                "the nodes are there already: give them where the nodes run (--serve)"
            )
        return None
    from scenarios.bench.hall_node import check_playable

    chain = _chain(options)
    check_playable(chain)
    return chain


@contextmanager
def _bench(
    options: Options, encoder: Chain | None, open_bus: Opener, faults: Sequence[Fault], *, start: int
) -> Iterator[None]:
    """The virtual bench around its encoder, where the bus is virtual and nobody else can be on it."""
    if encoder is None:
        yield
        return
    from scenarios.bench.virtual import Setup, running

    # A continued run draws other noise than the one it continues.
    setup = Setup(
        chain=encoder,
        faults=faults,
        seed=(options.seed, start),
        real_time=options.real_time,
        reference=options.spin is None,
    )
    with running(setup, open_bus):
        yield


def _chain(options: Options) -> Chain:
    hides = options.hide or ((HIDDEN,) if options.closed_loop and options.twin is None else ())
    return hidden_encoder(options.twin, hides, options.effect_files)


def _twin_name(options: Options) -> str:
    if options.interface != "virtual":
        return f"on {options.interface}"
    return " ".join([options.twin or DEFAULT_TWIN, *options.hide, f"seed {options.seed}"])


def settings_of(options: Options, encoder: Chain | None, faults: Sequence[Fault]) -> dict[str, Any]:
    """Everything besides the plan that the readings depend on, as plain values; ``encoder`` where it is virtual."""
    from diagnosis.report.provenance import version
    from twin.files import to_dict
    from twin.regular_file import digest

    return {
        "channels": options.channels,
        "chamber": options.chamber,
        "interface": options.interface,
        "channel": options.channel,
        "bus_options": list(options.bus_options),
        "faults": [f"{fault.kind}:{fault.node}={fault.value:g}" for fault in faults],
        "effects": [f"{path.name} (SHA-256 {digest(path.resolve())[:16]})" for path in options.effect_files],
        "seed": options.seed,
        **({} if encoder is None else {"twin": to_dict(encoder), "version": version()}),
    }


def _serve(options: Options, open_bus: Opener, faults: Sequence[Fault]) -> None:
    """Be the bench for another process, for a time; 0: until interrupted."""
    from scenarios.bench.virtual import Setup, running

    if options.spin is not None:
        raise UserError("--serve is the bench itself, which can spin; give --spin where it is measured")
    if options.interface == "virtual":
        raise UserError("--serve: the virtual interface ends at this process; give another, e.g. udp_multicast, vcan")
    setup = Setup(chain=_chain(options), faults=faults, seed=(options.seed, 0), real_time=options.real_time)
    with running(setup, open_bus):
        print(f"the virtual bench is on {options.interface}; Ctrl-C ends it", flush=True)
        _wait(options.serve or float("inf"), time.sleep)


def _wait(seconds: float, sleep: Callable[[float], None]) -> None:
    end = time.monotonic() + seconds
    try:
        while (left := end - time.monotonic()) > 0.0:
            sleep(min(left, 1.0))
    except KeyboardInterrupt:
        return


def _replay(options: Options) -> None:
    from scenarios.bench.replay import replay
    from scenarios.bench.spin import Spun

    assert options.replay is not None
    found = replay(
        options.replay,
        options.output,
        channels=options.channels,
        chamber=options.chamber,
        manifest_deg=options.manifest_deg,
        force=options.force,
    )
    if isinstance(found, Spun):
        _report_spin(options.output, found)
    else:
        _report(options.output, found)


def _report_spin(output: Path, spun: Spun) -> None:
    lost = f", {spun.asked - spun.readings} rejected" if spun.asked is not None else ""
    print(f"wrote {output}: {spun.readings} readings without a reference{lost}")
    _report_bus(spun.counts)


def _report(output: Path, measured: Measured) -> None:
    kept, rejected, counts = measured.pretreated.kept, measured.pretreated.rejected, measured.counts
    already = f", {measured.continued} of them from the run before" if measured.continued else ""
    print(f"wrote {output}: {len(kept)} readings{already}, {len(rejected)} rejected")
    for index, why in rejected.items():
        print(f"- reading {index + 1} rejected: {why}")
    _report_bus(counts)


def _report_bus(counts: Mapping[str, int]) -> None:
    faults = [f"{count} {kind}" for kind, count in sorted(counts.items()) if kind != "frames"]
    print(f"bus: {counts['frames']} frames; {', '.join(faults) or 'no faults'}")
