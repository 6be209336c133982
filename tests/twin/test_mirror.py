"""The chain that counts the other way on both sides reads the same; a single effect's promise is in tests/contract."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.contract.examples import EXAMPLES
from twin.angles import Array, wrap
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.example import full_motion
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import Motion

# Off the axes, where quantisers fall to either side by rounding.
MOTION = replace(full_motion(), shaft_rad=full_motion().shaft_rad + 0.01234)
ROUNDING_RAD = 1e-11
"""Forty operations of some 1e-13 on angles of up to 12 rad."""
MISPLACED = Assembly(
    Magnet(),
    Placement(
        sensor_x_mm=0.3,
        sensor_y_mm=-0.2,
        sensor_tilt_x_deg=2.0,
        sensor_tilt_y_deg=-3.0,
        magnet_x_mm=0.1,
        magnet_y_mm=0.25,
        magnet_tilt_x_deg=1.5,
        magnet_tilt_y_deg=4.0,
        stray_x_mT=0.4,
        stray_y_mT=-0.7,
        stray_z_mT=0.9,
    ),
)


def chain_of(*names: str, magnet: Assembly | None = None, **more: Any) -> Chain:
    """The examples of these effects, all at once."""
    chain = Chain(**more) if magnet is None else Chain(**more).with_magnet(magnet)
    for name in names:
        chain = chain.with_effect(name, **EXAMPLES[name].params)
    return chain


def apart(chain: Chain, motion: Motion = MOTION) -> Array:
    """What the mirrored chain reads more [rad] (n,)."""
    return wrap(chain.mirrored().readings(motion) - chain.readings(motion))


@pytest.mark.parametrize("magnet", [None, MISPLACED], ids=["ideal field", "misplaced magnet"])
@pytest.mark.parametrize(("sensor", "output"), list(itertools.product((1, -1), (1, -1))))
def test_all_effects_at_once(sensor: int, output: int, magnet: Assembly | None) -> None:
    # Steps make jumps of what the others' rounding moves across their edges.
    stepped = {"output_quantisation", "cordic_truncation"}
    names = [effect.name for effect in CATALOGUE if effect.mirrors and effect.name not in stepped]
    chain = chain_of(*names, sensor_sense=sensor, output_sense=output, magnet=magnet)
    assert np.max(np.abs(apart(chain))) < ROUNDING_RAD
    mirrored = chain.mirrored()
    assert (mirrored.sensor_sense, mirrored.output_sense) == (-sensor, -output)


def test_only_the_quadratic_term_tells_the_sense() -> None:
    """c + q c^2 in y becomes c - q c^2: the angle loses twice q sin^2 a cos a, to the next order in q."""
    q = 0.003
    off = apart(Chain().with_effect("quadratic_nonlinearity", q_percent=100.0 * q))
    a = MOTION.shaft_rad
    np.testing.assert_allclose(off, -2.0 * q * np.sin(a) ** 2 * np.cos(a), atol=4.0 * q**2)


def test_an_amplitude_stays_one() -> None:
    mirrored = Chain().with_effect("unnamed_order", order=11.0, amplitude_deg=0.2, phase_deg=35.0).mirrored()
    assert mirrored.values["unnamed_order"] == {"order": 11.0, "amplitude_deg": 0.2, "phase_deg": 35.0 - 180.0}


def test_zeros_of_turns_from_a_file_are_negated_one_by_one() -> None:
    values = EXAMPLES["unnamed_drift"].params
    chain = Chain().with_values({"unnamed_drift": values, "reference_rezero": {"zeros_deg": [0.1, -0.2]}})
    mirrored = chain.mirrored().values
    assert mirrored["unnamed_drift"] == {name: -value for name, value in values.items()}
    assert mirrored["reference_rezero"] == {"zeros_deg": [0.1, -0.2]}


@pytest.mark.parametrize("effect", [e for e in CATALOGUE if e.spread is not None], ids=lambda effect: effect.name)
def test_a_spread_is_the_same_on_both_sides_of_the_axis(effect: Any) -> None:
    values = {**effect.null(), **EXAMPLES[effect.name].params}
    angle = MOTION.shaft_rad
    np.testing.assert_allclose(effect.spread(-angle, values), effect.spread(angle, values), rtol=1e-9, atol=1e-30)
