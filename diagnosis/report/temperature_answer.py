"""The laws of the factors over temperature as plain values, for the JSON of ``halltwin diagnose``."""

from __future__ import annotations

from typing import Any

import numpy as np

from diagnosis.factors.mirror import By
from diagnosis.thermal.laws import FROM_C, FactorLaw, Figure
from diagnosis.thermal.over_temperature import OverTemperature
from twin.angles import Array, wrap_deg
from twin.baseline import FACTORS, Factor

POWERS = ("per_K", "per_K2")
"""Names of the coefficients of T - 25 C and of its square."""


def to_dict(found: OverTemperature, *, sweeps: int, decided_by: By | None) -> dict[str, Any]:
    """The laws over the temperatures of so many sweeps of one sensor; what is not finite is None.

    ``decided_by``: who knows the senses in which the laws are told; None: the mirror solution fits as well.
    """
    sensor, output = found.model.senses
    return {
        "recordings": sweeps,
        "readings": len(found.model.recording),
        "gross_errors": int(np.count_nonzero(found.gross)),
        "low_c": found.model.span.low_c,
        "high_c": found.model.span.high_c,
        "levels_c": [float(level) for level in found.levels.temperature_c],
        "widest_gap_c": _widest_gap_c(found.model.recording.temperature_c),
        "highest_power": found.power,
        "from_c": FROM_C,
        "noise_floor_deg": float(np.degrees(found.noise_rad)),
        "own_zeros": found.own_zeros,
        "senses": {
            "sensor": sensor,
            "output": output,
            "decided": decided_by is not None,
            "decided_by": decided_by,
        },
        "factors": {
            factor.name: _law(factor, law, zero=place == len(FACTORS) - 1)
            for place, (factor, law) in enumerate(zip(FACTORS, found.factors, strict=True))
        },
    }


def _widest_gap_c(temperature_c: Array) -> list[float]:
    """The two temperatures [C] of readings (n,) that lie farthest apart with none between them."""
    ascending = np.sort(temperature_c)
    place = int(np.argmax(np.diff(ascending)))
    return [float(ascending[place]), float(ascending[place + 1])]


def _law(factor: Factor, law: FactorLaw, *, zero: bool) -> dict[str, Any]:
    at_25 = _figure(factor, law.at_25, "")
    if zero and at_25["value"] is not None:
        turns = float(wrap_deg(np.array(at_25["value"]))) - at_25["value"]
        at_25 |= {key: None if at_25[key] is None else at_25[key] + turns for key in ("value", "low", "high")}
    return {
        "verdict": law.verdict,
        "at_25": at_25,
        **{
            name: _figure(factor, figure, f"/{'K' if name == 'per_K' else 'K2'}")
            for name, figure in zip(POWERS, law.per_power, strict=False)
        },
        "drift_deg": float(np.degrees(law.drift_rad)),
        "drift_below_deg": _finite(float(np.degrees(law.drift_below_rad))),
        "constant_p": law.p_constant,
        "drifts_p": law.p_drifts,
        "scatters": law.scatters,
    }


def _figure(factor: Factor, figure: Figure, per: str) -> dict[str, Any]:
    shown = figure.times(factor.per_coordinate * factor.scale)
    unit = factor.unit + per
    return {"value": _finite(shown.value), "low": _finite(shown.low), "high": _finite(shown.high), "unit": unit}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
