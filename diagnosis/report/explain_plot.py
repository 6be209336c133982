"""The picture of an explained sweep: the error as measured, what the baseline leaves, what the extended twin leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.discovery.marks.row_masks import raw_residual
from diagnosis.discovery.result import Discovery
from diagnosis.report.facts import angle_error_deg
from diagnosis.report.fitted_rows import fitted
from diagnosis.report.plotting import DIRECTIONS, drawing
from twin.angles import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def residual_figure(found: Discovery) -> Figure:
    """Three panels over the reference angle [deg], directions apart. Raises UserError without matplotlib.

    Of the readings that the fits were made of; how many are not drawn stands above.
    """
    sweep, kept = found.sweep, fitted(found)
    angle = np.mod(sweep.reference_deg, 360.0)[kept]
    way = sweep.motion().direction[kept]
    error_deg = angle_error_deg(found.baseline, sweep)[kept]
    panels = (
        ("as measured", error_deg - np.mean(error_deg)),
        ("left by the error model", np.degrees(raw_residual(found.baseline, sweep))[kept]),
        ("left by the extended twin", np.degrees(raw_residual(found.fit, sweep))[kept]),
    )
    with drawing() as new_figure:
        figure = new_figure(figsize=(10.0, 3.2), layout="constrained")
        axes = figure.subplots(1, 3, sharex=True)
        for axis, (title, values) in zip(axes, panels, strict=True):
            _panel(axis, angle, way, values, title)
        axes[0].set_ylabel("angle error [deg]")
        limit = 1.1 * max(float(np.max(np.abs(values))) for _, values in panels[1:])
        for axis in axes[1:]:
            axis.set_ylim(-limit, limit)
        axes[0].legend(loc="best", markerscale=2.5)
        named = ", ".join(cause.name for cause in found.causes) or "no cause"
        apart = int(np.count_nonzero(~kept))
        figure.suptitle(f"{sweep.name}: {named}" + (f"; {apart} readings not drawn" if apart else ""), fontsize=10)
    return figure


def _panel(axis: Any, angle: Array, way: Array, values: Array, title: str) -> None:
    """Values (n,) [deg] over the angle (n,) [deg], the two directions in colours of their own."""
    for sense, colour, mark, label in DIRECTIONS:
        if np.any(way == sense):
            drawn = {"ms": 2.4, "mew": 0.6, "color": colour, "alpha": 0.7}
            axis.plot(angle[way == sense], values[way == sense], mark, label=label, **drawn)
    axis.set_title(f"{title}: {np.sqrt(np.mean(values**2)):.3g} deg RMS", fontsize=9)
    axis.set_xlabel("reference angle [deg]")
    axis.set_xticks(range(0, 361, 90))
    axis.grid(alpha=0.3)
