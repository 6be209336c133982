"""The picture of the least non-linear distance: the error of the best magnet by cause, and of all magnets listed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from diagnosis.report.plotting import style
from scenarios.studies.design.distance import Distance

_MOST = 6
"""Magnets that a panel holds."""


def distance_figure(found: Sequence[Distance]) -> Any:
    """Two panels over the air gap: the first magnet's error by cause, and each magnet's error with its least marked."""
    plt = style()
    figure, panels = plt.subplots(1, 2, figsize=(10.5, 4.8), layout="constrained")
    first = found[0]
    panels[0].plot(first.air_gap_mm, first.error_deg, color="black", linewidth=2.0, label="all together")
    for name, error in first.causes_deg.items():
        panels[0].plot(first.air_gap_mm, error, linewidth=1.1, label=name)
    _mark(panels[0], first, "black", mark="*", size=12.0)
    panels[0].set(title=f"{first.name}; star: least non-linear distance", ylabel="largest error over a turn [deg]")
    for one in found[:_MOST]:
        (line,) = panels[1].plot(one.air_gap_mm, one.error_deg, label=_label(one))
        # Stars of magnets that are alike would lie on one another; strokes stand side by side.
        _mark(panels[1], one, line.get_color(), mark="|", size=22.0)
    panels[1].set(title="magnets of the best designs; stroke: least non-linear distance")
    panels[0].set(ylim=(0.0, None))
    panels[1].margins(y=0.1)
    for panel in panels:
        panel.set(xlabel="air gap [mm]")
        panel.title.set_fontsize(9)
        panel.grid(alpha=0.3)
        panel.legend(fontsize=7)
    figure.suptitle("Errors that depend on the field, at 25 °C, sensor and magnet on the axis", fontsize=10)
    plt.close(figure)
    return figure


def _mark(panel: Any, one: Distance, colour: str, *, mark: str, size: float) -> None:
    place = one.air_gap_mm[one.least], one.error_deg[one.least]
    panel.plot(*place, mark, ms=size, mfc="white", mec=colour, mew=1.6, zorder=5)


def _label(one: Distance) -> str:
    return f"{one.name}: {one.air_gap_mm[one.least]:.2f} mm, {one.field_mT[one.least]:.0f} mT"
