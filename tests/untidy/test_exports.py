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
SENSE_TOLD, ZERO_TOLD = ("klipper", "mechaduino", "c", "autosar", "lut:64"), ("mechaduino", "c", "autosar", "lut:64")
"""Targets whose table leads to the shaft in its own sense, and from its own zero."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    here = tmp_path_factory.mktemp("exports")
    true_deg = np.arange(360.0)
    sweep = {"reference_deg": true_deg, "measured_deg": (reading_of(true_deg) + ZERO_DEG) % 360.0}
    (here / "sweep.csv").write_text(table(sweep))
    sweep["measured_deg"] = -sweep["measured_deg"] % 360.0
    (here / "against.csv").write_text(table(sweep))
    return here


@pytest.mark.parametrize(("source", "name"), [("sweep", "halltwin"), ("against", "left_arm")])
@pytest.mark.parametrize("target", TARGETS)
def test_an_exported_table_is_read_back(target: str, source: str, name: str, folder: Path) -> None:
    """On its axis, with its sign and unit, of a sensor that counts with the shaft or against it.

    Up to a zero, but where the table holds it; its reference counts as the sensor where the table tells no sense.
    """
    ending, off_deg = TARGETS[target]
    path = folder / f"{target.replace(':', '_')}_{source}_{name}{ending}"
    assert halltwin("export", folder / f"{source}.csv", "--for", target, "--name", name, "-o", path).code == 0
    sweep = Sweep.read(path, columns=read_log(path).guess.text)
    sense = 1.0 if source == "sweep" else -1.0
    true_deg = true_of((sense * sweep.measured_deg - ZERO_DEG) % 360.0) * (1.0 if target in SENSE_TOLD else sense)
    off = (sweep.reference_deg - true_deg + 180.0) % 360.0 - 180.0
    zero = 0.0 if target in ZERO_TOLD else np.median(off)
    off = (off - zero + 180.0) % 360.0 - 180.0
    assert np.max(np.abs(off)) <= off_deg


@pytest.mark.parametrize(("target", "said"), [("c", "nor corrections of angles"), ("autosar", "guesses fit")])
def test_c_without_its_macros_is_no_table_of_its_own(target: str, said: str, folder: Path) -> None:
    """What the entries count in, and the sense, would be a guess."""
    path = folder / f"{target}_alone.h"
    assert halltwin("export", folder / "sweep.csv", "--for", target, "-o", path).code == 0
    path.write_text("".join(line for line in path.read_text().splitlines(True) if not line.startswith("#define")))
    ended = halltwin("import", path)
    assert ended.code == 2
    assert said in ended.err
