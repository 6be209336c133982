"""The picture of an explained sweep: the error as measured, what the baseline leaves, what the extended twin leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.discovery.marks.row_masks import raw_residual
from diagnosis.discovery.result import Discovery
from diagnosis.report.change_words import change_name
from diagnosis.report.facts import angle_error_deg, as_sent_deg
from diagnosis.report.fitted_rows import fitted
from diagnosis.report.plotting import DIRECTIONS, drawing
from twin.angles import Array
from twin.effect import BoolArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MOST_ROWS = 6
"""Recordings that are drawn below each other; of more the first ones."""


def residual_figure(found: Discovery) -> Figure:
    """Three panels over the reference's angle [deg], directions apart; of several recordings a row each.

    Of the readings that the fits were made of; how many are not drawn stands above.
    Raises UserError without matplotlib.
    """
    sweep, kept = found.sweep, fitted(found)
    angle, way = np.mod(sweep.reference_deg, 360.0), sweep.motion().direction
    error_deg = angle_error_deg(found.baseline, sweep)
    start = "error model" if found.given is None else "given twin"
    sent = as_sent_deg(found)
    first = "as measured" if sent is None else f"decoded (as sent: {np.std(sent[kept]):.3g} deg RMS)"
    columns = (
        (first, error_deg - np.mean(error_deg[kept])),
        (f"left by the {start}", np.degrees(raw_residual(found.baseline, sweep))),
        ("left by the extended twin", np.degrees(raw_residual(found.fit, sweep))),
    )
    rows = _rows(found, kept)
    drawn = np.any([mask for _, mask in rows], axis=0)
    with drawing() as new_figure:
        figure = new_figure(figsize=(10.0, 3.4 if len(rows) == 1 else 0.8 + 2.4 * len(rows)), layout="constrained")
        axes = figure.subplots(len(rows), len(columns), sharex=True, sharey="col", squeeze=False)
        for row, (name, mask) in zip(axes, rows, strict=True):
            for axis, (title, values) in zip(row, columns, strict=True):
                _panel(axis, angle[mask], way[mask], values[mask], title)
            row[0].set_ylabel(f"{name}\nangle error [deg]" if name else "angle error [deg]")
        for axis in axes[-1]:
            axis.set_xlabel("reference angle [deg]" if sweep.estimated is None else "estimated shaft angle [deg]")
        limit = 1.1 * max(float(np.max(np.abs(values[drawn]))) for _, values in columns[1:])
        for axis in axes[0, 1:]:
            axis.set_ylim(-limit, limit)
        axes[0, 0].legend(loc="best", markerscale=2.5)
        changed = [change_name({"parameter": change.name}) for change in found.changed]
        named = ", ".join([*changed, *(cause.name for cause in found.causes)]) or "no cause"
        apart = int(np.count_nonzero(~drawn))
        figure.suptitle(f"{sweep.name}: {named}" + (f"; {apart} readings not drawn" if apart else ""), fontsize=10)
    return figure


def _rows(found: Discovery, kept: BoolArray) -> list[tuple[str, BoolArray]]:
    """Name of each recording and its readings (n,) that are drawn; a single sweep's without a name."""
    recordings = found.sweep.recordings
    if recordings is None:
        return [("", kept)]
    return [(setup.name, kept & (recordings.number == k)) for k, setup in enumerate(recordings.setups[:MOST_ROWS])]


def _panel(axis: Any, angle: Array, way: Array, values: Array, title: str) -> None:
    """Values (n,) [deg] over the angle (n,) [deg], the two directions in colours of their own."""
    for sense, colour, mark, label in DIRECTIONS:
        if np.any(way == sense):
            drawn = {"ms": 2.4, "mew": 0.6, "color": colour, "alpha": 0.7}
            axis.plot(angle[way == sense], values[way == sense], mark, label=label, **drawn)
    axis.set_title(f"{title}:\n{np.sqrt(np.mean(values**2)):.3g} deg RMS", fontsize=9)
    axis.set_xticks(range(0, 361, 90))
    axis.grid(alpha=0.3)
