"""The picture of the closed loop, after the paper's Fig. 16: the error over the turn before and after."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from scenarios.bench.closed_loop import AIM_DEG, Loop
from scenarios.bench.readings import Reading
from twin.angles import Array

_BEFORE, _AFTER = "#cc3311", "#4477aa"


def loop_figure(loop: Loop) -> Any:
    """Both errors on one scale, and the one that is left on a scale of its own."""
    plt = style()
    figure, (both, left) = plt.subplots(2, 1, figsize=(7.0, 6.0), sharex=True, layout="constrained")
    before, after = loop.before.pretreated.kept, loop.after.pretreated.kept
    _draw(both, before, loop.before_deg, _BEFORE, "before")
    _draw(both, after, loop.after_deg, _AFTER, "after")
    _draw(left, after, loop.after_deg, _AFTER, "after")
    for axis in (both, left):
        axis.axhline(AIM_DEG, color="0.4", lw=0.8, ls="--", label=f"{AIM_DEG:g} deg (paper, Fig. 16)")
        axis.axhline(-AIM_DEG, color="0.4", lw=0.8, ls="--")
        axis.set(xlim=(0, 360), xticks=range(0, 361, 45), ylabel="angle error [deg]")
        axis.grid(alpha=0.25)
    left.set_xlabel("shaft angle [deg]")
    causes = ", ".join(cause["name"] for cause in loop.answer["causes"]) or "none"
    peaks = [float(np.max(np.abs(errors))) for errors in (loop.before_deg, loop.after_deg)]
    both.set_title(f"largest error {peaks[0]:.3f} to {peaks[1]:.3f} deg; causes named: {causes}", fontsize=9)
    figure.legend(*both.get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False, fontsize=8)
    plt.close(figure)
    return figure


def _draw(axis: object, readings: tuple[Reading, ...], errors: Array, colour: str, name: str) -> None:
    """The readings of each direction; on the way back as open circles."""
    angle = np.array([one.reference_deg for one in readings])
    way = np.array([one.direction for one in readings])
    for sense, words in ((1, ""), (-1, ", back")):
        rows = way == sense
        if rows.any():
            face = {"markerfacecolor": colour if sense > 0 else "none", "markeredgewidth": 0.5}
            axis.plot(angle[rows], errors[rows], "o", ms=2.2, color=colour, label=name + words, **face)  # type: ignore[attr-defined]
