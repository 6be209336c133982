"""The error over the turn before and after the correction, like the paper's Fig. 16."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from diagnosis.correction.cross_validation import BeforeAfter
from diagnosis.report.plotting import style
from diagnosis.report.wording import rms_shown
from twin.angles import Array
from twin.sweep import Sweep

_BEFORE, _AFTER = "#cc3311", "#4477aa"


def before_after_figure(judged: Sequence[tuple[str, BeforeAfter, Sweep]]) -> Any:
    """One panel a tested sweep, on readings that the correction never saw."""
    plt = style()
    figure, axes = plt.subplots(
        len(judged), 1, figsize=(7.0, max(3.2 * len(judged), 3.8)), squeeze=False, layout="constrained"
    )
    for axis, (name, found, sweep) in zip(axes[:, 0], judged, strict=True):
        shaft = np.remainder(sweep.reference_deg, 360.0)
        before, after = np.degrees(found.before_rad), np.degrees(found.after_rad)
        way = sweep.motion().direction
        for errors, colour, when in ((before, _BEFORE, "before"), (after, _AFTER, "after")):
            _draw(axis, shaft, errors, way, colour=colour, name=when)
        rms, rms_after = (rms_shown(value, shaft.size) for value in found.rms_deg)
        words = name if sweep.name in name else f"{sweep.name}, {name}"
        axis.set_title(f"{words}: RMS {rms} to {rms_after} deg", fontsize=9)
        axis.set(xlim=(0, 360), xticks=range(0, 361, 90), xlabel="shaft angle [deg]", ylabel="angle error [deg]")
        axis.grid(alpha=0.25)
    handles = {label: mark for axis in axes.flat for mark, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(
        list(handles.values()), list(handles), loc="outside lower center", ncols=4, frameon=False, markerscale=2.0
    )
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
