"""The picture of a trace: channels, error, and what each effect does to the angle, each on a scale of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from scenarios.commands.trace import CONVERSIONS, Trace
from twin.angles import TAU, Array

_DIRECTIONS = ((1.0, "#0072B2", "forward"), (-1.0, "#D55E00", "backward"))
_NOTHING_DEG = 1e-9


@dataclass(frozen=True, eq=False)
class _Panel:
    """A small picture: title, unit of the ordinate, and curves (n,) by what tells them apart."""

    title: str
    unit: str
    curves: dict[str, Array]


def trace_figure(traced: Trace, *, title: str) -> Any:
    """One panel a signal, over the shaft angle or, of more than a turn, the readings; effects in their order."""
    plt = style()
    panels = _panels(traced)
    rows = -(-len(panels) // 2)
    figure, axes = plt.subplots(rows, 2, figsize=(10.0, 1.5 * rows + 1.0), sharex=True, layout="constrained")
    single, across = _across(traced)
    for axis, panel in zip(axes.flat, panels, strict=False):
        _draw(axis, panel, across, traced.motion.direction)
    for axis in axes.flat[len(panels) :]:
        axis.set_visible(False)
    for axis in axes.flat[max(len(panels) - 2, 0) : len(panels)]:
        axis.set_xlabel("shaft angle [deg]" if single else "number of the reading")
        axis.tick_params(labelbottom=True)
    for column in axes.T:
        figure.align_ylabels(column)
    axes[0, 0].legend(fontsize=7, loc="center right")
    ways = [(colour, name) for sense, colour, name in _DIRECTIONS if np.any(traced.motion.direction == sense)]
    lines = [plt.Line2D([], [], color=colour, lw=1.5, label=name) for colour, name in ways]
    figure.legend(handles=lines, loc="outside lower center", ncols=2, frameon=False)
    figure.suptitle(title, fontsize=11)
    plt.close(figure)
    return figure


def _panels(traced: Trace) -> list[_Panel]:
    """The channels as converted, the error, and the change of the angle by each effect that changes it."""
    channels = [signal for signal in traced.signals if signal.unit == "1"][-1]
    panels = [
        _Panel("channels before the CORDIC", "nominal\namplitudes", dict(zip("xy", channels.values, strict=True))),
        _Panel("reading minus reference: all effects together", "deg", {"": traced.error_deg}),
    ]
    for signal in traced.signals:
        if np.max(np.abs(signal.moved_deg)) > _NOTHING_DEG:
            name = "magnet" if signal.name == CONVERSIONS["after field"] else signal.name
            panels.append(_Panel(f"angle changed by {name}", "deg", {"": signal.moved_deg}))
    return panels


def _across(traced: Trace) -> tuple[bool, Array]:
    """Whether the shaft went through one turn in one direction, and the abscissa: its angle [deg] or the readings."""
    shaft = traced.motion.shaft_rad
    single = bool(traced.motion.turns <= 1.0 and np.all(np.diff(shaft) > 0))
    return single, np.asarray(shaft * 360.0 / TAU if single else np.arange(1.0, len(traced.motion) + 1.0))


def _draw(axis: Any, panel: _Panel, across: Array, way: Array) -> None:
    """The curves of a panel, those of the two directions of travel in colours of their own."""
    for dashes, (label, values) in zip(("-", "--"), panel.curves.items(), strict=False):
        for sense, colour, _ in _DIRECTIONS:
            if np.any(way == sense):
                axis.plot(across, np.where(way == sense, values, np.nan), dashes, color=colour, lw=0.9)
        if label:
            axis.plot([], [], dashes, color="0.2", lw=0.9, label=label)
        if np.ptp(values) < _NOTHING_DEG:
            # One value all along: its digits beyond those of a figure are rounding.
            axis.set_ylim(*sorted((0.5 * values[0], 1.5 * values[0])))
    axis.set_title(panel.title, fontsize=8)
    axis.set_ylabel(f"[{panel.unit}]", fontsize=8)
    axis.tick_params(labelsize=7)
    axis.ticklabel_format(axis="y", useOffset=False)
    axis.grid(alpha=0.3)
