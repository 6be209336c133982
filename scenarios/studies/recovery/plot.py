"""Recovery maps over noise and points per turn: the baseline against its bound, and the power for each cause."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from diagnosis.report.plotting import style
from scenarios.studies.recovery.cells import BASELINE, CLEAN
from twin.angles import Array

Entry = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class _Panel:
    """One map: a figure of each cell, its colour bar, and what the sweeps of a cell are called."""

    title: str
    entries: list[Entry]
    value: Callable[[Entry], float]
    bar: str
    limits: tuple[float, float]
    colours: str


def map_figures(found: list[Entry]) -> dict[str, Any]:
    """The maps ``baseline`` and ``causes``, where the study holds cells for them; averages over what else is varied."""
    maps = {}
    baseline = [entry for entry in found if entry["cause"] == BASELINE]
    if baseline:
        ratio = _Panel(
            title="precision",
            entries=baseline,
            value=_ratio,
            bar="RMS error / Cramér–Rao bound",
            limits=(0.8, 1.2),
            colours="coolwarm",
        )
        coverage = _Panel(
            title="intervals",
            entries=baseline,
            value=_coverage,
            bar="share of 95 % intervals that hold the truth",
            limits=(0.85, 1.0),
            colours="viridis",
        )
        maps["baseline"] = _figure([ratio, coverage], "Six error factors recovered", 2)
    shown = [
        _Panel(
            title=name,
            entries=[entry for entry in found if entry["cause"] == name],
            value=lambda entry: float(entry["false_alarms"] if entry["cause"] == CLEAN else entry["named"]),
            bar="share with a false alarm" if name == CLEAN else "share in which it is named",
            limits=(0.0, 1.0),
            colours="Reds" if name == CLEAN else "viridis",
        )
        for name in dict.fromkeys(entry["cause"] for entry in found if entry["cause"] != BASELINE)
    ]
    if shown:
        maps["causes"] = _figure(shown, "What was hidden in the sweeps, and how often it is named", 3)
    return maps


def _ratio(entry: Entry) -> float:
    return float(np.sqrt(np.mean([p["rms_over_bound"] ** 2 for p in entry["parameters"].values()])))


def _coverage(entry: Entry) -> float:
    return float(np.mean([p["coverage"] for p in entry["parameters"].values()]))


def _figure(shown: list[_Panel], title: str, across: int) -> Any:
    plt = style()
    columns = min(across, len(shown))
    rows = -(-len(shown) // columns)
    figure, panels = plt.subplots(
        rows, columns, figsize=(3.4 * columns + 0.6, 3.0 * rows + 0.6), layout="constrained", squeeze=False
    )
    for panel, content in zip(panels.flat, shown, strict=False):
        _map(figure, panel, content)
    for panel in panels.flat[len(shown) :]:
        panel.set_axis_off()
    figure.supxlabel("readings a turn", fontsize=9)
    figure.supylabel("noise (deg RMS)", fontsize=9)
    figure.suptitle(title, fontsize=10)
    plt.close(figure)
    return figure


def _map(figure: Any, panel: Any, content: _Panel) -> None:
    """One map over noise and points, with the number of sweeps in a cell."""
    entries = content.entries
    noises = sorted({entry["noise_deg"] for entry in entries})
    points = sorted({entry["points"] for entry in entries})
    grid = np.array([[_cell(entries, noise, count, content.value) for count in points] for noise in noises])
    low, high = content.limits
    drawn = panel.imshow(grid, origin="lower", vmin=low, vmax=high, cmap=content.colours, aspect="auto")
    for (row, column), number in np.ndenumerate(grid):
        # The paler half of the colour map takes dark figures.
        luminance = float(np.dot(drawn.cmap(drawn.norm(number))[:3], (0.3, 0.59, 0.11)))
        colour = "black" if luminance > 0.5 else "white"
        panel.text(column, row, f"{number:.2f}", ha="center", va="center", color=colour)
    beyond = (bool(np.any(grid < low)), bool(np.any(grid > high)))
    extend = {(True, True): "both", (True, False): "min", (False, True): "max"}.get(beyond, "neither")
    figure.colorbar(drawn, ax=panel, label=content.bar, extend=extend)
    panel.set_xticks(range(len(points)), [str(count) for count in points])
    panel.set_yticks(range(len(noises)), [f"{noise:g}" for noise in noises])
    panel.set_title(f"{content.title}\n{_sweeps(entries)}", fontsize=9)


def _sweeps(entries: list[Entry]) -> str:
    """How many sweeps a cell of the map stands for, and over what they are averaged."""
    first = entries[0]
    together = [e for e in entries if (e["noise_deg"], e["points"]) == (first["noise_deg"], first["points"])]
    count = sum(entry["repeats"] for entry in together)
    turns, amplitudes = (sorted({entry[name] for entry in together}) for name in ("turns", "amplitude_deg"))
    said = (
        f"{count} sweep{'' if count == 1 else 's'} a cell, {_listed(turns)} turn{'' if turns == [1] else 's'} each way"
    )
    return said if amplitudes == [0.0] else f"{said}\namplitude {_listed(amplitudes)} deg"


def _listed(values: list[float]) -> str:
    return " and ".join(f"{value:g}" for value in values) if len(values) < 4 else f"{values[0]:g} to {values[-1]:g}"


def _cell(entries: list[Entry], noise: float, points: int, value: Callable[[Entry], float]) -> float:
    here: Array = np.array([value(e) for e in entries if e["noise_deg"] == noise and e["points"] == points])
    return float(here.mean()) if here.size else float("nan")
