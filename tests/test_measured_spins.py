"""What judges the measured spins: halves of a log against each other, and which references can be hidden."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.benchmarks.measured_spins import apart_deg, halves, locked_rms_deg, read, why_not, write

Array = np.ndarray[Any, np.dtype[np.float64]]
Answer = tuple[Mapping[str, Any], Callable[[Array], Array], frozenset[int]]


def log(size_deg: float = 0.4) -> dict[str, Array]:
    """Ten turns a second, an error of order 2 over the reading."""
    time = np.arange(8000) / 2000.0
    shaft = 3600.0 * time
    reading = shaft.copy()
    for _ in range(20):
        reading = shaft + size_deg * np.sin(np.radians(2.0 * reading))
    return {"time_s": time, "measured_deg": np.mod(reading, 360.0)}


def knowing(paths: Sequence[str]) -> Answer:
    """A tool that knows, but wherever there is a reference says half of it."""
    share = 0.5 if "reference_deg" in read(Path(paths[0])) else 1.0
    return {"causes": []}, lambda told: told - share * 0.4 * np.sin(np.radians(2.0 * told)), frozenset()


def test_what_is_locked_to_the_angle_is_measured() -> None:
    assert locked_rms_deg(log()) == pytest.approx(0.4 / np.sqrt(2.0), rel=0.01)


def test_a_half_is_corrected_from_the_other() -> None:
    found = halves(log(), knowing)
    assert found.before_deg == pytest.approx((0.4 / np.sqrt(2.0),) * 2, rel=0.02)
    assert found.factor > 100.0
    worse = halves(log(), lambda paths: ({}, lambda told: told + 0.4 * np.sin(np.radians(2.0 * told)), frozenset()))
    assert worse.factor == pytest.approx(0.5, rel=0.02)


def test_only_a_moving_shaft_with_time_stamps_can_do_without_its_reference() -> None:
    columns = log()
    assert why_not(columns) == ""
    assert why_not({"measured_deg": columns["measured_deg"]}) == "no time stamps"
    assert "stop and measure" in why_not({**columns, "time_s": 1e3 * columns["time_s"]})
    assert "stop and measure" in why_not({**columns, "time_s": np.zeros(8000)})
    assert why_not({name: values[:100] for name, values in columns.items()}) == "0.5 turns"


def test_the_reference_is_hidden_and_both_corrections_compared(tmp_path: Path) -> None:
    path = write(tmp_path / "sweep.csv", log() | {"reference_deg": np.zeros(8000)})
    assert apart_deg(path, knowing) == pytest.approx(0.2 / np.sqrt(2.0), rel=0.01)
