"""The error factors over a series of sweeps of one device: fitted sweep by sweep, each factor on a control chart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from diagnosis.error_model.fit import fit_many
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.control_chart import BACKWARD, BOTH, FORWARD, Chart, average_run_length, chart, limit_for
from diagnosis.factors.senses import known_senses
from twin.angles import Array, radians, wrap_deg
from twin.baseline import FACTORS, Factor
from twin.sweep import Sweep
from twin.sweep_checks import FEWEST_ROWS

FEWEST_SWEEPS = 5
"""Fewer values than this do not make a chart: the first two have nothing to be held against."""
RUN_LENGTH = 500.0
"""Sweeps between two false alarms, on average, unless another number is asked for."""
_SMALLEST_RMS_RAD = 1e-12


LAG = "lag_deg"
"""Half of what lies between the zeros of the two directions: what backlash and hysteresis make."""
RESIDUAL = "log_residual_rms"
Angles = tuple[Array, Array]


def _name(factor: Factor) -> str:
    """A factor's name in a series, which is charted in the twin's units."""
    return f"{factor.name}_percent" if factor.param.endswith("_percent") else factor.name


UNITS = {_name(factor): factor.effect.params[factor.param].unit for factor in FACTORS} | {RESIDUAL: "1", LAG: "deg"}
"""Every name that a chart may bear, with the unit of its values."""
LABELS = {_name(factor): factor.label for factor in FACTORS} | {RESIDUAL: "residual RMS", LAG: "lag"}
"""What people read for each of these names."""


@dataclass(frozen=True, eq=False)
class MonitoredSeries:
    """Names and fits of the sweeps in order, one chart a factor and one for the RMS of the residual.

    Where all sweeps go both ways the factors of each direction have charts of their own, and so has the lag between
    them. ``run_length`` is the average number of sweeps between two false alarms of all charts together.
    """

    names: tuple[str, ...]
    fits: tuple[BaselineFit, ...]
    charts: tuple[Chart, ...]
    run_length: float

    @property
    def signalled(self) -> tuple[Chart, ...]:
        """The charts that signal, the earliest first; of several at one sweep, the one farthest outside its limit."""
        found = [item for item in self.charts if item.signal is not None]
        return tuple(sorted(found, key=lambda item: (item.signal, -abs(item.averages[item.signal or 0]))))

    @property
    def first(self) -> Chart | None:
        """The chart that signals first. None where none signals."""
        return self.signalled[0] if self.signalled else None

    @property
    def delay(self) -> float:
        """Average number of sweeps until a lasting shift by one standard deviation is signalled."""
        return average_run_length(self.charts[0].limit, shift=1.0)


def monitor(sweeps: Sequence[Sweep], *, rng: np.random.Generator, run_length: float = RUN_LENGTH) -> MonitoredSeries:
    """Fit every sweep and chart the factors in the order of the sweeps.

    The false alarms of all charts together are ``run_length`` sweeps apart on average, so each single chart is given
    a run length as many times longer as there are charts.
    """
    parts = _by_travel(sweeps)
    # One pair of senses for the whole series: a pair that flips would be a jump of beta and Vy.
    senses, _ = known_senses(sweeps[0], *parts[BOTH][0])
    if senses is None:
        first = fit_many(parts[BOTH][:1], rng=rng, robust=True)[0].senses
        senses = first.sensor, first.output
    fits = {travel: fit_many(angles, rng=rng, robust=True, senses=senses) for travel, angles in parts.items()}
    courses = {(name, travel): c for travel, found in fits.items() for name, c in factor_values(found).items()}
    if BACKWARD in fits:
        zeros = [courses["zero_deg", travel] for travel in (FORWARD, BACKWARD)]
        courses[LAG, BOTH] = 0.5 * senses[0] * wrap_deg(zeros[1] - zeros[0])
    limit = limit_for(run_length * len(courses))
    charts = tuple(
        chart(name, values, limit=limit, unit=UNITS[name], travel=travel) for (name, travel), values in courses.items()
    )
    return MonitoredSeries(tuple(sweep.name for sweep in sweeps), tuple(fits[BOTH]), charts, run_length)


def _by_travel(sweeps: Sequence[Sweep]) -> dict[str, list[Angles]]:
    """Angles [rad] of each sweep's readings: of all, and of each direction where every sweep has enough of both."""
    angles = [(radians(sweep.reference_deg), radians(sweep.measured_deg)) for sweep in sweeps]
    ways = [sweep.motion().direction for sweep in sweeps]
    parts = {BOTH: angles}
    if all(min(np.count_nonzero(way > 0), np.count_nonzero(way < 0)) >= FEWEST_ROWS for way in ways):
        for travel, sense in ((FORWARD, 1), (BACKWARD, -1)):
            parts[travel] = [(a[way == sense], b[way == sense]) for (a, b), way in zip(angles, ways, strict=True)]
    return parts


def factor_values(fits: Sequence[BaselineFit]) -> dict[str, Array]:
    """Each factor of the fits in their order (sweeps,), in the unit of its name, and the log of the residual's RMS."""
    points = np.array([fit.point for fit in fits])
    points[:, -1] = np.unwrap(points[:, -1])
    values = {_name(factor): factor.per_coordinate * points[:, k] for k, factor in enumerate(FACTORS)}
    values[RESIDUAL] = np.log([max(fit.rms_rad, _SMALLEST_RMS_RAD) for fit in fits])
    return values


def turns_of(sweep: Sweep) -> list[Sweep]:
    """Each turn as a sweep of its own, in order of appearance; turns with too few readings for a fit are left out."""
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
