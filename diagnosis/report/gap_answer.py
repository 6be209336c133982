"""The joint fit of several air gaps as plain values: ``air_gap_fit`` in the JSON of ``halltwin diagnose``."""

from __future__ import annotations

from typing import Any

from diagnosis.factors.air_gaps import AirGaps
from diagnosis.factors.displacement import Displacement, upright_product
from diagnosis.factors.gap_fit import GapFit
from diagnosis.factors.gap_model import ROWS
from diagnosis.factors.gap_words import farthest, sentences
from twin.baseline import FACTORS


def gap_answer(found: AirGaps) -> dict[str, Any]:
    """What the gaps tell; causes are named only where something fits."""
    best = found.told
    return {
        "magnet": found.mounting.body,
        "assumed": found.mounting.assumed,
        "gaps_mm": [float(gap) for gap in best.gap_mm],
        "fits": not found.misfit,
        "named": list(found.named),
        "order_1": [list(one) for one in found.order_1],
        "order_2": [list(one) for one in found.order_2],
        "sensor_off_axis": _displacement(found.displaced("sensor")),
        "magnet_off_shaft": _displacement(found.displaced("magnet")),
        "sensor_tilt": _displacement(found.displaced("tilt"), "deg"),
        "magnet_tilt": _displacement(found.displaced("magnet_tilt"), "deg"),
        "sensor_tilt_on_axis": _displacement(found.tilt_alone, "deg"),
        "tilt_times_displacement": _product(found, "tilt_and_magnet", "mm_deg"),
        "tilt_times_tilt": _product(found, "both_tilts", "deg2"),
        "magnet_bound_mm": found.magnet_bound("magnet"),
        "magnet_tilt_bound_deg": found.magnet_bound("magnet_tilt"),
        "parting_mm": found.parting_mm,
        "order_1_parting_mm": found.order_1_parting_mm,
        **_goodness(best),
        "sets": [{"set": list(causes), **_goodness(fit)} for causes, fit in sorted(found.fits.items())],
        "farthest": [_place(found, best, *place) for place in farthest(best)],
        "sentences": list(sentences(found)),
    }


def _goodness(fit: GapFit) -> dict[str, Any]:
    return {"chi2": fit.chi2, "degrees_of_freedom": fit.degrees_of_freedom, "p": fit.p}


def _displacement(found: Displacement | None, unit: str = "mm") -> dict[str, float] | None:
    """Keys of the JSON bear the unit."""
    if found is None:
        return None
    return {
        **{f"{name}_{unit}": getattr(found, name) for name in ("value", "low", "high")},
        "direction_deg": found.direction_deg,
        "direction_half_deg": found.direction_half_deg,
    }


def _product(found: AirGaps, cause: str, unit: str) -> dict[str, float] | None:
    """The sensor's tilt times what is wrong with the magnet, where that is named."""
    product = upright_product(found.best, cause, magnet=found.mounting.magnet) if cause in found.named else None
    if product is None:
        return None
    return {f"{name}_{unit}": getattr(product, name) for name in ("value", "low", "high")}


def _place(found: AirGaps, fit: GapFit, sweep: int, row: int) -> dict[str, Any]:
    """A factor of a sweep that lies off what is expected: by how much, in its unit and in standard errors."""
    factor = FACTORS[ROWS[row]]
    return {
        "sweep": found.names[sweep],
        "factor": factor.name,
        "difference": float(fit.differences[sweep, row]) * factor.per_coordinate * factor.scale,
        "sigma": float(abs(fit.misses[sweep, row])),
    }
