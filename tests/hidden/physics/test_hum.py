"""Hum with its harmonics, folded where readings are too slow for them: one cause, and nothing beside it."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..study import DEFAULT_ANSWERER, load
from .generator import draw


def test_hum_and_its_harmonics_are_one_cause(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    draw("hum", seed=1492033996).write_csv(path)
    (cause,) = load(DEFAULT_ANSWERER)(str(path))["causes"]
    assert cause["name"] == "mains_pickup"
    told = [cause["parameters"][f"frequency_Hz{number}"] for number in ("", "_2", "_3")]
    supply = told[0]["value"]
    for times, one in zip((1, 3, 5), told, strict=True):
        # each line by itself, within a few of its own standard deviations
        deviation = (one["high"] - one["low"]) / 3.92
        assert one["value"] == pytest.approx(times * supply, abs=5.0 * deviation)
