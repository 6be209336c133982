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


def test_is_what_plays_of_all_radii_up_to_one_do() -> None:
    """Rayleigh's law, also where the path turns round within the reach of the last turn: inner loops close.

    100 plays in the middles of as many parts of the radii err by the parts' width squared; a polygon of 24 by 1 / 1152.
    """
    there = np.linspace(0.3, 9.0, 5_001)
    path, reach = np.cos(np.concatenate([there, there[:4_800:-1], there[4_800:], there[::-1]])), 0.3
    radii = 0.5 * reach * (np.arange(100) + 0.5) / 100
    behind = np.empty((path.size, radii.size))
    # come from the upper end of the axis, each play rests for twice its radius and then is behind by its radius
    state = np.maximum(1.0 - radii, np.minimum(1.0 - radii, path[0] + radii))
    for row, at in enumerate(path):
        state = np.clip(state, at - radii, at + radii)
        behind[row] = state - at
    found = axis_lag(path, np.array([[0.25 * reach]]), np.array([[reach / 3.0]]))[0]
    assert np.max(np.abs(found - behind.mean(axis=1))) < 0.5 * reach * 0.01**2 + 0.25 * reach / 1152
    assert np.max(found) == pytest.approx(0.25 * reach, rel=1e-3)


@pytest.mark.parametrize(
    ("memory_deg", "fall"),
    # The polygon of 24 plays leaves the steepest fall by so much that its longest memory is shorter.
    [*((memory, fall) for memory in (0.3, 12.0, 60.0) for fall in (1.5, 2.0)), (0.3, 4.0), (12.0, 4.0), (45.0, 4.0)],
)
def test_lags_by_the_stated_one_in_the_mean(memory_deg: float, fall: float) -> None:
    """However long the memory; a lag of 0.01 deg moves the turning points of the axes by as much, of 90 degrees."""
    forth = _error_deg(_there_and_back(), lag_deg=0.01, memory_deg=memory_deg, on_axes=1.0, fall=fall)[1440:2880]
    assert np.mean(forth) == pytest.approx(-0.01, rel=5e-3)


def test_ripples_four_times_a_turn() -> None:
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


@pytest.mark.parametrize("fall", [1.0, 1.5, 4.0])
def test_what_is_left_after_a_turning_point_falls_by_its_power(fall: float) -> None:
    """From the upper end down: 1 of one play falls in a straight line."""
    memory = 0.2
    path = np.linspace(1.0, -1.0, 2_001)
    found = axis_lag(path, np.array([[0.1]]), np.array([[memory]]), np.array([[fall]]))[0]
    left = np.maximum(1.0 - (1.0 - path) / ((1.0 + fall) * memory), 0.0) ** fall
    assert np.max(np.abs(found - 0.1 * (1.0 - 2.0 * left))) < 0.1 * 0.01
    assert np.mean(0.5 * (1.0 - found[:1001] / 0.1)) == pytest.approx(memory, rel=0.02)


def test_no_reading_lags_by_nothing() -> None:
    assert axis_lag(np.zeros(0), np.array([[0.1]]), np.array([[0.2]])).shape == (1, 0)
