"""The figures of every device as one table: Parquet, and what the page draws."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from diagnosis.report.wording import unit_shown
from scenarios.studies.fleet.answer import explained
from scenarios.studies.fleet.result import Result
from twin.angles import Array
from twin.baseline import FACTORS

Columns = dict[str, Any]


def columns_of(found: Result) -> Columns:
    """A row for each file in the order of production, with NaN and empty text where it could not be used."""
    batch = found.population.batch
    numbers = found.numbers
    rows = np.array([numbers[name] - 1 for name in batch.names], dtype=int)

    def spread(values: Array) -> Array:
        whole = np.full(len(found.names), np.nan)
        whole[rows] = values
        return whole

    columns: Columns = {
        "file": list(found.names),
        "number": np.arange(1, len(found.names) + 1),
        "not_used": [found.reasons.get(name, "") for name in found.names],
        "readings": spread(batch.arrays["rows"]),
        "gross_errors": spread(batch.arrays["left_out"]),
        "noise_deg": spread(batch.arrays["sigma_deg"]),
        "left_rms_deg": spread(batch.arrays["own_rms_deg"]),
    }
    for place, factor in enumerate(FACTORS):
        columns[f"{factor.key}.{factor.param}"] = spread(batch.arrays["fitted"][:, place])
        columns[f"{factor.key}.{factor.param}_error"] = spread(batch.arrays["fitted_error"][:, place])
    for name, values in _coefficients(found).items():
        columns[name] = spread(values)
    columns["distance"] = spread(np.sqrt(found.population.distances.squares[:, 0]))
    return columns | _told(found)


def _told(found: Result) -> Columns:
    """Which devices stand apart and in what, and what ``explain`` says of those that were asked."""
    batch = found.population.batch
    apart = {batch.names[one.device]: ", ".join(one.figures) for one in found.population.apart}
    said = {found.names[k]: explained(device, found) or {} for k, device in enumerate(found.devices)}
    return {
        "apart": [name in apart for name in found.names],
        "apart_in": [apart.get(name, "") for name in found.names],
        "verdict": [said[name].get("verdict", "") for name in found.names],
        "causes": [", ".join(cause["name"] for cause in said[name].get("causes", ())) for name in found.names],
    }


def parquet(found: Result) -> bytes:
    """All columns as a Parquet file."""
    import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]
    import pyarrow.parquet as files  # type: ignore[import-not-found,import-untyped,unused-ignore]

    out = io.BytesIO()
    files.write_table(pyarrow.table(columns_of(found)), out)
    return out.getvalue()


def _coefficients(found: Result) -> Columns:
    """The coefficients of each shared cause, with their errors, over the usable devices."""
    batch = found.population.batch
    columns: Columns = {}
    start = len(FACTORS)
    for number, one in enumerate(batch.present, 1):
        for term in range(one.terms):
            name = f"{one.effect}_{number}.{one.strength}"
            if one.terms > 1:
                name += f"_at_{90 * term}_deg" if one.order is not None else f"_{term + 1}"
            columns[name] = batch.arrays["fitted"][:, start + term]
            columns[f"{name}_error"] = batch.arrays["fitted_error"][:, start + term]
        start += one.terms
    return columns


def drawn_columns(found: Result) -> dict[str, tuple[str, Array]]:
    """What a person may look at over the devices: by label, unit and figures (files,)."""
    columns, batch = columns_of(found), found.population.batch
    drawn = {factor.label: (factor.shown_unit, columns[f"{factor.key}.{factor.param}"]) for factor in FACTORS}
    drawn["RMS left"] = ("deg", columns["left_rms_deg"])
    for number, one in enumerate(batch.present, 1):
        names = [name for name in columns if name.startswith(f"{one.effect}_{number}.") and "_error" not in name]
        values = np.stack([columns[name] for name in names])
        size = values[0] if one.terms == 1 else np.linalg.norm(values, axis=0)
        drawn[f"{number} {one.effect.replace('_', ' ')}"] = (unit_shown(one.unit), size)
    drawn["distance from the rest"] = ("standard deviations", columns["distance"])
    return drawn
