"""halltwin monitor: the error factors over a series of sweeps, and the first sweep at which one of them drifts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.factors.control_chart import WEIGHT, Chart
from diagnosis.factors.series import FEWEST_SWEEPS, RUN_LENGTH, MonitoredSeries, monitor, turns_of
from scenarios.commands.inputs import sweep_paths
from scenarios.commands.outputs import JSON, PICTURE, OutputFiles, json_text
from twin.errors import UserError
from twin.sweep import Sweep

SCHEMA = "halltwin.monitor/1"


def run(
    names: Sequence[str],
    *,
    run_length: float = RUN_LENGTH,
    json_path: Path | None = None,
    plot: Path | None = None,
    force: bool = False,
    seed: int = 0,
) -> None:
    """Fit every sweep of the series, chart the factors, print what was signalled."""
    if run_length < 10.0:
        raise UserError(f"run length is {run_length:g}; expected at least 10 sweeps between false alarms")
    paths = sweep_paths(names)
    files = OutputFiles.checked([(json_path, JSON), (plot, PICTURE)], inputs=paths, force=force)
    found = monitor(series(paths), rng=np.random.default_rng(seed), run_length=run_length)
    for line in _report(found):
        print(line)
    files.write({json_path: lambda: json_text(to_dict(found)), plot: lambda: _charts(found)})
    for written in files.formats:
        print(f"wrote {written}")


def _charts(found: MonitoredSeries) -> Any:
    from scenarios.commands.monitor_plot import charts_figure

    return charts_figure(found)


def series(paths: Sequence[Path]) -> list[Sweep]:
    """The sweeps in order: the files as given, or the turns of a single file. Raises UserError for too few."""
    sweeps = [Sweep.read(path) for path in paths]
    if len(sweeps) == 1 and sweeps[0].turn is not None:
        sweeps = turns_of(sweeps[0])
    if len(sweeps) < FEWEST_SWEEPS:
        raise UserError(
            f"{len(sweeps)} sweeps; expected at least {FEWEST_SWEEPS}, as files or as turns of one file (column turn)"
        )
    return sweeps


def to_dict(found: MonitoredSeries) -> dict[str, Any]:
    """The series as plain values."""
    return {
        "schema": SCHEMA,
        "sweeps": list(found.names),
        "average_run_length": found.run_length,
        "weight": WEIGHT,
        "limit": found.charts[0].limit,
        "first": None if found.first is None else _signal(found, found.first),
        "factors": {
            item.name: {
                "values": [float(v) for v in item.values],
                "averages": [None if np.isnan(v) else float(v) for v in item.averages],
                "signal": None if item.signal is None else _signal(found, item),
            }
            for item in found.charts
        },
    }


def _signal(found: MonitoredSeries, item: Chart) -> dict[str, Any]:
    assert item.signal is not None
    return {
        "factor": item.name,
        "number": item.signal + 1,
        "sweep": found.names[item.signal],
        "direction": item.direction,
    }


def _report(found: MonitoredSeries) -> list[str]:
    lines = [
        f"{len(found.names)} sweeps; EWMA charts of {len(found.charts)} factors, together one false alarm in "
        f"{found.run_length:.0f} sweeps; a lasting shift by one standard deviation shows after {found.delay:.0f} on "
        "average",
        "",
        f"{'factor':18} {'first':>11} {'last':>11} {'scatter':>10}   signalled at",
    ]
    for item in found.charts:
        signalled = "-"
        if item.signal is not None:
            way = "up" if item.direction > 0 else "down"
            signalled = f"sweep {item.signal + 1} ({found.names[item.signal]}), {way}"
        lines.append(
            f"{item.name:18} {item.values[0]:11.5f} {item.values[-1]:11.5f} {item.scatter:10.5f}   {signalled}"
        )
    drifts = found.first
    lines.append("")
    if drifts is None or drifts.signal is None:
        lines.append("no drift signalled")
    else:
        way = "up" if drifts.direction > 0 else "down"
        lines.append(f"drift: {drifts.name} {way}, first signalled at sweep {drifts.signal + 1} of {len(found.names)}")
    return lines
