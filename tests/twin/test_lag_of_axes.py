"""hysteresis on the axes: each channel lags by itself."""

from __future__ import annotations

import numpy as np
import pytest

from twin import Chain, Motion
from twin.angles import wrap
from twin.concentrator.hysteresis import axis_lag


def _there_and_back(points: int = 1440) -> Motion:
    turn = np.arange(2 * points) * 2.0 * np.pi / points
    return Motion.from_angle(np.concatenate([turn, turn[::-1]]), direction=np.repeat([1.0, -1.0], turn.size))


def _error_deg(motion: Motion, **hysteresis: float) -> np.ndarray:
    chain = Chain().with_effect("zero", zero_deg=30.0).with_effect("hysteresis", **hysteresis)
    return np.degrees(wrap(chain.readings(motion) - motion.shaft_rad - np.radians(30.0)))


def test_follows_the_equation_that_defines_it() -> None:
    """Integrated in steps a hundredth of the memory, an explicit step errs by half of that share of the change."""
    path = np.cos(np.linspace(0.3, 9.0, 20_001))
    found = axis_lag(path, np.array([[0.01]]), np.array([[0.1]]))[0]
    lag = np.empty_like(found)
    lag[0] = found[0]
    for row in range(1, path.size):
        step = path[row] - path[row - 1]
        lag[row] = lag[row - 1] + abs(step) * (-np.sign(step) * 0.01 - lag[row - 1]) / 0.1
    assert np.max(np.abs(found - lag)) < 0.01 * 0.5 * np.max(np.abs(np.diff(path))) / 0.1 * 2.0


def test_lags_by_as_much_in_the_mean_and_ripples_four_times_a_turn() -> None:
    """Small memory: |cos| + |sin| has the mean 4 / pi and an order 4 of 2 / 15 of that, which the reversals blunt."""
    motion = _there_and_back()
    error = _error_deg(motion, lag_deg=0.2, memory_deg=0.3, on_axes=1.0)
    forth = error[1440:2880]
    angle = motion.shaft_rad[1440:2880] + np.radians(30.0)
    # while an axis turns round it lags by less: over the memory, 0.3 deg of path, which takes sqrt(2 x 0.0052) rad
    assert np.mean(forth) == pytest.approx(-0.2, rel=0.02)
    assert 2.0 * np.mean(forth * np.cos(4 * angle)) == pytest.approx(0.2 * 2.0 / 15.0, rel=0.1)
    assert np.mean(error[2880:][1440:]) == pytest.approx(0.2, rel=0.02)


def test_a_share_of_either_is_in_between() -> None:
    motion = _there_and_back(360)
    whole, none, half = (_error_deg(motion, lag_deg=0.1, memory_deg=5.0, on_axes=share) for share in (1.0, 0.0, 0.5))
    # a lag of 0.1 deg moves the place at which the axes turn round by as much: 0.002 rad of each other's effect
    assert np.max(np.abs(half - 0.5 * (whole + none))) < 0.1 * 0.01
    assert np.max(np.abs(whole - none)) > 0.01


def test_a_batch_is_as_each_alone_also_behind_another_batch() -> None:
    motion = _there_and_back(90)
    sizes, shares, offsets = np.array([0.1, 0.2]), np.array([1.0, 0.4]), np.array([0.0, 0.3])
    chain = (
        Chain().with_effect("hysteresis", lag_deg=sizes, on_axes=shares).with_effect("backlash", half_width_deg=offsets)
    )
    together = chain.readings(motion)
    for row, (size, share, offset) in enumerate(zip(sizes, shares, offsets, strict=True)):
        alone = Chain().with_effect("hysteresis", lag_deg=float(size), on_axes=float(share))
        alone = alone.with_effect("backlash", half_width_deg=float(offset))
        np.testing.assert_allclose(together[row], alone.readings(motion), atol=1e-12)


def test_has_an_entry_of_its_own_in_the_trace() -> None:
    motion = _there_and_back(36)
    traced = Chain().with_effect("hysteresis", lag_deg=0.1, on_axes=0.5).trace(motion)
    assert {"hysteresis", "hysteresis in channels"} <= set(traced)
    assert "hysteresis in channels" not in Chain().with_effect("hysteresis", lag_deg=0.1).trace(motion)
