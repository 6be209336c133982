"""The control charts of a series: each factor's values, and its smoothed deviation with the limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.factors.control_chart import BACKWARD, BOTH, FORWARD, Chart
from diagnosis.factors.series import LABELS, RESIDUAL, MonitoredSeries
from diagnosis.report.plotting import style

_LOOKS = {BOTH: ("#222222", "o"), FORWARD: ("#0072B2", ">"), BACKWARD: ("#D55E00", "<")}
"""Colour and mark of the readings of both directions together, and of each."""
_SIGNAL = "#cc3311"


def charts_figure(found: MonitoredSeries) -> Any:
    """One row a factor: values on the left with the interval in which a change began, its chart on the right."""
    plt = style()
    names = list(dict.fromkeys(item.name for item in found.charts))
    figure, axes = plt.subplots(
        len(names), 2, figsize=(10.0, 1.55 * len(names) + 0.6), sharex=True, squeeze=False, layout="constrained"
    )
    for (left, right), name in zip(axes, names, strict=True):
        items = [item for item in found.charts if item.name == name]
        _row(left, right, items)
        unit = items[0].unit
        label = f"log of {LABELS[name]}" if name == RESIDUAL else LABELS[name]
        left.set_ylabel(f"{label}\n[{unit}]", fontsize=8)
    axes[0, 0].set_title("fitted factor; band: where its change began (95 %)", fontsize=9)
    axes[0, 1].set_title("smoothed deviation [standard deviations], with limits", fontsize=9)
    for axis in axes[-1]:
        axis.set_xlabel("number of the sweep")
    figure.align_ylabels(axes[:, 0])
    _legend(figure, axes[0], found)
    plt.close(figure)
    return figure


def _row(left: Any, right: Any, items: list[Chart]) -> None:
    """The charts of one factor, that of each direction in its own colour; signals are lines of that colour."""
    number = np.arange(1, items[0].values.size + 1)
    reach = 1.0
    for item in items:
        colour, mark = _LOOKS[item.travel]
        left.plot(number, item.values, f"{mark}-", ms=3, lw=0.8, color=colour)
        right.plot(number, item.averages, "-", lw=1.2, color=colour)
        reach = max(reach, 1.25 * item.limit, 1.15 * float(np.nanmax(np.abs(item.averages))))
        if item.signal is not None:
            right.plot(item.signal + 1, item.averages[item.signal], mark, ms=7, mfc="none", mec=_SIGNAL, mew=1.5)
        if item.change is not None:
            left.axvspan(item.change.low + 0.75, item.change.high + 1.25, color=colour, alpha=0.15, lw=0)
    right.set_ylim(-reach, reach)
    for side in (-items[0].limit, items[0].limit):
        right.axhline(side, color="0.4", lw=0.8, ls="--")
    for axis in (left, right):
        axis.grid(alpha=0.25)
    left.margins(y=0.12)


def _legend(figure: Any, axes: Any, found: MonitoredSeries) -> None:
    """Which colour is which direction, and what the ring is, below all rows."""
    for travel in dict.fromkeys(item.travel for item in found.charts):
        colour, mark = _LOOKS[travel]
        label = "all readings" if travel == BOTH else f"{travel} alone"
        axes[0].plot([], [], f"{mark}-", ms=4, lw=0.8, color=colour, label=label)
    axes[1].plot([], [], "o", ms=7, mfc="none", mec=_SIGNAL, mew=1.5, label="first outside the limit")
    axes[1].plot([], [], "--", color="0.4", lw=0.8, label="limit")
    handles = [handle for axis in axes for handle in axis.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False, fontsize=8)
