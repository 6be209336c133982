"""The formats that logs are written in: the project's own CSV, radians, counts, decimal commas, NPZ."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.setup_faults.bench import Array, Bench

_COUNTS = 4096
_NAMES = {
    "radians": {"reference_deg": "encoder [rad]", "measured_deg": "sensor [rad]", "time_s": "t [s]"},
    "counts": {"reference_deg": "enc_counts", "measured_deg": "sensor_counts", "time_s": "time [ms]"},
    "semicolon": {
        "reference_deg": "Referenz [deg]",
        "measured_deg": "Sensor [deg]",
        "time_s": "Zeit [s]",
        "temperature_c": "Temperatur [°C]",
    },
}
_KEPT = ("vx", "vy", "magnitude", "agc", "status", "frame", "temperature_c", "speed_rpm")


def write(bench: Bench, form: str, folder: Path, *, keep: bool = False) -> Path:
    """The bench's recording as a file of this format; with ``keep`` its angles are written as they are."""
    columns = dict(bench.columns) if keep else _as_recorded(bench)
    names = {name: _NAMES.get(form, {}).get(name, name) for name in columns}
    if form == "radians":
        columns = {name: np.radians(values) if name.endswith("_deg") else values for name, values in columns.items()}
    if form == "counts":
        columns = {name: _counted(name, values) for name, values in columns.items()}
    table = {names[name]: values for name, values in columns.items()}
    if form == "npz":
        path = folder / "log.npz"
        np.savez(path, **table)
        return path
    path = folder / "log.csv"
    cells = [[f"{value:.9g}" for value in values] for values in table.values()]
    mark, comma = (";", True) if form == "semicolon" else (",", False)
    lines = [mark.join(row).replace(".", ",") if comma else mark.join(row) for row in zip(*cells, strict=True)]
    path.write_text("\n".join([mark.join(table), *lines]) + "\n", encoding="utf-8")
    return path


def _as_recorded(bench: Bench) -> dict[str, Array]:
    """Angles wrapped as an encoder does, the reading as a word."""
    columns = dict(bench.columns)
    for name in ("reference_deg", "measured_deg"):
        if name not in columns:
            continue
        if name == "measured_deg" and bench.sensor_bits:
            step = 360.0 / 2**bench.sensor_bits
            columns[name] = np.round(columns[name] / step) * step
        if bench.wrapped:
            columns[name] = np.mod(columns[name], 360.0)
    return columns


def _counted(name: str, values: Array) -> Array:
    if name.endswith("_deg"):
        return np.mod(np.round(values * _COUNTS / 360.0), _COUNTS)
    return values * 1000.0 if name == "time_s" else values
