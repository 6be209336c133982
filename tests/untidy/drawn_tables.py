"""Tables of entries drawn at random: what they hold, names, units, sizes and the text they stand in."""

from __future__ import annotations

import json

import numpy as np

from tests.untidy.generator import Array
from tests.untidy.mixed import Mixed

HOLDS = {
    "error": ("error", "enc_err", "deviation", "angle_error"),
    "correction": ("correction", "corr", "comp_table", "compensation"),
    "angle": ("true_angle", "ref_angle", "lut", "shaft"),
    "reading": ("raw", "sensor_reading", "as5600", "measured"),
}
SIZES = (16, 32, 64, 100, 128, 200, 360, 512, 1024)
A_TURN = (4096, 16_384, 65_536)


def drawn_table(seed: int) -> Mixed:
    """The table of a seed, of orders 1 to 3; at even true angles where it holds readings, else at even readings."""
    rng = np.random.default_rng(seed)
    holds, entries = str(rng.choice(list(HOLDS))), int(rng.choice(SIZES))
    grid = np.arange(entries) * 360.0 / entries
    sizes, phases = rng.uniform(0.1, 1.5, 3) / (1.0, 3.0, 10.0), rng.uniform(0.0, 360.0, 3)
    error = sum(
        size * np.sin(np.radians((k + 1) * grid + phase))
        for k, (size, phase) in enumerate(zip(sizes, phases, strict=True))
    )
    zero = 0.0 if holds in ("error", "correction") else float(rng.uniform(0.0, 360.0))
    values = {
        "error": error,
        "correction": -error,
        "angle": (grid - error + zero) % 360.0,
        "reading": (grid + error + zero) % 360.0,
    }[holds]
    reference, measured = (grid, grid + error + zero) if holds == "reading" else (grid - error + zero, grid)
    name = str(rng.choice(HOLDS[holds]))
    called, stored, resolution = _stored(rng, name, values)
    exact = 1e-9
    return Mixed(_text(rng, called, stored), reference, measured, (resolution + exact, resolution + exact))


def _stored(rng: np.random.Generator, name: str, values: Array) -> tuple[str, Array, float]:
    """A name, the numbers in a unit that it tells or does not tell, and how finely [deg]."""
    k = int(rng.integers(0, 5))
    if k < 3:
        called, unit = (
            (f"{name}_deg", 1.0),
            (f"{name}_rad", np.degrees(1.0)),
            (name, float(rng.choice([1.0, 57.29578]))),
        )[k]
        return called, values / unit, 1e-5 * unit
    a_turn = int(rng.choice(A_TURN))
    return (f"{name}_counts", name)[k - 3], np.round(values * a_turn / 360.0), 180.0 / a_turn


def _text(rng: np.random.Generator, name: str, values: Array) -> str:
    """The numbers as an array in C, Python or JSON, or one a line."""
    whole = bool(np.all(values == np.round(values)))
    cells = [f"{value:.0f}" if whole else f"{value:.5f}" for value in values]
    listed = ", ".join(cells)
    return (
        f"const {'int32_t' if whole else 'float'} {name}[{values.size}] = {{ {listed} }};\n",
        f"{name} = [{listed}]\n",
        json.dumps({"encoder": {name: [float(cell) for cell in cells]}}),
        "\n".join([name, *cells]) + "\n",
    )[int(rng.integers(0, 4))]
