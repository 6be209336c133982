"""Shapes that act with every strength at its null: declared as such, and in a twin without any strength."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from twin.air_gap import at_air_gap
from twin.angles import Array
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.effect import Effect
from twin.example import full_motion, signal_for
from twin.files import read_twin, write_twin
from twin.magnet.assembly import Assembly
from twin.motion import Motion

STAGE = {"first_stage_lsb": 40.0}
MOTION = full_motion()
TURN = Motion.from_angle(np.radians(np.arange(0.0, 360.0)))


def done(effect: Effect, **values: float) -> Array:
    """What the operations of an effect, one after the other, make of their signals where all else is at its null."""
    full = {**effect.null(), **values}
    # Some act on a signal's error alone.
    error = 0.01 * np.cos(2.0 * MOTION.shaft_rad)
    signals = ((one, signal_for(one, MOTION) + error) for one in effect.operations)
    return np.concatenate([one.forward(signal, MOTION, full, None) for one, signal in signals])


@pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.name)
def test_a_shape_is_declared_to_act_by_itself_where_it_does(effect: Effect) -> None:
    nothing = done(effect)
    for name, param in effect.params.items():
        if param.role in ("shape", "phase"):
            ends = (end for end in (param.lower, param.upper) if end != param.null)
            acts = any(not np.array_equal(done(effect, **{name: end}), nothing) for end in ends)
            assert acts == param.by_itself, name


def test_a_stage_that_is_off_acts_alone() -> None:
    """A step of 40 LSB of 14 bit at 125 % full scale is 0.6 % of the amplitude, of which the line takes back a part."""
    alone = Chain().with_effect("adc_inl", **STAGE)
    beside = Chain().with_effect("adc_inl", bow_lsb=1e-9, **STAGE)
    np.testing.assert_allclose(alone.error(TURN), beside.error(TURN), rtol=0.0, atol=1e-12)
    assert 0.2 < np.degrees(np.ptp(alone.error(TURN))) < 0.6


def test_a_filter_without_delay_is_written(tmp_path: Path) -> None:
    write_twin(tmp_path / "twin.toml", Chain().with_effect("latency", variance_ms2=4.0))
    assert read_twin(tmp_path / "twin.toml").values["latency"]["variance_ms2"] == 4.0


def test_a_stage_that_is_off_is_written_and_follows_the_field(tmp_path: Path) -> None:
    chain = Chain().with_magnet(Assembly()).with_effect("adc_inl", **STAGE)
    write_twin(tmp_path / "twin.toml", chain)
    assert read_twin(tmp_path / "twin.toml").values["adc_inl"]["first_stage_lsb"] == 40.0
    # In the weaker field the converter's range is more of the amplitudes.
    far = at_air_gap(chain, 3.0)
    assert far.values["adc_inl"]["full_scale_percent"] > chain.values["adc_inl"]["full_scale_percent"]
