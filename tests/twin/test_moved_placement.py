"""A magnet that has been moved reads as one that is described there, and is described there once it is settled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from twin.air_gap import at_air_gap
from twin.chain import Chain
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement
from twin.motion import Motion
from twin.moved_placement import PLACEMENT, movable, settled
from twin.presets import read_preset

TURN = Motion.from_angle(np.radians(np.arange(0.0, 360.0, 3.0)))
PLACE = Placement(sensor_x_mm=0.6, sensor_y_mm=-0.2, magnet_y_mm=0.4, sensor_tilt_x_deg=2.0, stray_x_mT=0.3)
SENSOR = Chain(magnet=Assembly(placement=PLACE)).with_effect("offset", x_percent=0.4).with_effect("phase", beta_deg=0.3)
MOVED = {"sensor_x_mm": 0.9, "magnet_tilt_y_deg": -3.0, "stray_y_mT": 0.5, "air_gap_mm": 1.9}


def at(chain: Chain, name: str, value: float) -> Chain:
    """The same device with one number of its placement another: at another gap by way of its field."""
    if name == "air_gap_mm":
        return at_air_gap(chain, value)
    assert chain.magnet is not None
    return chain.with_magnet(replace(chain.magnet, placement=replace(chain.magnet.placement, **{name: value})))


@pytest.mark.parametrize("name", MOVED)
@pytest.mark.parametrize("sensor", [SENSOR, read_preset("hall-misaligned")], ids=["bare", "with disk and plates"])
def test_a_moved_magnet_reads_as_the_one_described_there(sensor: Chain, name: str) -> None:
    assert sensor.magnet is not None
    chain = movable(sensor)
    own = chain.with_values({PLACEMENT: {name: getattr(sensor.magnet.placement, name)}})
    # Rounding alone: the field's angle is found to the last digits.
    assert np.max(np.abs(own.readings(TURN) - sensor.readings(TURN))) < 1e-9
    moved = chain.with_values({PLACEMENT: {name: MOVED[name]}})
    there = at(sensor, name, MOVED[name])
    assert np.max(np.abs(moved.readings(TURN) - there.readings(TURN))) < 1e-9
    assert np.max(np.abs(moved.readings(TURN) - sensor.readings(TURN))) > 1e-4
    described = settled(moved)
    assert described.magnet is not None
    assert getattr(described.magnet.placement, name) == MOVED[name]
    assert PLACEMENT not in described.values
    assert np.array_equal(described.readings(TURN), there.readings(TURN))


def test_without_a_magnet_nothing_can_be_moved() -> None:
    chain = Chain()
    assert movable(chain) is chain
