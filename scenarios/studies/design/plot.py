"""The map of a design study: error and field over the magnet's size and its distance, what keeps the demand marked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from scenarios.studies.design.space import AXES
from scenarios.studies.design.study import Demand, DesignStudy, feasible, ranking
from twin.angles import Array, IntArray
from twin.effect import BoolArray

_DIAMETER, _HEIGHT, _GAP = 0, 1, 3
_KEEPS = "crimson"


def map_figure(found: Mapping[str, Array], study: DesignStudy) -> Any:
    """Two panels over diameter and air gap: error at 95 % of the mountings, and field at the sensor at 25 C."""
    plt = style()
    figure, panels = plt.subplots(1, 2, figsize=(9.6, 4.6), layout="constrained", sharex=True, sharey=True)
    shown = (
        (panels[0], "error_p95_deg", "error kept by 95 % of the mountings (deg)", "viridis_r"),
        (panels[1], "field_mT", "field at the sensor at 25 °C (mT)", "cividis"),
    )
    winner = int(ranking(found, study.demand)[0])
    best = found["design"][winner]
    # A star is for the taking; what keeps no demand is crossed out.
    mark = {"marker": "*" if feasible(found, study.demand)[winner] else "X", "ms": 13, "mfc": "white", "mec": "black"}
    for panel, name, label, colours in shown:
        _panel(figure, panel, found, study, name=name, label=label, colours=colours)
        panel.plot(best[_DIAMETER], best[_GAP], ls="", **mark, clip_on=False, zorder=5)
        panel.set_xlabel("diameter of the magnet (mm)")
    panels[0].set_ylabel("air gap (mm)")
    handles = [
        plt.Line2D([], [], color=_KEEPS, lw=2.2, label=_demand_in_words(found, study.demand)),
        plt.Line2D([], [], ls="", **mark, label=_in_words(best, winner, found, study)),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=1, frameon=False)
    if study.space.sampling == "grid" and (besides := _besides(study)):
        figure.suptitle(f"Each place shows the best over {besides}", fontsize=9)
    plt.close(figure)
    return figure


def _besides(study: DesignStudy) -> str:
    """What else is varied, in words."""
    axes = study.space.axes
    varied = [name for column, name in enumerate(AXES) if column not in (_DIAMETER, _GAP) and len(axes[name]) > 1]
    grades = ["grade"] if len(study.space.grades) > 1 else []
    return ", ".join([*grades, *(name.rpartition("_")[0].replace("_", " ") for name in varied)])


def _demand_in_words(found: Mapping[str, Array], demand: Demand) -> str:
    """What the outline stands for."""
    low, high = demand.window_mT
    cold, warm = demand.temperature_c
    keeps = "keeps" if feasible(found, demand).any() else "nowhere:"
    return (
        f"{keeps} error ≤ {demand.max_error_deg:g}° and {low:g} to {high:g} mT in {100 * demand.min_yield:g} % of the "
        f"mountings, {cold:g} to {warm:g} °C"
    )


def _in_words(design: Array, row: int, found: Mapping[str, Array], study: DesignStudy) -> str:
    """The design that the star stands for."""
    chosen = "best" if feasible(found, study.demand)[row] else "closest, which does not keep it"
    return (
        f"{chosen}: {study.space.grades[int(found['grade'][row])]}, {design[_DIAMETER]:.3g} mm across, "
        f"{design[_HEIGHT]:.3g} mm high, air gap {design[_GAP]:.3g} mm; error {found['error_p95_deg'][row]:.2g}°, "
        f"{found['field_mT'][row]:.0f} mT, yield {100 * found['yield'][row]:.3g} %"
    )


def _panel(
    figure: Any,
    panel: Any,
    found: Mapping[str, Array],
    study: DesignStudy,
    *,
    name: str,
    label: str,
    colours: str,
) -> None:
    """One figure ``name`` of all designs over diameter and air gap, those that keep the demand marked."""
    keeps = feasible(found, study.demand)
    diameter, gap = found["design"][:, _DIAMETER], found["design"][:, _GAP]
    across, along = np.unique(diameter), np.unique(gap)
    if study.space.sampling != "grid" or across.size < 2 or along.size < 2:
        drawn = panel.scatter(diameter, gap, c=found[name], cmap=colours, s=22)
        panel.scatter(diameter[keeps], gap[keeps], s=46, facecolors="none", edgecolors=_KEEPS)
        figure.colorbar(drawn, ax=panel, label=label)
        return
    # Where height, grade or placement are varied too, a cell shows the best of them.
    picked = _best_of_cells(found, study, np.searchsorted(along, gap), np.searchsorted(across, diameter))
    values = found[name][picked]
    drawn = panel.pcolormesh(across, along, values, cmap=colours, shading="nearest")
    figure.colorbar(drawn, ax=panel, label=label)
    lines = panel.contour(across, along, values, colors="black", linewidths=0.6, levels=6)
    panel.clabel(lines, fontsize=7, fmt="%g")
    _outline(panel, across, along, keeps[picked])


def _best_of_cells(found: Mapping[str, Array], study: DesignStudy, row: IntArray, column: IntArray) -> Any:
    picked = np.zeros((row.max() + 1, column.max() + 1), dtype=np.int64)
    for design in ranking(found, study.demand)[::-1]:
        picked[row[design], column[design]] = design
    return picked


def _outline(panel: Any, across: Array, along: Array, inside: BoolArray) -> None:
    """The border between cells that keep the demand and those that do not."""
    x, y = _edges(across), _edges(along)
    padded = np.pad(inside, 1)
    for row, column in np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1]):
        panel.plot(x[column : column + 2], [y[row]] * 2, color=_KEEPS, lw=2.2, clip_on=False)
    for row, column in np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1]):
        panel.plot([x[column]] * 2, y[row : row + 2], color=_KEEPS, lw=2.2, clip_on=False)


def _edges(centres: Array) -> Array:
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[1.5 * centres[0] - 0.5 * centres[1]], middle, [1.5 * centres[-1] - 0.5 * centres[-2]]])
