"""Pictures of a diagnosis: points and fitted curve like the paper's Fig. 14, convergence like its Fig. 13."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.error_model.model import ZERO
from diagnosis.factors.air_gaps import AirGaps
from diagnosis.factors.findings import Findings, curve_deg
from diagnosis.report.gap_plot import draw_over_gaps
from diagnosis.report.plotting import CURVE, DIRECTIONS, drawing
from twin.angles import Array, wrap_deg
from twin.errors import UserError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_PANELS = 16
_GAPS_HEIGHT = 0.6
"""Of the panels over the air gap, against the picture's width."""
_MOST_POINTS = 20000
_POINT, _CURVE = "#4477aa", "#cc3311"


def fitted_figure(found: Sequence[Findings], over_gaps: AirGaps | None = None) -> Figure:
    """One panel a sweep: measured angle error over the turn, and the curve of the fitted parameters.

    Below them the factors over the air gap, where the sweeps were recorded at several. Raises UserError without
    matplotlib, or for more sweeps than can be seen in one picture.
    """
    if len(found) > MOST_PANELS:
        raise UserError(f"{len(found)} sweeps do not fit in one picture; plot at most {MOST_PANELS}")
    columns = int(np.ceil(np.sqrt(len(found))))
    rows = -(-len(found) // columns)
    width, height = max(4.2 * columns, 6.5), max(2.9 * rows, 3.8)
    with drawing() as new_figure:
        if over_gaps is None:
            figure = new_figure(figsize=(width, height), layout="constrained")
            _draw_sweeps(figure, found, rows, columns)
            return figure
        below = _GAPS_HEIGHT * width
        figure = new_figure(figsize=(width, height + below), layout="constrained")
        parts: Any = figure.subfigures(2, 1, height_ratios=(height, below))
        _draw_sweeps(parts[0], found, rows, columns)
        axes = parts[1].subplots(2, 2, sharex=True)
        draw_over_gaps(axes.flat, over_gaps)
        parts[1].legend(*axes.flat[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    return figure


def _draw_sweeps(figure: Any, found: Sequence[Findings], rows: int, columns: int) -> None:
    """The panels of the sweeps with their common legend."""
    axes = figure.subplots(rows, columns, squeeze=False)
    for axis, item in zip(axes.flat, found, strict=False):
        _panel(axis, item)
    for axis in axes.flat[len(found) :]:
        axis.set_visible(False)
    # A sweep that turned one way only has fewer symbols than the legend names.
    shown = [axis.get_legend_handles_labels() for axis in axes.flat]
    named = {label: handle for pair in shown for handle, label in zip(*pair, strict=True)}
    figure.legend(named.values(), named.keys(), loc="outside lower center", ncols=3, frameon=False)


def _panel(axis: Any, item: Findings) -> None:
    fit, sweep = item.fit, item.sweep
    slope = fit.senses.sensor * fit.senses.output
    shaft = np.remainder(sweep.reference_deg, 360.0)
    zero = fit.senses.output * float(np.degrees(fit.point[ZERO]))
    error = wrap_deg(sweep.measured_deg - slope * sweep.reference_deg - zero)
    pick = np.flatnonzero(~fit.outliers)[:: max(1, len(sweep) // _MOST_POINTS)]
    turn: Array = np.linspace(0.0, 360.0, 721)
    way = sweep.motion().direction[pick]
    for sense, colour, mark, label in DIRECTIONS:
        chosen = pick[way == sense]
        if chosen.size:
            drawn = {"ms": 3.0, "mew": 0.7, "ls": "", "color": colour, "rasterized": pick.size > 5000}
            axis.plot(shaft[chosen], error[chosen], mark, label=f"measured, {label}", **drawn)
    axis.plot(turn, curve_deg(fit, turn), "-", lw=1.2, color=CURVE, label="fitted factors")
    axis.set(xlim=(0, 360), xticks=range(0, 361, 90), xlabel="shaft angle [deg]", ylabel="angle error [deg]")
    left = f"{np.degrees(fit.rms_rad):.3f} deg RMS left"
    hidden = f", {len(item.glitch_rows)} gross errors not shown" if item.glitch_rows else ""
    axis.set_title(f"{sweep.name}: {left}{hidden}", fontsize=9)
    axis.grid(alpha=0.25)


def convergence_figure(found: Sequence[Findings]) -> Figure:
    """RMS of the swarm's best and of the particles' own bests over the iterations; the polished RMS as a line.

    Raises UserError without matplotlib, and where no swarm has run.
    """
    found = [one for one in found if one.fit.search.rounds]
    if not found:
        raise UserError("no swarm has run, whose convergence could be drawn; ask for it: diagnose(sweep, swarm=True)")
    with drawing() as new_figure:
        figure = new_figure(figsize=(6.5, 4.0), layout="constrained")
        axis = figure.subplots()
        for number, item in enumerate(found):
            steps = item.fit.contributions
            own, best = ("own bests, mean", "best of all") if number == 0 else (None, None)
            thin = {"lw": 1.4, "alpha": max(0.9 / np.sqrt(len(found)), 0.15)}
            axis.semilogy(np.degrees(steps.own_history_rad), color=_POINT, label=own, **thin)
            axis.semilogy(np.degrees(steps.best_history_rad), color=_CURVE, label=best, **thin)
        if len(found) == 1:
            floor = float(np.degrees(found[0].fit.contributions.polished_rms_rad))
            axis.axhline(floor, color="0.3", lw=0.9, ls="--", label="after the polish")
        axis.set(xlabel="iteration", ylabel="RMS angle error [deg]")
        axis.grid(alpha=0.25, which="both")
        axis.legend(frameon=True)
    return figure
