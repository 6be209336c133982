"""The motor's current and what a sensor says of itself as columns of a sweep."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from diagnosis.input_checks import as_sweep
from twin import Motion, Sweep
from twin.errors import SweepError

ANGLE_DEG = np.arange(0.0, 360.0, 6.0)
TOLD = {
    "current_a": np.linspace(-2.0, 3.0, ANGLE_DEG.size),
    "magnitude": np.full(ANGLE_DEG.size, 1800.0),
    "agc": np.full(ANGLE_DEG.size, 128.0),
    "status": np.zeros(ANGLE_DEG.size),
    "frame": np.arange(ANGLE_DEG.size) % 16.0,
}


def sweep(**columns: np.ndarray) -> Sweep:
    return Sweep.from_columns({"reference_deg": ANGLE_DEG, "measured_deg": ANGLE_DEG + 30.0, **columns})


def test_they_are_read_and_written_as_they_are(tmp_path: Path) -> None:
    sweep(**TOLD).write(tmp_path / "sweep.csv")
    again = Sweep.read(tmp_path / "sweep.csv")
    for name, values in TOLD.items():
        np.testing.assert_allclose(again.columns[name], values, rtol=1e-8)


def test_missing_cells_and_words_of_a_status_cost_no_row(tmp_path: Path) -> None:
    rows = [
        f"{angle},{angle + 30.0},{'ok' if k % 2 else ''},{'' if k == 3 else k}" for k, angle in enumerate(ANGLE_DEG)
    ]
    (tmp_path / "s.csv").write_text("\n".join(["reference_deg,measured_deg,status,current_a", *rows]))
    found = Sweep.read(tmp_path / "s.csv")
    assert len(found) == ANGLE_DEG.size
    assert found.status is None
    assert found.motion().current_a[3] == 3.0


def test_words_of_a_status_cost_nothing_in_a_table_either() -> None:
    table = {"reference_deg": ANGLE_DEG, "measured_deg": ANGLE_DEG + 30.0, "status": ["ok"] * ANGLE_DEG.size}
    assert as_sweep(table).status is None


def test_a_current_in_words_is_a_mistake(tmp_path: Path) -> None:
    rows = [f"{angle},{angle + 30.0},high" for angle in ANGLE_DEG]
    (tmp_path / "s.csv").write_text("\n".join(["reference_deg,measured_deg,current_a", *rows]))
    with pytest.raises(SweepError, match="line 2, column current_a: 'high' is not a number"):
        Sweep.read(tmp_path / "s.csv")


def test_the_motion_goes_with_the_current_of_each_reading() -> None:
    motion = sweep(**TOLD).motion()
    assert "current_a" in motion.provides
    np.testing.assert_array_equal(motion.part(np.arange(5, 20)).current_a, TOLD["current_a"][5:20])
    both = Motion.joined([motion, motion], [])
    np.testing.assert_array_equal(both.current_a, np.tile(TOLD["current_a"], 2))
    without = sweep().motion()
    assert "current_a" not in without.provides
    np.testing.assert_array_equal(without.current_a, np.zeros(ANGLE_DEG.size))
