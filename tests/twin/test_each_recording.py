"""Effects over several recordings: each by itself, with what follows its air gap and its mounting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.each_recording import acts_in, device_of, everywhere, in_each, in_one
from twin.magnet.magnet import Magnet
from twin.motion import Motion
from twin.recordings import Setup

THERE = np.radians(np.arange(0.0, 400.0, 5.0))
PART = Motion.from_angle(np.concatenate([THERE, THERE[::-1]]))
NEAR, FAR = Setup(name="near"), Setup(name="far", air_gap_mm=3.0, field=0.5, distance=1.5, turned_deg=90.0)
BOTH = Motion.joined([PART, PART], [NEAR, FAR])
SETUPS = (NEAR, FAR)


def over_both(name: str) -> Chain:
    return Chain(effects=tuple(in_each(effect, SETUPS, Magnet()) for effect in CATALOGUE))


def test_memory_begins_anew_with_each_recording() -> None:
    """Each half reads as that recording alone; over one motion without the border the second would begin lagging."""
    params = {"lag_deg": 0.3, "memory_deg": 20.0}
    alike = Motion.joined([PART, PART], [NEAR, replace(NEAR, name="again")])
    joint = over_both("hysteresis").with_effect("hysteresis", **params).readings(alike)
    alone = Chain().with_effect("hysteresis", **params).readings(PART)
    assert np.allclose(np.exp(1j * joint), np.exp(1j * np.concatenate([alone, alone])), atol=1e-12)
    unbroken = Chain().with_effect("hysteresis", **params).readings(replace(alike, recordings=None))
    assert np.max(np.abs(np.angle(np.exp(1j * (unbroken - joint))))) > np.radians(0.1)


@pytest.mark.parametrize(("power", "name", "param"), [(-1, "offset", "x_percent"), (2, "saturation", "k_percent")])
def test_what_follows_the_field_does(power: int, name: str, param: str) -> None:
    joint = over_both(name).with_effect(name, **{param: 1.0})
    second = Chain().with_effect(name, **{param: 0.5**power})
    assert np.allclose(joint.channels(BOTH)[:, len(PART) :], second.channels(PART), atol=1e-12)


def test_a_stray_field_stays_where_it_is_when_the_sensor_is_turned() -> None:
    """A quarter turn of the sensor: what was along x is along -y, and twice as much against half the field."""
    joint = over_both("stray_field").with_effect("stray_field", bx_mT=1.0)
    added = joint.channels(BOTH) - over_both("").channels(BOTH)
    assert np.allclose(added[:, : len(PART)].T, [1.0 / 50.0, 0.0], atol=1e-12)
    assert np.allclose(added[:, len(PART) :].T, np.array([0.0, -1.0]) * added[0, 0] * 2.0, rtol=0.6, atol=1e-12)


def test_a_motor_that_stays_where_it_is_is_seen_from_another_side() -> None:
    """Two amperes of half a millitesla each are the stray field of one millitesla, in both mountings."""
    current = replace(BOTH, current_a=np.full(len(BOTH), 2.0))
    motor = over_both("motor_field").with_effect("motor_field", bx_mT_per_A=0.5, by_mT_per_A=0.2)
    stray = over_both("stray_field").with_effect("stray_field", bx_mT=1.0, by_mT=0.4)
    assert np.allclose(motor.channels(current), stray.channels(current), atol=1e-12)
    assert np.ptp(stray.channels(current) - over_both("").channels(current)) > 0.01


def test_what_acts_in_one_recording_leaves_the_others_alone() -> None:
    slip = in_one(find("zero"), 1)
    assert (slip.name, acts_in(slip.name), everywhere(slip.name)) == ("zero@2", 1, "zero")
    chain = Chain(effects=(*CATALOGUE, slip)).with_values({"zero@2": {"zero_deg": 10.0}})
    moved = chain.readings(BOTH) - Chain().readings(BOTH)
    assert np.allclose(np.degrees(np.angle(np.exp(1j * moved))), 10.0 * BOTH.recordings.number, atol=1e-9)


def test_the_device_has_nothing_of_single_recordings() -> None:
    chain = replace(over_both(""), effects=(*over_both("").effects, in_one(find("zero"), 1)))
    device = device_of(chain.with_effect("offset", x_percent=1.0).with_values({"zero@2": {"zero_deg": 3.0}}))
    assert list(device.values) == ["offset"]
    assert {effect.name for effect in device.effects} == {effect.name for effect in CATALOGUE}
    assert all(effect is find(effect.name) or effect.forward is find(effect.name).forward for effect in device.effects)


def test_together_recordings_provide_what_none_does_alone() -> None:
    up = Motion.from_angle(THERE)
    down = Motion.from_angle(THERE[::-1])
    assert "both directions" not in up.provides | down.provides
    together = Motion.joined([up, down], [NEAR, FAR]).provides
    assert {"both directions", "two air gaps", "two mountings"} <= together
    for alike in (NEAR, FAR):
        assert not {"two air gaps", "two mountings"} & Motion.joined([up, down], [alike, alike]).provides
