"""Recovery maps over noise and points per turn: the baseline against its bound, and the power for each cause."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from scenarios.studies.recovery.cells import BASELINE, CLEAN
from twin.angles import Array

Entry = dict[str, Any]


def map_figures(found: list[Entry]) -> dict[str, Any]:
    """The maps ``baseline`` and ``causes``, where the study holds cells for them; averages over what else is varied."""
    maps = {}
    baseline = [entry for entry in found if entry["cause"] == BASELINE]
    if baseline:
        shown: list[tuple[str, list[Entry], Callable[[Entry], float], tuple[float, float], str]] = [
            ("RMS over the Cramér–Rao bound, six parameters", baseline, _ratio, (0.8, 1.2), "coolwarm"),
            ("share of 95 % intervals that hold the truth", baseline, _coverage, (0.85, 1.0), "viridis"),
        ]
        maps["baseline"] = _figure(shown, "Error factors recovered", 2)
    causes = list(dict.fromkeys(entry["cause"] for entry in found if entry["cause"] not in (BASELINE, CLEAN)))
    clean = [entry for entry in found if entry["cause"] == CLEAN]
    shown = [
        (
            name,
            [entry for entry in found if entry["cause"] == name],
            lambda entry: entry["named"],
            (0.0, 1.0),
            "viridis",
        )
        for name in causes
    ]
    if clean:
        shown.append(("nothing hidden: false alarms", clean, lambda entry: entry["false_alarms"], (0.0, 1.0), "Reds"))
    if shown:
        maps["causes"] = _figure(shown, "Share of sweeps whose hidden cause is named", 4)
    return maps


def _ratio(entry: Entry) -> float:
    return float(np.sqrt(np.mean([p["rms_over_bound"] ** 2 for p in entry["parameters"].values()])))


def _coverage(entry: Entry) -> float:
    return float(np.mean([p["coverage"] for p in entry["parameters"].values()]))


def _figure(shown: list[Any], title: str, across: int) -> Any:
    plt = style()
    columns = min(across, len(shown))
    rows = -(-len(shown) // columns)
    figure, panels = plt.subplots(
        rows, columns, figsize=(2.9 * columns + 0.8, 2.7 * rows + 0.5), layout="constrained", squeeze=False
    )
    for panel, (name, entries, value, limits, colours) in zip(panels.flat, shown, strict=False):
        noises = sorted({entry["noise_deg"] for entry in entries})
        points = sorted({entry["points"] for entry in entries})
        grid = np.array([[_cell(entries, noise, count, value) for count in points] for noise in noises])
        drawn = panel.imshow(grid, origin="lower", vmin=limits[0], vmax=limits[1], cmap=colours, aspect="auto")
        for (row, column), number in np.ndenumerate(grid):
            # The paler half of the colour map takes dark figures.
            luminance = float(np.dot(drawn.cmap(drawn.norm(number))[:3], (0.3, 0.59, 0.11)))
            colour = "black" if luminance > 0.5 else "white"
            panel.text(column, row, f"{number:.2f}", ha="center", va="center", color=colour)
        panel.set_xticks(range(len(points)), [str(count) for count in points])
        panel.set_yticks(range(len(noises)), [f"{noise:g}" for noise in noises])
        panel.set_title(name, fontsize=9)
    for panel in panels.flat[len(shown) :]:
        panel.set_axis_off()
    figure.supxlabel("readings a turn", fontsize=9)
    figure.supylabel("noise (deg RMS)", fontsize=9)
    figure.suptitle(title, fontsize=10)
    plt.close(figure)
    return figure


def _cell(entries: list[Entry], noise: float, points: int, value: Callable[[Entry], float]) -> float:
    here: Array = np.array([value(e) for e in entries if e["noise_deg"] == noise and e["points"] == points])
    return float(here.mean()) if here.size else float("nan")
