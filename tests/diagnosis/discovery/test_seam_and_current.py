"""What a turn that drifts and a motor's current leave, under one name each."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from tests.diagnosis.discovery.test_forms import channels, named, sweep, turns


@pytest.mark.parametrize("place_deg", [60.0, 137.0])
def test_a_turn_that_drifts_has_a_seam(place_deg: float) -> None:
    """In a table by angle it lies anywhere; between the last row and the first it may as well be a wrong scale."""
    shaft = turns(200, 1)
    drift = np.radians(0.3) * (np.mod(shaft - np.radians(place_deg), 2.0 * np.pi) / (2.0 * np.pi))
    found = explain(sweep(shaft, channels(shaft + drift), 17)).to_dict()
    assert [cause["name"] for cause in found["causes"]] == ["unnamed"]
    (seam,) = found["unexplained"]["structure"]
    assert seam["kind"] == "seam"
    # Five times the noise of 0.02 deg over the root of 200 readings, of which orders 0 to 3 take most; the place to the
    # spacing of 1.8 deg.
    assert seam["step_deg"] == pytest.approx(-0.3, abs=0.03)
    assert abs((seam["centre_deg"] - place_deg + 180.0) % 360.0 - 180.0) < 3.6


@pytest.mark.parametrize("name", ["motor_field", "load_torsion"])
def test_what_follows_the_motors_current_is_named(name: str) -> None:
    """A share of the field an ampere on both channels, and a twist of hundredths of a degree, at three currents."""
    shaft = turns(180, 3)
    current = np.repeat([0.5, 2.0, 5.0], shaft.size // 3)
    if name == "motor_field":
        signal = channels(shaft) + 0.001 * current * np.array([[0.6], [0.8]])
        true = {"bx_mT_per_A": 50.0 * 0.0006, "by_mT_per_A": 50.0 * 0.0008}
    else:
        signal, true = channels(shaft + np.radians(0.03) * current), {"deg_per_A": 0.03}
    found = named(sweep(shaft, signal, 19, current_a=current))
    assert list(found) == [name]
    for key, value in true.items():
        told = found[name][key]
        # One of three intervals of 95 % misses in one seed of seven: twice as wide they hold.
        assert abs(abs(told["value"]) - value) < told["high"] - told["low"]


def test_a_field_of_drag_turns_its_sign_with_the_direction() -> None:
    """At one speed, and no current recorded: drag turns round with the shaft, and so does what it asks of the motor."""
    shaft = turns(180, 2)
    shaft, rpm = np.concatenate([shaft, shaft[::-1]]), np.repeat([1200.0, -1200.0], shaft.size)
    towards = 0.001 * np.sign(rpm) * np.array([[0.6], [0.8]])
    time = np.cumsum(np.abs(np.gradient(shaft)) / (np.abs(rpm) * np.pi / 30.0))
    found = named(sweep(shaft, channels(shaft) + towards, 23, speed_rpm=rpm, time_s=time))
    assert list(found) == ["motor_field"]
    for key, share in (("bx_mT_per_krpm", 0.6), ("by_mT_per_krpm", 0.8)):
        told = found["motor_field"][key]
        # Per 1000 rpm of an assumed field of 50 mT; one of two intervals of 95 % misses in one seed of ten.
        assert abs(abs(told["value"]) - 50.0 * 0.001 * share / 1.2) < told["high"] - told["low"]
