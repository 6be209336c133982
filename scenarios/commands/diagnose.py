"""halltwin diagnose: the paper's error factors of one or many sweeps, with what each figure is worth."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis import Findings, diagnose_many
from diagnosis.error_model.model import BETA, NAMES, ZERO
from diagnosis.factors.air_gaps import GapSweep, Law, laws, sentences
from scenarios.commands.inputs import sweep_paths
from twin.sweep import Sweep
from twin.sweep_file import write_beside

SCHEMA = "halltwin.diagnose/1"
PUBLIC = ("Vx_over_Ax", "Vy_over_Ay", "gain_ratio", "beta_deg", "quad", "zero_deg")
_IN_DEGREES = (BETA, ZERO)
_ROWS = (
    ("offset x", 0, 100.0, "% of amplitude", 4),
    ("offset y", 1, 100.0, "% of amplitude", 4),
    ("gain ratio", 2, 1.0, "", 6),
    ("phase", 3, 180.0 / np.pi, "deg", 4),
    ("quadratic", 4, 100.0, "% of amplitude", 4),
    ("zero", 5, 180.0 / np.pi, "deg", 4),
)


def run(
    names: Sequence[str],
    *,
    json_path: Path | None = None,
    plot: Path | None = None,
    convergence: Path | None = None,
    seed: int = 0,
) -> None:
    """Diagnose what the names stand for; print a table; write JSON and pictures where asked."""
    sweeps = [Sweep.read(path) for path in sweep_paths(names)]
    found = diagnose_many(sweeps, rng=np.random.default_rng(seed))
    over_gaps = gap_laws(found)
    for line in one_sweep(found[0]) if len(found) == 1 else many_sweeps(found):
        print(line)
    for sentence in sentences(over_gaps):
        print(f"- {sentence}")
    if json_path is not None:
        content = {"schema": SCHEMA, "sweeps": [to_dict(item) for item in found], "air_gaps": _gap_dicts(over_gaps)}
        write_beside(json_path, (json.dumps(content, indent=1, allow_nan=False) + "\n").encode())
        print(f"wrote {json_path}")
    if plot is not None or convergence is not None:
        from diagnosis.report.diagnose_plot import plot_convergence, plot_fits

        if plot is not None:
            plot_fits(plot, found)
            print(f"wrote {plot}")
        if convergence is not None:
            plot_convergence(convergence, found)
            print(f"wrote {convergence}")


def gap_laws(found: Sequence[Findings]) -> tuple[Law, ...]:
    """How the factors follow the field, where all sweeps hold raw channels of different amplitude."""
    curves = [item.added.curve for item in found if item.added is not None]
    if len(curves) < len(found):
        return ()
    return laws([GapSweep(f.fit.point, f.fit.covariance, c.amplitude) for f, c in zip(found, curves, strict=True)])


def one_sweep(found: Findings) -> list[str]:
    """The answer for one sweep, line by line."""
    fit, sweep = found.fit, found.sweep
    left_out = f"; {len(found.glitch_rows)} left out as gross errors" if found.glitch_rows else ""
    rejected = f", {len(sweep.rejected)} rejected" if sweep.rejected else ""
    contributed = fit.contributions
    lines = [
        f"{sweep.name}   {sweep.rows} readings{rejected}{left_out}",
        "",
        f"{'':12} {'value':>12}   95 % interval",
    ]
    for label, k, scale, unit, digits in _ROWS:
        low, high = scale * fit.low[k], scale * fit.high[k]
        bound = "   at the model's limit" if fit.at_bound[k] else ""
        lines.append(
            f"{label:12} {scale * fit.point[k]:12.{digits}f}   {low:.{digits}f} .. {high:.{digits}f} {unit}{bound}"
        )
    for profile in found.identifiability.profiles:
        label, _, scale, unit, digits = _ROWS[NAMES.index(profile.name)]
        low, high = scale * profile.low, scale * profile.high
        lines.append(f"{'  profile':12} {label:>12}   {low:.{digits}f} .. {high:.{digits}f} {unit}")
    lines += [
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
    return lines


def many_sweeps(found: Sequence[Findings]) -> list[str]:
    """One line a sweep."""
    width = max(len(item.sweep.name) for item in found)
    lines = [
        f"{'sweep':{width}} {'rows':>7} {'Vx/Ax %':>9} {'Vy/Ay %':>9} {'gain':>9} {'beta deg':>9} {'quad %':>9} "
        f"{'RMS deg':>8} {'before':>8}"
    ]
    for item in found:
        cells = " ".join(f"{scale * item.fit.point[k]:9.4f}" for _, k, scale, _, _ in _ROWS[:5])
        fit = item.fit
        lines.append(
            f"{item.sweep.name:{width}} {item.sweep.rows:7d} {cells} {np.degrees(fit.rms_rad):8.4f} "
            f"{np.degrees(fit.contributions.zero_only_rms_rad):8.4f}"
        )
    return lines


def to_dict(found: Findings) -> dict[str, Any]:
    """One sweep's answer as plain values; an infinite limit is null."""
    fit = found.fit
    parameters: dict[str, dict[str, Any]] = {
        name: {
            "value": _finite(scale * fit.point[k]),
            "low": _finite(scale * fit.low[k]),
            "high": _finite(scale * fit.high[k]),
            "unit": "deg" if k in _IN_DEGREES else "1",
            "at_bound": bool(fit.at_bound[k]),
        }
        for k, name in enumerate(PUBLIC)
        for scale in (180.0 / np.pi if k in _IN_DEGREES else 1.0,)
    }
    for profile in found.identifiability.profiles:
        k = NAMES.index(profile.name)
        scale = 180.0 / np.pi if k in _IN_DEGREES else 1.0
        parameters[PUBLIC[k]]["profile"] = [_finite(scale * profile.low), _finite(scale * profile.high)]
    steps = fit.contributions
    answer: dict[str, Any] = {
        "sweep": found.sweep.name,
        "rows": found.sweep.rows,
        "rejected": len(found.sweep.rejected),
        "glitch_rows": list(found.glitch_rows),
        "parameters": parameters,
        "senses": {
            "sensor": fit.senses.sensor,
            "output": fit.senses.output,
            "decided": fit.senses.matters,
            "sigma": _finite(fit.senses.sigma),
        },
        "rms_deg": _degrees(fit.rms_rad),
        "steps": {
            "zero_only_rms_deg": _degrees(steps.zero_only_rms_rad),
            "swarm_rms_deg": _degrees(steps.swarm_rms_rad),
            "polished_rms_deg": _degrees(steps.polished_rms_rad),
            "particles_evaluated": steps.particles_evaluated,
            "passes": steps.passes,
            "settled": fit.settled,
        },
        "search": {"rounds": fit.search.rounds, "widened": [PUBLIC[NAMES.index(n)] for n in fit.search.widened]},
        "correlations": [[_finite(v) for v in row] for row in found.identifiability.correlations],
        "covered_deg": found.identifiability.covered_deg,
        "mechanical": vars(found.mechanical),
        "sentences": list(found.sentences),
    }
    if found.added is not None:
        curve = found.added.curve
        answer["channels"] = {
            **{name: float(curve.values[k]) for k, name in enumerate(("Vx", "Vy", "Ax", "Ay"))},
            "beyond_order_1_deg": found.added.beyond_order_1_deg,
            "beyond_order_2_deg": found.added.beyond_order_2_deg,
        }
    return answer


def _gap_dicts(over_gaps: tuple[Law, ...]) -> list[dict[str, Any]]:
    return [vars(law) for law in over_gaps]


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


def _degrees(value_rad: float) -> float:
    return float(np.degrees(value_rad))


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
