"""halltwin monitor: the error factors over a series of sweeps, and the first sweep at which one of them drifts."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.error_model.fit import fit_many
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.control_chart import WEIGHT, Chart, average_run_length, chart, limit_for
from diagnosis.factors.findings import senses_from_channels
from scenarios.commands.inputs import sweep_paths
from twin.angles import Array, radians
from twin.errors import UserError
from twin.sweep import FEWEST_ROWS, Sweep
from twin.sweep_file import write_beside

SCHEMA = "halltwin.monitor/1"
FEWEST_SWEEPS = 5
RUN_LENGTH = 500.0
_FACTORS = (
    ("Vx_over_Ax_percent", 100.0),
    ("Vy_over_Ay_percent", 100.0),
    ("gain_ratio", 1.0),
    ("beta_deg", 180.0 / np.pi),
    ("quad_percent", 100.0),
    ("zero_deg", 180.0 / np.pi),
)


@dataclass(frozen=True, eq=False)
class Monitored:
    """The series: names of the sweeps, their fits, one chart a factor and one for what is left over."""

    names: tuple[str, ...]
    fits: tuple[BaselineFit, ...]
    charts: tuple[Chart, ...]
    run_length: float

    @property
    def first(self) -> Chart | None:
        """The chart that signals first; of several, the one farthest outside."""
        signalled = [item for item in self.charts if item.signal is not None]
        if not signalled:
            return None
        return min(signalled, key=lambda item: (item.signal, -abs(item.averages[item.signal or 0])))


def run(
    names: Sequence[str],
    *,
    run_length: float = RUN_LENGTH,
    json_path: Path | None = None,
    plot: Path | None = None,
    seed: int = 0,
) -> None:
    """Fit every sweep of the series, chart the factors, print what was signalled."""
    if run_length < 10.0:
        raise UserError(f"run length is {run_length:g}; expected at least 10 sweeps between false alarms")
    found = monitor(series(names), run_length=run_length, seed=seed)
    for line in _report(found):
        print(line)
    if json_path is not None:
        write_beside(json_path, (json.dumps(to_dict(found), indent=1, allow_nan=False) + "\n").encode())
        print(f"wrote {json_path}")
    if plot is not None:
        from scenarios.commands.monitor_plot import plot_charts

        plot_charts(plot, found)
        print(f"wrote {plot}")


def series(names: Sequence[str]) -> list[Sweep]:
    """The sweeps in order: the files as given, or the turns of a single file. Raises UserError for too few."""
    sweeps = [Sweep.read(path) for path in sweep_paths(names)]
    if len(sweeps) == 1 and sweeps[0].turn is not None:
        sweeps = turns_of(sweeps[0])
    if len(sweeps) < FEWEST_SWEEPS:
        raise UserError(
            f"{len(sweeps)} sweeps; expected at least {FEWEST_SWEEPS}, as files or as turns of one file (column turn)"
        )
    return sweeps


def turns_of(sweep: Sweep) -> list[Sweep]:
    """Each turn as a sweep of its own, in order of appearance; turns with too few readings are left out."""
    assert sweep.turn is not None
    values, first = np.unique(sweep.turn, return_index=True)
    parts = []
    for value in values[np.argsort(first)]:
        rows = sweep.turn == value
        if np.count_nonzero(rows) >= FEWEST_ROWS:
            columns = {item.name: getattr(sweep, item.name) for item in fields(sweep)}
            picked = {key: data[rows] for key, data in columns.items() if isinstance(data, np.ndarray)}
            parts.append(replace(sweep, **picked, rejected={}, name=f"turn {value:g}"))
    return parts


def monitor(sweeps: Sequence[Sweep], *, run_length: float = RUN_LENGTH, seed: int = 0) -> Monitored:
    """Fit and chart. All charts together signal falsely once in ``run_length`` sweeps on average."""
    rng = np.random.default_rng(seed)
    angles = [(radians(sweep.reference_deg), radians(sweep.measured_deg)) for sweep in sweeps]
    # One pair of senses for the whole series: a pair that flips would be a jump of beta and Vy.
    senses = senses_from_channels(sweeps[0], *angles[0])
    if senses is None:
        first = fit_many(angles[:1], rng=rng, robust=True)[0].senses
        senses = first.sensor, first.output
    fits = fit_many(angles, rng=rng, robust=True, senses=senses)
    points = np.array([fit.point for fit in fits])
    points[:, -1] = np.unwrap(points[:, -1])
    left = np.log([max(fit.rms_rad, 1e-12) for fit in fits])
    columns: list[tuple[str, Array]] = [(name, scale * points[:, k]) for k, (name, scale) in enumerate(_FACTORS)]
    columns.append(("log_residual_rms", np.asarray(left)))
    limit = limit_for(run_length * len(columns))
    charts = tuple(chart(name, values, limit=limit) for name, values in columns)
    return Monitored(tuple(sweep.name for sweep in sweeps), tuple(fits), charts, run_length)


def to_dict(found: Monitored) -> dict[str, Any]:
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


def _signal(found: Monitored, item: Chart) -> dict[str, Any]:
    assert item.signal is not None
    return {
        "factor": item.name,
        "number": item.signal + 1,
        "sweep": found.names[item.signal],
        "direction": item.direction,
    }


def _report(found: Monitored) -> list[str]:
    limit = found.charts[0].limit
    delay = average_run_length(limit, shift=1.0)
    lines = [
        f"{len(found.names)} sweeps; EWMA charts of {len(found.charts)} factors, together one false alarm in "
        f"{found.run_length:.0f} sweeps; a lasting shift by one standard deviation shows after {delay:.0f} on average",
        "",
        f"{'factor':18} {'first':>11} {'last':>11} {'scatter':>10}   signalled at",
    ]
    for item in found.charts:
        signalled = "-"
        if item.signal is not None:
            way = "up" if item.direction > 0 else "down"
            signalled = f"sweep {item.signal + 1} ({found.names[item.signal]}), {way}"
        scatter = float(np.std(np.diff(item.values)) / np.sqrt(2.0))
        lines.append(f"{item.name:18} {item.values[0]:11.5f} {item.values[-1]:11.5f} {scatter:10.5f}   {signalled}")
    first = found.first
    lines.append("")
    if first is None or first.signal is None:
        lines.append("no drift signalled")
    else:
        way = "up" if first.direction > 0 else "down"
        lines.append(f"drift: {first.name} {way}, first signalled at sweep {first.signal + 1} of {len(found.names)}")
    return lines
