"""The factors of diagnosed sweeps as a person reads them: what ``halltwin diagnose`` prints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from diagnosis.error_model.model import NAMES
from diagnosis.factors.air_gaps import Law, sentences
from diagnosis.factors.findings import Findings
from twin.baseline import FACTORS

_ROWS = (
    ("offset x", "% of amplitude", 4),
    ("offset y", "% of amplitude", 4),
    ("gain ratio", "", 6),
    ("phase", "deg", 4),
    ("quadratic", "% of amplitude", 4),
    ("zero", "deg", 4),
)
"""Label, unit and decimals of each parameter, in the order of the point and in the twin's units."""


def text(found: Sequence[Findings], over_gaps: Sequence[Law]) -> str:
    """The answer: all about a single sweep, one line each for many, and what the air gaps add."""
    lines = one_sweep(found[0]) if len(found) == 1 else many_sweeps(found)
    return "\n".join([*lines, *(f"- {sentence}" for sentence in sentences(tuple(over_gaps)))])


def one_sweep(found: Findings) -> list[str]:
    """The answer for one sweep, line by line."""
    fit, sweep = found.fit, found.sweep
    left_out = f"; {len(found.glitch_rows)} left out as gross errors" if found.glitch_rows else ""
    rejected = f", {len(sweep.rejected)} rejected" if sweep.rejected else ""
    contributed = fit.contributions
    return [
        f"{sweep.name}   {sweep.rows} readings{rejected}{left_out}",
        "",
        *_parameter_lines(found),
        "",
        f"error RMS    {_deg(contributed.zero_only_rms_rad)} with the zero alone, "
        f"{_deg(contributed.swarm_rms_rad)} after the swarm ({contributed.particles_evaluated} particles), "
        f"{_deg(fit.rms_rad)} after the polish",
        f"senses       s = {fit.senses.sensor:+d}, h = {fit.senses.output:+d}",
        f"range        {_range_words(found)}",
        "",
        *_mechanical_lines(found),
        "",
        *(f"- {sentence}" for sentence in found.sentences),
    ]


def _parameter_lines(found: Findings) -> list[str]:
    """The table of the six parameters, and the profiles' limits below it."""
    fit = found.fit
    lines = [f"{'':12} {'value':>12}   95 % interval"]
    for k, (label, unit, digits) in enumerate(_ROWS):
        scale = FACTORS[k].per_coordinate
        low, high = scale * fit.low[k], scale * fit.high[k]
        bound = "   at the model's limit" if fit.at_bound[k] else ""
        lines.append(
            f"{label:12} {scale * fit.point[k]:12.{digits}f}   {low:.{digits}f} .. {high:.{digits}f} {unit}{bound}"
        )
    for profile in found.identifiability.profiles:
        k = NAMES.index(profile.name)
        label, unit, digits = _ROWS[k]
        scale = FACTORS[k].per_coordinate
        low, high = scale * profile.low, scale * profile.high
        lines.append(f"{'  profile':12} {label:>12}   {low:.{digits}f} .. {high:.{digits}f} {unit}")
    return lines


def many_sweeps(found: Sequence[Findings]) -> list[str]:
    """One line a sweep."""
    width = max(len(item.sweep.name) for item in found)
    lines = [
        f"{'sweep':{width}} {'rows':>7} {'Vx/Ax %':>9} {'Vy/Ay %':>9} {'gain':>9} {'beta deg':>9} {'quad %':>9} "
        f"{'RMS deg':>8} {'before':>8}"
    ]
    for item in found:
        cells = " ".join(f"{factor.per_coordinate * item.fit.point[k]:9.4f}" for k, factor in enumerate(FACTORS[:5]))
        fit = item.fit
        lines.append(
            f"{item.sweep.name:{width}} {item.sweep.rows:7d} {cells} {np.degrees(fit.rms_rad):8.4f} "
            f"{np.degrees(fit.contributions.zero_only_rms_rad):8.4f}"
        )
    return lines


def _mechanical_lines(found: Findings) -> list[str]:
    equivalent = found.mechanical
    ways = []
    if equivalent.off_axis_mm is not None:
        towards = equivalent.off_axis_direction_deg
        ways.append(f"sensor {equivalent.off_axis_mm:.2f} mm off the axis towards {towards:.0f} deg or opposite")
    if equivalent.tilt_deg is not None:
        ways.append(f"sensor tilted {equivalent.tilt_deg:.1f} deg towards {equivalent.tilt_direction_deg:.0f} deg")
    same = " or ".join(ways) if ways else "no misalignment within the twin's range"
    return [
        f"would look the same: gain ratio and phase ({equivalent.order_2_deg:.3f} deg of order 2) = {same}",
        f"                     offset = stray field of {equivalent.stray_x_mT:.3f}, {equivalent.stray_y_mT:.3f} mT "
        f"beside a magnet of {equivalent.field_mT:.0f} mT",
    ]


def _range_words(found: Findings) -> str:
    search = found.fit.search
    if not search.widened:
        return "Table 2's"
    return f"wider than Table 2's in {', '.join(search.widened)} ({search.rounds} rounds)"


def _deg(value_rad: float) -> str:
    return f"{np.degrees(value_rad):.4f} deg"
