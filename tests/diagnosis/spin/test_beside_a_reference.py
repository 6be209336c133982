"""A log without a reference beside a sweep with one: torques turn a shaft where its motion is estimated alone."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.spin.of_log import sweeps_of
from diagnosis.spin.torques import found_torques, torque_columns
from tests.diagnosis.spin.test_smoother import TIME, coasting, read
from twin.errors import SweepError
from twin.motion import Motion
from twin.recordings import Setup
from twin.spin import Spin
from twin.sweep import Sweep

STEPS = np.arange(0.0, 360.0, 0.5)


def spin() -> Spin:
    return Spin.from_columns({"time_s": TIME, "measured_deg": np.degrees(read(coasting()))})


def slow(*, timed: bool) -> Sweep:
    """A turn of the reference at 20 readings a second."""
    columns = {"reference_deg": STEPS, "measured_deg": STEPS + 0.3 * np.sin(np.radians(STEPS))}
    return Sweep.from_columns(columns | ({"time_s": 0.05 * np.arange(STEPS.size)} if timed else {}))


def test_torques_turn_no_shaft_that_a_reference_tells() -> None:
    (coast,) = sweeps_of([spin()])
    motion = Motion.joined([coast.motion(), slow(timed=True).motion()], [Setup(), Setup()])
    told = np.arange(len(motion)) >= len(coast)
    assert np.abs(torque_columns(motion)[:, ~told]).max() > 1e-4
    assert np.abs(found_torques(motion)[~told]).max() > 1e-4
    assert not np.any(torque_columns(motion)[:, told])
    assert not np.any(found_torques(motion)[told])


def test_a_sweep_without_times_is_none_to_go_with_it() -> None:
    with pytest.raises(SweepError, match="no time_s beside spin"):
        explain([spin(), slow(timed=False)])
