"""Channels cut off to nearly a square wave: told by the readings, named as clipping, and nothing else taken for it."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from twin.adc.square_wave import find
from twin.angles import TAU
from twin.words import Words

Array = np.ndarray


def record(
    level: float, *, points: int, turns: int = 2, sense: int = 1, noise_deg: float = 0.02
) -> tuple[Array, Array]:
    """Reference and reading [rad] of a sensor whose channels stop at a level, in amplitudes of x."""
    rng = np.random.default_rng(points)
    shaft = np.arange(points * turns) * TAU / points
    angle = sense * shaft + 0.7
    x = np.clip(np.cos(angle) + 0.008, -level, level)
    y = np.clip(1.01 * np.sin(angle + 0.006) - 0.006, -level, level)
    return shaft, np.arctan2(y, x) + np.radians(noise_deg) * rng.normal(size=shaft.size)


def words_of(shaft: Array, measured: Array) -> Words:
    return Words(shaft, measured, np.ones(shaft.size, dtype=bool))


@pytest.mark.filterwarnings("error::RuntimeWarning")
@pytest.mark.parametrize(("level", "points", "noise_deg"), [(0.02, 256, 0.05), (0.06, 72, 0.0), (0.25, 180, 0.02)])
def test_it_is_clipping(level: float, points: int, noise_deg: float) -> None:
    shaft, measured = record(level, points=points, noise_deg=noise_deg)
    found = explain({"reference_deg": np.degrees(shaft) % 360.0, "measured_deg": np.degrees(measured) % 360.0})
    assert [cause.name for cause in found.causes] == ["clipping"]
    told = found.extended.values["clipping"]["level_percent"]
    # Between two points the limit may lie anywhere.
    assert told == pytest.approx(100.0 * level, abs=100.0 * TAU / points / 2.0)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("level", [0.03, 0.1, 0.4])
def test_the_limit_is_told_in_either_sense(level: float, sense: int) -> None:
    shaft, measured = record(level, points=360, sense=sense)
    fault = find(words_of(shaft, measured))
    assert fault is not None
    assert fault.values["level_percent"] == pytest.approx(100.0 * level, abs=1.0)
    uncut = sense * shaft + 0.7
    assert np.quantile(np.abs(np.angle(np.exp(1j * (fault.decoded - uncut)))), 0.9) < np.radians(2.0)


def test_what_is_not_cut_off_is_none() -> None:
    shaft, measured = record(10.0, points=180)
    assert find(words_of(shaft, measured)) is None
    for bits in (3, 4, 5):
        step = TAU / 2.0**bits
        assert find(words_of(shaft, np.round(measured / step) * step)) is None
    repeated = measured[np.maximum.accumulate(np.where(np.random.default_rng(1).random(360) < 0.6, 0, np.arange(360)))]
    assert find(words_of(shaft, repeated)) is None


def test_a_reading_that_holds_two_angles_is_none() -> None:
    shaft, _ = record(0.1, points=180)
    assert find(words_of(shaft, np.where(np.sin(shaft) > 0.0, 0.125 * TAU, 0.375 * TAU))) is None
