"""Formats that are archives of files, told apart by the names of these."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.untidy.generator import MEASURED_DEG, REFERENCE_DEG, ROWS
from twin.logs.read import read_log


def test_arrays_that_hold_the_letters_of_a_workbook_are_arrays(tmp_path: Path) -> None:
    """Among packed numbers any letters may stand."""
    letters = np.frombuffer(b"xl/.....", dtype=np.float64)
    columns = {"reference_deg": REFERENCE_DEG, "measured_deg": MEASURED_DEG, "note": np.repeat(letters, ROWS)}
    np.savez(tmp_path / "log.npz", **columns)
    assert b"xl/" in (tmp_path / "log.npz").read_bytes()
    np.testing.assert_array_equal(read_log(tmp_path / "log.npz").columns["reference_deg"], REFERENCE_DEG)
