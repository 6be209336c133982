"""The error over the turn before and after the correction, like the paper's Fig. 16."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from diagnosis.correction.cross_validation import BeforeAfter
from diagnosis.report.plotting import style
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
        axis.plot(shaft, before, ".", ms=3.0, color=_BEFORE, label="before", rasterized=shaft.size > 5000)
        axis.plot(shaft, after, ".", ms=3.0, color=_AFTER, label="after", rasterized=shaft.size > 5000)
        rms, rms_after = found.rms_deg
        words = name if sweep.name in name else f"{sweep.name}, {name}"
        axis.set_title(f"{words}: RMS {rms:.3f} to {rms_after:.3f} deg", fontsize=9)
        axis.set(xlim=(0, 360), xticks=range(0, 361, 90), xlabel="shaft angle [deg]", ylabel="angle error [deg]")
        axis.grid(alpha=0.25)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    plt.close(figure)
    return figure
