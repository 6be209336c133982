"""Pictures of the factors over temperature: the law of each with its interval, and its value at each temperature."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from diagnosis.error_model.fit import fit_baseline
from diagnosis.report.plotting import drawing
from diagnosis.thermal.over_temperature import OverTemperature
from twin.angles import Array, wrap
from twin.baseline import FACTORS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = {"sensitive": "#cc3311", "immune": "#4477aa", "not told": "#777777"}
_POINTS = 101


def laws_figure(found: OverTemperature) -> Figure:
    """The six factors over temperature. Raises UserError without matplotlib."""
    with drawing() as new_figure:
        figure = new_figure(figsize=(10.0, 5.6), layout="constrained")
        draw_laws(figure.subplots(2, 3).flat, found)
    return figure


def draw_laws(axes: Any, found: OverTemperature) -> None:
    """One panel a factor, on six axes: its law with 95 % interval, and what each temperature by itself gives."""
    span = found.model.span
    temperature = np.linspace(span.low_c, span.high_c, _POINTS)
    points, halves = _by_level(found)
    for k, (axis, factor, law) in enumerate(zip(axes, FACTORS, found.factors, strict=True)):
        scale, colour = factor.per_coordinate, COLOURS[law.verdict]
        value, half = found.band(k, temperature)
        middle, around = scale * value, scale * half
        turns = scale * (wrap(value[0]) - value[0]) if factor.name == "zero_deg" else 0.0
        axis.fill_between(temperature, middle - around + turns, middle + around + turns, color=colour, alpha=0.2, lw=0)
        axis.plot(temperature, middle + turns, color=colour, lw=1.4)
        each = scale * (value[0] + wrap(points[:, k] - value[0])) if factor.name == "zero_deg" else scale * points[:, k]
        axis.errorbar(
            found.levels.temperature_c, each + turns, scale * halves[:, k], fmt="o", ms=3.5, lw=1.0, color="#222222"
        )
        unit = f" [{factor.shown_unit}]" if factor.shown_unit else ""
        axis.set_title(f"{factor.label}: {law.verdict}", fontsize=9, color=colour)
        axis.set(xlabel="temperature [C]", ylabel=f"{factor.label}{unit or ' [1]'}")
        axis.ticklabel_format(useOffset=False)
        axis.grid(alpha=0.25)


def _by_level(found: OverTemperature) -> tuple[Array, Array]:
    """Point (levels, 6) and half of its 95 % interval by the readings of each temperature alone."""
    recording, rng = found.model.recording, np.random.default_rng(0)
    fits = []
    for k in range(len(found.levels)):
        part = recording.part(found.levels.of_reading == k)
        fits.append(fit_baseline(part.reference_rad, part.measured_rad, rng=rng, senses=found.model.senses))
    return np.stack([fit.point for fit in fits]), np.stack([0.5 * (fit.high - fit.low) for fit in fits])
