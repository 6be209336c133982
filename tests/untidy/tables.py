"""One known calibration in the tables of several firmwares, by code that knows nothing of the reader.

The reading at a true angle is ``reading_of``; the true angle at a reading is found by going back through it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from tests.untidy.generator import Array

TRUE_DEG = np.linspace(-20.0, 400.0, 84_001)


def reading_of(true_deg: Array) -> Array:
    """What the sensor reads, not wrapped."""
    first, second = np.sin(np.radians(true_deg + 30.0)), np.sin(np.radians(2.0 * true_deg))
    return true_deg + 0.8 * first + 0.3 * second


def true_of(reading_deg: Array) -> Array:
    """The true angle at which the sensor reads so."""
    return np.interp(reading_deg, reading_of(TRUE_DEG), TRUE_DEG)


@dataclass(frozen=True)
class Stored:
    """A text, the angles that it stores and how finely; words that are told, or asked back where ``asked``."""

    text: str
    reference_deg: Array
    measured_deg: Array
    resolution_deg: float
    told: tuple[str, ...] = ()
    asked: bool = False
    grid_deg: float | None = None


def _on_grid(entries: int, middle: float = 0.0) -> tuple[Array, Array]:
    """Even readings and the true angles there."""
    grid = (np.arange(entries) + middle) * 360.0 / entries
    return grid, true_of(grid)


def _listed(values: Iterable[float], digits: int = 6, end: str = "") -> str:
    return ", ".join(f"{value:.{digits}f}{end}" for value in values)


def _lines(path: str, values: Iterable[float], digits: int) -> str:
    return "".join(f"{path}.{k} {value:.{digits}f}\n" for k, value in enumerate(values))


def _c(declared: str, listed: str) -> str:
    numbers = f"{{\n  /* 0, deg */ {listed} // 360, again\n}}"
    return f"#include <stdint.h>\n/* angle table {{rev 3}}, 12 // of it */\n{declared} = {numbers};\n"


def stored() -> dict[str, Stored]:
    """Every table by its name."""
    return {**_known(), **_by_name(), **_open()}


def _known() -> dict[str, Stored]:
    """Tables of firmwares."""
    (grid, true), (few, true_few) = _on_grid(200), _on_grid(32, 0.5)
    lut = np.radians(grid - true)
    simplefoc = f"MOT: Ready.\nfloat calibrationLut[200] = {{\n{_listed(lut)}}};\nfloat zero_electric_angle = 2.741;\n"
    codes = _c("uint16_t calibrationLut[200]", _listed(np.round(32768.0 + lut * 65536.0 / (2.0 * np.pi)), 0))
    source, all_codes = "motor_position.sources", _on_grid(256)
    scale = float(np.max(np.abs(all_codes[1] - all_codes[0]))) / 360.0
    parts = np.round((all_codes[1] - all_codes[0]) / 360.0 / scale * 127.0)
    steps = 1.8 * np.arange(200)
    read = (reading_of(steps) + 77.0) % 360.0
    cells = [f"{value * 65536.0 / 360.0:.1f}" for value in read]
    saved = "".join(f"#*# \t{','.join(cells[k : k + 8])}{',' if k < 192 else ''}\n" for k in range(0, 200, 8))
    klipper = "[stepper_x]\nmicrosteps: 16\n\n[angle x_angle]\nsensor_type: a1333\n\n#*# [angle x_angle]\n"
    fine, true_fine = _on_grid(16_384)
    cheetah, true_cheetah = _on_grid(128)
    moteus = f"motor.poles 14\n{_lines(f'{source}.0.compensation_table', (true_few - few) / 360.0, 8)}"
    empty = _lines(f"{source}.1.compensation_table", np.zeros(32), 1)
    nested = {"motor_position": {"sources": [{"cpr": 16384, "compensation_table": list((true_few - few) / 360.0)}]}}
    return {
        "SimpleFOC": Stored(simplefoc, true, grid, 6e-5, ("calibrationLut:rad", "SimpleFOC"), grid_deg=1.8),
        "SimpleFOC in codes": Stored(codes, true, grid, 0.003, ("SimpleFOC",), grid_deg=1.8),
        "moteus": Stored(moteus + empty, true_few, few, 1e-5, ("moteus", "all entries are 0"), grid_deg=11.25),
        "moteus in JSON": Stored(json.dumps(nested), true_few, few, 1e-5, ("moteus", "middle"), grid_deg=11.25),
        "moteus in parts of a scale": Stored(
            f"{_lines(f'{source}.0.compensation_table', parts, 0)}{source}.0.compensation_scale {scale:.9f}\n",
            all_codes[1],
            all_codes[0],
            360.0 * scale / 254.0 + 1e-5,
            ("moteus", "times its scale"),
            grid_deg=360.0 / 256,
        ),
        "Klipper": Stored(
            f"{klipper}#*# calibrate =\n{saved}", steps, read, 3e-4, ("Klipper", "angle.x_angle.calibrate*360/65536")
        ),
        "Mechaduino": Stored(
            _c("const PROGMEM float lookup[]", _listed((true_fine + 12.0) % 360.0, 2) + " , "),
            true_fine + 12.0,
            fine,
            0.006,
            ("Mechaduino",),
        ),
        "mini cheetah": Stored(
            _c("int offset_lut[128]", _listed(np.round((true_cheetah - cheetah) * 16384.0 / 360.0), 0)),
            true_cheetah,
            cheetah,
            0.0111,
            ("16384 counts",),
            grid_deg=360.0 / 128,
        ),
    }


def _by_name() -> dict[str, Stored]:
    """Tables of no firmware that is known, of which names say enough."""
    grid, true = _on_grid(64)
    closed = _listed([*np.degrees(np.radians(grid - true)), (grid - true)[0]], 5, "f")
    return {
        "a correction in degrees": Stored(
            _c("static const float angle_correction_deg[64]", _listed(true - grid, 5, "f")),
            true,
            grid,
            1e-5,
            grid_deg=5.625,
        ),
        "an error whose last entry repeats the first": Stored(
            _c("const float enc_error_deg[65]", closed), np.append(true, true[0]), np.append(grid, grid[0]), 1e-5
        ),
        "true angles": Stored(
            _c("float true_angle_deg[64]", _listed(true % 360.0, 5)), true, grid, 1e-5, grid_deg=5.625
        ),
        "readings in counts": Stored(
            f"as5600_raw = np.array([{_listed(np.round(reading_of(grid) * 4096 / 360.0) % 4096, 0)}])\n",
            grid,
            reading_of(grid),
            180.0 / 4096 + 1e-6,
        ),
    }


def _open() -> dict[str, Stored]:
    """Tables of which two guesses fit: what is told first is right."""
    grid, true = _on_grid(64)
    error = grid - true
    counts = np.round(error * 16384 / 360.0)
    return {
        "radians of an unknown sign": Stored(
            _c("float table[64]", _listed(np.radians(error))), true, grid, 6e-5, asked=True
        ),
        "errors in whole numbers": Stored(
            _c("int16_t enc_err[64]", _listed(counts, 0)), true, grid, 0.0111, asked=True
        ),
        "one angle a line": Stored("\n".join(f"{v:.5f}" for v in true % 360.0), true, grid, 1e-5, asked=True),
        "one line of angles": Stored(_listed(true % 360.0, 5) + "\n", true, grid, 1e-5, asked=True),
        "one code a line under a name": Stored(
            "lookup\n" + "\n".join(f"{v:.0f}" for v in np.round(true * 4096 / 360.0) % 4096),
            true,
            grid,
            0.0441,
            asked=True,
        ),
    }
