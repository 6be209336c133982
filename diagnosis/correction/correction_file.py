"""The content of a correction TOML: the numbers of a correction in degrees, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from diagnosis.correction.compensation import Correction, Drift
from diagnosis.thermal.laws import FROM_C

SCHEMA = "halltwin.correction/1"


def to_dict(correction: Correction) -> dict[str, Any]:
    """The content of a correction TOML, angles in degrees."""
    content: dict[str, Any] = {
        "schema": SCHEMA,
        "formula": "shaft = slope * m - zero_deg + sum(cosine_deg[k-1] cos(k m) + sine_deg[k-1] sin(k m))",
        "slope": correction.slope,
        "zero_deg": float(np.degrees(correction.zero_rad)),
        "cosine_deg": [float(v) for v in np.degrees(correction.series[0])],
        "sine_deg": [float(v) for v in np.degrees(correction.series[1])],
        "left_out": list(correction.left_out),
        "dropped_orders_at_most_deg": float(np.degrees(correction.tolerance_rad)),
    }
    if correction.drift is not None:
        content["drift"] = _drift_dict(correction.drift)
    return content


def _drift_dict(drift: Drift) -> dict[str, Any]:
    return {
        "formula": f"zero_deg, cosine_deg[k], sine_deg[k] are those at {FROM_C:g} C; to each is added the sum over "
        f"j = 1, 2, ... of entry j here times (T - {FROM_C:g})^j, T in C and kept within low_c and high_c",
        "low_c": drift.low_c,
        "high_c": drift.high_c,
        "zero_deg": [float(v) for v in np.degrees(drift.zero_rad)],
        "cosine_deg": [[float(v) for v in row] for row in np.degrees(drift.series[:, 0])],
        "sine_deg": [[float(v) for v in row] for row in np.degrees(drift.series[:, 1])],
    }


def from_dict(content: Mapping[str, Any]) -> Correction:
    """The correction of a TOML's content."""
    drift = content.get("drift")
    return Correction(
        slope=int(content["slope"]),
        zero_rad=float(np.radians(content["zero_deg"])),
        series=np.radians(np.array([content["cosine_deg"], content["sine_deg"]], dtype=np.float64).reshape(2, -1)),
        left_out=tuple(content.get("left_out", ())),
        tolerance_rad=float(np.radians(content.get("dropped_orders_at_most_deg", 0.0))),
        drift=None if drift is None else _drift_of(drift),
    )


def _drift_of(content: Mapping[str, Any]) -> Drift:
    zero = np.radians(np.array(content["zero_deg"], dtype=np.float64))
    waves = [np.array(content[name], dtype=np.float64).reshape(zero.size, -1) for name in ("cosine_deg", "sine_deg")]
    return Drift(float(content["low_c"]), float(content["high_c"]), zero, np.radians(np.stack(waves, axis=1)))
