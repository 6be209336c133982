"""A sensor turned about the shaft: its own errors turn with it, those of reference, coupling, stray field and motor
do not."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from twin.angles import Array
from twin.chain import Chain
from twin.limits import OutOfRangeError
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement
from twin.motion import Motion
from twin.turned_sensor import with_sensor_turned

STEP_DEG, TURN_DEG = 5.0, 35.0
MOTION = Motion.from_angle(np.radians(np.arange(0.0, 360.0, STEP_DEG)))
ROWS = int(TURN_DEG / STEP_DEG)


def errors(chain: Chain, motion: Motion) -> Array:
    return np.asarray(chain.error(motion))


@pytest.mark.parametrize(
    ("key", "values", "with_sensor"),
    [
        ("offset", {"x_percent": 0.5}, True),
        ("gain_mismatch", {"ratio": 1.01}, True),
        ("magnet_misalignment", {"product_mm2": 0.02, "phase_deg": 20.0}, True),
        ("cardan_coupling", {"amplitude_deg": 0.1, "phase_deg": 20.0}, False),
        ("reference_eccentricity", {"amplitude_deg": 0.1, "phase_deg": 20.0}, False),
    ],
)
def test_what_turns_with_the_sensor(key: str, values: dict[str, Any], with_sensor: bool) -> None:
    chain = Chain().with_effect("zero", zero_deg=10.0).with_effect(key, **values)
    turned, motion = with_sensor_turned(chain, MOTION, TURN_DEG)
    # Turned by whole steps of the motion: what goes along does so exactly, but for rounding.
    assert turned.values["zero"]["zero_deg"] == pytest.approx(10.0 - TURN_DEG)
    before, after = errors(chain, MOTION), errors(turned, motion)
    moved = np.roll(before, ROWS if with_sensor else 0)
    np.testing.assert_allclose(after - np.mean(after), moved - np.mean(moved), atol=1e-12)
    assert np.max(np.abs(before - np.mean(before))) > 1e-4


@pytest.mark.parametrize("described", [True, False])
def test_a_stray_field_stays(described: bool) -> None:
    """Its error is of order 1 of the shaft to leading order: (0.2 / B)^2 is left, B being the magnet's field in mT."""
    assembly = Assembly(placement=Placement(stray_x_mT=0.2 if described else 0.0))
    chain = Chain().with_magnet(assembly)
    if not described:
        chain = chain.with_effect("stray_field", bx_mT=0.2)
    turned, motion = with_sensor_turned(chain, MOTION, TURN_DEG)
    before, after = errors(chain, MOTION), errors(turned, motion)
    np.testing.assert_allclose(after - np.mean(after), before - np.mean(before), atol=1e-6)
    assert np.ptp(before) == pytest.approx(0.4 / assembly.nominal_mT, rel=0.01)


def test_a_motor_stays() -> None:
    """As a stray field of as many millitesla does."""
    running = replace(MOTION, current_a=np.full(len(MOTION), 2.0))
    chain = Chain().with_effect("motor_field", bx_mT_per_A=0.1)
    turned, motion = with_sensor_turned(chain, running, TURN_DEG)
    before, after = errors(chain, running), errors(turned, motion)
    np.testing.assert_allclose(after - np.mean(after), before - np.mean(before), atol=1e-5)
    assert np.ptp(before) == pytest.approx(0.4 / 50.0, rel=0.01)


def test_a_turn_out_of_range_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="mounting is 400 deg; expected from -360 to 360 deg"):
        with_sensor_turned(Chain(), MOTION, 400.0)
