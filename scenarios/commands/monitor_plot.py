"""The control charts of a series: each factor's values, and its smoothed deviation with the limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.factors.series import MonitoredSeries
from diagnosis.report.plotting import style

_LINE, _SIGNAL = "#4477aa", "#cc3311"


def charts_figure(found: MonitoredSeries) -> Any:
    """One row a factor: values on the left, chart on the right; a signal is marked in both."""
    plt = style()
    rows = len(found.charts)
    figure, axes = plt.subplots(rows, 2, figsize=(10.0, 1.55 * rows), sharex=True, layout="constrained")
    number = np.arange(1, len(found.names) + 1)
    for (left, right), item in zip(axes, found.charts, strict=True):
        left.plot(number, item.values, ".-", ms=4, lw=0.8, color=_LINE)
        left.set_ylabel(item.name, fontsize=8)
        right.plot(number, item.averages, "-", lw=1.2, color=_LINE)
        reach = 1.25 * max(item.limit, float(np.nanmax(np.abs(item.averages))))
        right.set_ylim(-reach, reach)
        for side in (-item.limit, item.limit):
            right.axhline(side, color="0.4", lw=0.8, ls="--")
        if item.signal is not None:
            for axis in (left, right):
                axis.axvline(item.signal + 1, color=_SIGNAL, lw=1.0)
        for axis in (left, right):
            axis.grid(alpha=0.25)
    axes[0, 0].set_title("fitted factor", fontsize=9)
    axes[0, 1].set_title("smoothed deviation, in standard deviations, with limits", fontsize=9)
    for axis in axes[-1]:
        axis.set_xlabel("sweep")
    figure.align_ylabels(axes[:, 0])
    plt.close(figure)
    return figure
