"""The lag of the concentrator follows the path of the shaft, however a bench names the row at which it turns."""

from __future__ import annotations

import numpy as np
import pytest

from twin.concentrator.hysteresis import lag
from twin.motion import Motion

LAG_RAD, MEMORY_RAD = 1e-3, np.radians(8.0)
STEP_RAD = np.radians(3.0)
TURN = 40


def _motion(named_by_what_follows: bool) -> Motion:
    """Forty steps up and forty down at one speed; the row at the top belongs to either stretch."""
    steps = np.concatenate([np.arange(TURN + 1), np.arange(TURN - 1, -1, -1)])
    direction = np.where(np.arange(steps.size) < TURN + (not named_by_what_follows), 1.0, -1.0)
    speed = np.full(steps.size, 20.0) * direction
    return Motion.from_angle(STEP_RAD * steps, direction=direction, speed_rad_s=speed)


@pytest.mark.parametrize("named_by_what_follows", [False, True])
def test_the_path_counts_from_where_the_shaft_turned(named_by_what_follows: bool) -> None:
    # worked out by hand: -h on the way up, and k steps down from the top h (1 - 2 exp(-k step / memory))
    found = lag(_motion(named_by_what_follows), np.array([LAG_RAD]), np.array([MEMORY_RAD]))
    travelled = STEP_RAD * np.arange(1, TURN + 1)
    assert np.allclose(found[: TURN + 1], -LAG_RAD, rtol=1e-9)
    assert np.allclose(found[TURN + 1 :], LAG_RAD * (1.0 - 2.0 * np.exp(-travelled / MEMORY_RAD)), rtol=1e-9)
