"""The factors of diagnosed sweeps as plain values: the JSON of ``halltwin diagnose`` (schema halltwin.diagnose/1)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from diagnosis.error_model.model import NAMES
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.air_gaps import AirGaps, laws
from diagnosis.factors.findings import Findings, one_sense
from diagnosis.report import temperature_answer
from diagnosis.report.gap_answer import gap_answer
from diagnosis.report.how_read import how_read
from diagnosis.report.provenance import Provenance
from diagnosis.report.row_counts import counts_of
from diagnosis.thermal.over_temperature import OverTemperature
from twin.baseline import FACTORS

SCHEMA = "halltwin.diagnose/1"


def to_json(
    found: Sequence[Findings], over_gaps: AirGaps | None, thermal: OverTemperature | None, made: Provenance
) -> dict[str, Any]:
    """The answer to one or many sweeps, with what their air gaps tell together, and their temperatures."""
    return {
        "schema": SCHEMA,
        **made.to_dict(),
        "sweeps": [one_sweep(item) for item in found],
        "air_gaps": [] if over_gaps is None else [dict(vars(law)) for law in laws(over_gaps)],
        "air_gap_fit": None if over_gaps is None else gap_answer(over_gaps),
        "temperature": None if thermal is None else _over_temperature(thermal, found),
    }


def _over_temperature(thermal: OverTemperature, found: Sequence[Findings]) -> dict[str, Any]:
    return temperature_answer.to_dict(thermal, sweeps=len(found), decided_by=one_sense(found).by)


def one_sweep(found: Findings) -> dict[str, Any]:
    """One sweep's factors; an infinite limit is null."""
    fit = found.fit
    answer: dict[str, Any] = {
        "sweep": found.sweep.name,
        **counts_of(found.sweep, found.glitch_rows),
        **how_read(found.sweep),
        "parameters": parameters(found),
        "senses": {
            "sensor": fit.senses.sensor,
            "output": fit.senses.output,
            "decided": found.mirror.decided,
            "sigma": _finite(fit.senses.sigma),
            "decided_by": found.mirror.by,
            "log_odds": found.mirror.log_odds,
        },
        "mirror_solution": _mirror_solution(found),
        "rms_deg": _degrees(fit.rms_rad),
        "steps": _steps(found),
        "search": {
            "by": "swarm" if fit.search.rounds else "descents",
            "rounds": fit.search.rounds,
            "widened": [FACTORS[NAMES.index(n)].name for n in fit.search.widened],
        },
        "correlations": [[_finite(v) for v in row] for row in found.identifiability.correlations],
        "covered_deg": found.identifiability.covered_deg,
        "mechanical": dict(vars(found.mechanical)),
        "sentences": list(found.sentences),
    }
    if found.band is not None:
        answer["band"] = dict(vars(found.band))
    if found.added is not None:
        curve = found.added.curve
        answer["channels"] = {
            **{name: float(curve.values[k]) for k, name in enumerate(("Vx", "Vy", "Ax", "Ay"))},
            "beyond_order_1_deg": found.added.beyond_order_1_deg,
            "beyond_order_2_deg": found.added.beyond_order_2_deg,
        }
    return answer


def _mirror_solution(found: Findings) -> dict[str, Any] | None:
    """The other solution where it fits as well: its senses, factors and meaning; None where there is none."""
    other = found.mirror.other
    if other is None:
        return None
    return {
        "sensor": other.senses.sensor,
        "output": other.senses.output,
        "rms_deg": _degrees(other.rms_rad),
        "parameters": _six(other),
        "mechanical": vars(found.mirror_mechanical) | {},
    }


def parameters(found: Findings) -> dict[str, dict[str, Any]]:
    """The six parameters with their 95 % intervals, and the profile's limits where the interval is not symmetric."""
    answer = _six(found.fit)
    for profile in found.identifiability.profiles:
        k = NAMES.index(profile.name)
        answer[FACTORS[k].name]["profile"] = [_finite(_scale(k) * profile.low), _finite(_scale(k) * profile.high)]
    return answer


def _six(fit: BaselineFit) -> dict[str, dict[str, Any]]:
    """The six parameters of a fit with their 95 % intervals."""
    return {
        factor.name: {
            "value": _finite(_scale(k) * fit.point[k]),
            "low": _finite(_scale(k) * fit.low[k]),
            "high": _finite(_scale(k) * fit.high[k]),
            "unit": factor.unit,
            "at_bound": bool(fit.at_bound[k]),
        }
        for k, factor in enumerate(FACTORS)
    }


def _steps(found: Findings) -> dict[str, Any]:
    """What each step of the fit has brought."""
    steps = found.fit.contributions
    return {
        "zero_only_rms_deg": _degrees(steps.zero_only_rms_rad),
        "swarm_rms_deg": None if steps.swarm_rms_rad is None else _degrees(steps.swarm_rms_rad),
        "descents_rms_deg": None if steps.descents_rms_rad is None else _degrees(steps.descents_rms_rad),
        "polished_rms_deg": _degrees(steps.polished_rms_rad),
        "particles_evaluated": steps.particles_evaluated,
        "passes": steps.passes,
        "settled": found.fit.settled,
    }


def _scale(place: int) -> float:
    """What the parameter at this place is multiplied by for the unit of the answer."""
    return FACTORS[place].per_coordinate * FACTORS[place].scale


def _degrees(value_rad: float) -> float:
    return float(np.degrees(value_rad))


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
