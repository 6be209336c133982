"""halltwin monitor: the error factors over a series of sweeps, which of them drifts, and since when."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.factors.control_chart import BOTH, WEIGHT, Chart
from diagnosis.factors.series import FEWEST_SWEEPS, LABELS, RUN_LENGTH, UNITS, MonitoredSeries, monitor, turns_of
from diagnosis.report.provenance import Provenance
from diagnosis.report.row_counts import counts_of, left_out_words, rejected_words
from scenarios.commands.fail_on import MONITOR, asked, raise_found
from scenarios.commands.inputs import SweepFiles, SweepsRead, the_same
from scenarios.commands.monitor_text import show, way
from scenarios.commands.outputs import JSON, PICTURE, OutputFiles, json_text
from twin.errors import UserError
from twin.sweep import Sweep

SCHEMA = "halltwin.monitor/1"
LONGEST_RUN = 1e6


def run(
    given: SweepFiles,
    *,
    run_length: float = RUN_LENGTH,
    json_path: Path | None = None,
    plot: Path | None = None,
    force: bool = False,
    seed: int = 0,
    fail_on: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """Fit every sweep of the series, chart the factors, print what was signalled."""
    words = asked(fail_on, (*MONITOR, *UNITS, *LABELS.values()))
    made = Provenance.today(seed=seed, command=command)
    if not 10.0 <= run_length <= LONGEST_RUN:
        raise UserError(f"run length is {run_length:g}; expected 10 to {LONGEST_RUN:g} sweeps between false alarms")
    paths = given.paths()
    files = OutputFiles.checked([(json_path, JSON), (plot, PICTURE)], inputs=paths, force=force)
    read = given.read(paths)
    sweeps = series(read.sweeps)
    found = monitor(sweeps, rng=np.random.default_rng(seed), run_length=run_length)
    counts = readings_of(sweeps, found)
    answer = {**to_dict(found, made), "readings": counts, "unusable": read.listed()}
    try:
        show(found)
        for line in filter(None, (left_out_words(counts), *_rejected_of_turns(read, sweeps), *read.lines)):
            print(line)
    finally:
        files.write({json_path: lambda: json_text(answer), plot: lambda: _charts(found)})
    files.tell_written()
    raise_found(words, _drifts(found))
    read.raise_unusable()


def readings_of(sweeps: Sequence[Sweep], found: MonitoredSeries) -> list[dict[str, Any]]:
    """What became of the readings of each sweep of the series, as plain values."""
    return [
        {"sweep": sweep.name, **counts_of(sweep, sweep.numbers[fit.outliers].tolist())}
        for sweep, fit in zip(sweeps, found.fits, strict=True)
    ]


def _rejected_of_turns(read: SweepsRead, sweeps: Sequence[Sweep]) -> Iterator[str]:
    """Rows that could not be used of a sweep whose turns are the series: they belong to none of them."""
    whole = read.sweeps[0]
    if len(sweeps) > len(read.sweeps) and whole.rejected:
        yield f"{whole.name}: {rejected_words(counts_of(whole, ()))}"


def _charts(found: MonitoredSeries) -> Any:
    from scenarios.commands.monitor_plot import charts_figure

    return charts_figure(found)


def series(read: Sequence[Sweep]) -> list[Sweep]:
    """The sweeps in order: those given, or the turns of a single one. Raises UserError for too few."""
    sweeps = list(read)
    if len(sweeps) == 1 and sweeps[0].turn is not None:
        sweeps = turns_of(sweeps[0])
    if len(sweeps) < FEWEST_SWEEPS:
        raise UserError(
            f"{len(sweeps)} sweeps; expected at least {FEWEST_SWEEPS}, as files or as turns of one file (column turn)"
        )
    for alike in the_same(sweeps):
        raise UserError(
            f"{' and '.join(alike)} hold the same readings, so nothing can drift; give each measurement once"
        )
    return sweeps


def to_dict(found: MonitoredSeries, made: Provenance) -> dict[str, Any]:
    """The series as plain values; what comes of one direction stands inside its factor."""
    factors: dict[str, Any] = {}
    for item in found.charts:
        if item.travel == BOTH:
            factors[item.name] = _course(found, item)
        else:
            factors[item.name][item.travel] = _course(found, item)
    return {
        "schema": SCHEMA,
        **made.to_dict(),
        "sweeps": list(found.names),
        "average_run_length": found.run_length,
        "weight": WEIGHT,
        "limit": found.charts[0].limit,
        "first": None if found.first is None else _signal(found, found.first),
        "factors": factors,
    }


def _course(found: MonitoredSeries, item: Chart) -> dict[str, Any]:
    return {
        "unit": item.unit,
        "values": [float(v) for v in item.values],
        "averages": [None if np.isnan(v) else float(v) for v in item.averages],
        "signal": None if item.signal is None else _signal(found, item),
        "change": _change(found, item),
    }


def _signal(found: MonitoredSeries, item: Chart) -> dict[str, Any]:
    assert item.signal is not None
    return {
        "factor": item.name,
        "travel": item.travel,
        "number": item.signal + 1,
        "sweep": found.names[item.signal],
        "direction": item.direction,
    }


def _change(found: MonitoredSeries, item: Chart) -> dict[str, Any] | None:
    """When the factor began to change; numbers of sweeps count from 1."""
    if item.change is None:
        return None
    return {
        "kind": item.change.shape,
        "number": item.change.first + 1,
        "low": item.change.low + 1,
        "high": item.change.high + 1,
        "sweep": found.names[item.change.first],
        "size": item.change.size,
    }


def _drifts(found: MonitoredSeries) -> dict[str, str]:
    """What --fail-on may ask for: that anything drifts, and each factor that does."""
    drifts: dict[str, str] = {}
    for item in found.signalled:
        assert item.signal is not None
        said = f"{way(item)}, signalled at sweep {item.signal + 1}"
        for word in (item.name, LABELS[item.name]):
            drifts.setdefault(word, said)
        drifts.setdefault("drift", f"{LABELS[item.name]} {said}")
    return drifts
