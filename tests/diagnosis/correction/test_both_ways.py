"""Held-out readings of a sweep there and back: what the ways differ by is no error of the correction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.correction.both_ways import between_ways
from diagnosis.thermal.recording import Recording
from scenarios.commands.compensate_judge import held_out, on_others
from scenarios.commands.compensate_source import readings_of
from twin.angles import TAU, Array
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.decoded import Decoded, decoded
from twin.motion import Motion

LAG_DEG = 0.3


def there_and_back(seed: int, *, turns: int, off: float = 0.0) -> Decoded:
    way = TAU * (np.arange(180 * turns) + off) / 180
    motion = Motion.from_angle(np.concatenate([way, way[::-1]]), direction=np.repeat([1.0, -1.0], way.size))
    chain = Chain().with_effect("offset", x_percent=0.8, y_percent=-0.5).with_effect("noise", rms_deg=0.02)
    return decoded(
        chain.with_effect("hysteresis", lag_deg=LAG_DEG, memory_deg=5.0).simulate(motion, seed=seed), CATALOGUE
    )


@pytest.mark.parametrize("turns", [1, 2])
def test_held_out_readings_err_as_those_of_a_fresh_sweep(turns: int) -> None:
    """By blocks of one way, which a correction of the other way alone misses by twice the lag: 1.9 and 1.25 times."""
    readings = readings_of([there_and_back(1, turns=turns)], tolerance_deg=1e-4, seed=0)
    (own,) = held_out(readings)
    (fresh,) = on_others(readings.correction.shaft, [there_and_back(2, turns=turns, off=0.37)])
    assert fresh.found.rms_deg[1] == pytest.approx(LAG_DEG, rel=0.05)
    assert own.found.rms_deg[1] == pytest.approx(fresh.found.rms_deg[1], rel=0.08)


def recording(way: Array, *, counts: float = 1.0) -> Recording:
    reference = TAU * np.mod(np.arange(way.size), 200) / 200
    own = counts * reference + 0.01 * np.sin(reference) + way * (0.004 + 0.002 * np.cos(2.0 * reference))
    one = Recording.at_one_temperature(reference, np.mod(own + 1.0, TAU), 25.0)
    return replace(one, direction=way)


@pytest.mark.parametrize("counts", [1.0, -1.0])
def test_readings_lie_between_the_ways(counts: float) -> None:
    """Of a sensor that counts either way."""
    both = recording(np.repeat([1.0, -1.0], 200), counts=counts)
    between = between_ways(both)
    apart = between.measured_rad[:200] - between.measured_rad[200:]
    assert np.max(np.abs(np.angle(np.exp(1j * apart)))) < 1e-9


def test_readings_of_one_way_stay_as_they_are() -> None:
    one = recording(np.ones(400))
    assert between_ways(one) is one
    # A few rows back at one place are no second way.
    few = recording(np.where(np.arange(400) < 390, 1.0, -1.0))
    assert between_ways(few) is few
