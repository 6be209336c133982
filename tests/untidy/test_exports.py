"""The tables that ``halltwin export`` writes are read back to the sensor that they were made for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.untidy.generator import table
from tests.untidy.tables import reading_of, true_of
from twin.logs.read import read_log
from twin.sweep import Sweep

ZERO_DEG = 40.0
TARGETS = {
    "simplefoc": (".h", 0.005),
    "moteus": (".cfg", 0.02),
    "moteus:32": (".cfg", 0.02),
    "klipper": (".cfg", 0.02),
    "mechaduino": (".h", 0.011),
    "magalpha": (".h", 0.07),
    "c": (".h", 0.01),
    "autosar": (".h", 0.015),
    "lut:64": (".csv", 0.005),
}
"""By target the ending of its file, and how far its table is off, by its entries' number and unit."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    here = tmp_path_factory.mktemp("exports")
    true_deg = np.arange(360.0)
    sweep = {"reference_deg": true_deg, "measured_deg": (reading_of(true_deg) + ZERO_DEG) % 360.0}
    (here / "sweep.csv").write_text(table(sweep))
    return here


@pytest.mark.parametrize("target", TARGETS)
def test_an_exported_table_is_read_back(target: str, folder: Path) -> None:
    """On its axis, with its sign and unit, and up to a zero."""
    ending, off_deg = TARGETS[target]
    path = folder / f"{target.replace(':', '_')}{ending}"
    assert halltwin("export", folder / "sweep.csv", "--for", target, "-o", path).code == 0
    sweep = Sweep.read(path, columns=read_log(path).guess.text)
    true_deg = true_of((sweep.measured_deg - ZERO_DEG) % 360.0)
    off = (sweep.reference_deg - true_deg + 180.0) % 360.0 - 180.0
    off = (off - np.median(off) + 180.0) % 360.0 - 180.0
    assert np.max(np.abs(off)) <= off_deg
