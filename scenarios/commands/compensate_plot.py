"""The error before and after the correction: over the turn like the paper's Fig. 16, and over temperature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from diagnosis.report.temperature_plot import draw_laws
from diagnosis.report.wording import rms_shown
from diagnosis.thermal.over_temperature import OverTemperature
from scenarios.commands.compensate_judge import Judged
from twin.angles import Array

_BEFORE, _AFTER = "#cc3311", "#4477aa"


def before_after_figure(judged: Sequence[Judged]) -> Any:
    """A row a tested sweep, on readings that the correction never saw: both errors, and what is left by itself."""
    plt = style()
    figure, axes = plt.subplots(
        len(judged), 2, figsize=(10.5, max(3.2 * len(judged), 3.8)), squeeze=False, layout="constrained", sharex=True
    )
    for (both, alone), one in zip(axes, judged, strict=True):
        found, shaft = one.found, np.remainder(np.degrees(one.tested.reference_rad), 360.0)
        before, after = np.degrees(found.before_rad), np.degrees(found.after_rad)
        way = one.tested.direction
        _draw(both, shaft, before, way, colour=_BEFORE, name="before")
        _draw(both, shaft, after, way, colour=_AFTER, name="after")
        _draw(alone, shaft, after, way, colour=_AFTER, name="after")
        rms, rms_after = (rms_shown(value, shaft.size) for value in found.rms_deg)
        said = f"{one.name}, own zero taken out" if one.own_zeros else one.name
        words = said if one.title in said else f"{one.title}, {said}"
        both.set_title(f"{words}: RMS {rms} to {rms_after} deg", fontsize=9)
        alone.set_title("after, on a scale of its own", fontsize=9)
        for axis in (both, alone):
            axis.set(xlim=(0, 360), xticks=range(0, 361, 90), xlabel="shaft angle [deg]", ylabel="angle error [deg]")
            axis.grid(alpha=0.25)
    handles = {label: mark for axis in axes.flat for mark, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(
        list(handles.values()), list(handles), loc="outside lower center", ncols=4, frameon=False, markerscale=2.0
    )
    plt.close(figure)
    return figure


def over_temperature_figure(judged: Sequence[Judged], laws: OverTemperature) -> Any:
    """The six factors with their laws; below them the error before and after over temperature."""
    plt = style()
    figure = plt.figure(figsize=(10.0, 8.4), layout="constrained")
    grid = figure.add_gridspec(3, 3)
    draw_laws([figure.add_subplot(grid[k // 3, k % 3]) for k in range(6)], laws)
    axis = figure.add_subplot(grid[2, :])
    marks = ((False, "o", "-", "readings held out"), (True, "D", "", "temperature held out"))
    for alone, mark, line, what in marks:
        shown = [one for one in judged if one.part and one.alone == alone]
        if not shown:
            continue
        at = [float(np.mean(one.tested.temperature_c)) for one in shown]
        for place, colour, when in ((0, _BEFORE, "before"), (1, _AFTER, "after")):
            rms = [one.found.rms_deg[place] for one in shown]
            face = "none" if alone else colour
            size = 8.0 if alone else 4.0
            axis.plot(at, rms, mark, ls=line, ms=size, color=colour, mfc=face, label=f"{when}, {what}")
    axis.axhline(np.degrees(laws.noise_rad), color="#777777", ls=":", lw=1.0, label="noise floor")
    axis.set(xlabel="temperature [C]", ylabel="angle error [deg RMS]", ylim=(0.0, None))
    axis.grid(alpha=0.25)
    handles, labels = axis.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False)
    plt.close(figure)
    return figure


def _draw(axis: Any, shaft: Array, errors: Array, way: Array, *, colour: str, name: str) -> None:
    """Errors (n,) [deg] over the shaft angle (n,) [deg]; those on the way back as open marks."""
    for sense, mark, words in ((1.0, "o", "forward"), (-1.0, "^", "backward")):
        rows = way == sense
        if rows.any():
            face = colour if sense > 0 else "none"
            looks = {"ms": 2.4, "color": colour, "mfc": face, "mew": 0.5, "rasterized": shaft.size > 5000}
            axis.plot(shaft[rows], errors[rows], mark, label=f"{name}, {words}", **looks)
