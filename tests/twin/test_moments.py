"""Moments of a misplaced magnet: what a sensor off the axis sees of a magnet that is uneven, or not round."""

from __future__ import annotations

import numpy as np
import pytest

from twin.chain import Chain
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.magnet.third_moment import third_moment_per_mm2
from twin.motion import Motion

TURN = Motion.from_angle(np.arange(720) * np.pi / 360.0)


def added(**parameters: float) -> np.ndarray:
    """What the effect adds to the field, x + iy."""
    x, y = Chain().with_effect("magnet_misalignment", **parameters).channels(TURN)
    return np.asarray(x + 1j * y) - np.exp(1j * TURN.shaft_rad)


@pytest.mark.parametrize("sides", [(6.0, 6.0), (8.0, 5.0), (5.0, 8.0)], ids=str)
def test_the_third_moment_is_what_a_sensor_off_the_axis_sees_of_a_block(sides: tuple[float, float]) -> None:
    """The component of the field that turns three times a turn; the next term is the square of 0.1 over 4 mm."""
    magnet, towards = Magnet(shape="block", length_mm=sides[0], width_mm=sides[1]), 0.1 * np.exp(0.7j)
    place = Placement(air_gap_mm=1.5, sensor_x_mm=towards.real, sensor_y_mm=towards.imag)
    x, y = Chain(magnet=Assembly(magnet, place)).channels(TURN)
    third = np.mean((x + 1j * y) * np.exp(-3j * TURN.shaft_rad))
    # The middle of an edge may lie nearer than a corner: the sizes of all three are those of the square's.
    square = third_moment_per_mm2(Magnet(shape="block"), 2.75) * 0.1**2
    expected = third_moment_per_mm2(magnet, 2.75) * np.conj(towards) ** 2
    assert abs(third - expected) < 0.01 * square
    # And so is the effect, in the field of a described block.
    ideal = Chain().with_magnet(Assembly(magnet, Placement(air_gap_mm=1.5)))
    effect = ideal.with_effect("magnet_misalignment", moment=3, product_mm2=0.01, phase_deg=np.degrees(1.4))
    added = effect.channels(TURN) - ideal.channels(TURN)
    np.testing.assert_allclose(added[0] + 1j * added[1], expected * np.exp(3j * TURN.shaft_rad), atol=1e-9)


def test_a_sensor_alone_off_the_axis_sees_a_field_that_turns_the_other_way() -> None:
    """The same as its displacement by itself to leading order, the rest being the fourth power of 0.1 over 3 mm."""
    moment = added(moment=1, product_mm2=0.01, phase_deg=60.0)
    displaced = added(off_axis_mm=0.1, direction_deg=30.0)
    against = np.mean(displaced * np.exp(1j * TURN.shaft_rad))
    np.testing.assert_allclose(moment, against * np.exp(-1j * TURN.shaft_rad), atol=1e-5 * 0.1)


def test_an_uneven_magnet_has_the_second_moment_of_a_displaced_one() -> None:
    """Beside what an offset does, and without the orders that the displacement adds."""
    both = {"product_mm2": 0.02, "phase_deg": -40.0, "direction_deg": 20.0}
    displaced, uneven = added(**both), added(uneven=1.0, **both)
    second = np.mean(displaced * np.exp(-2j * TURN.shaft_rad))
    # To leading order: the next is the square of the displacements, 0.14 mm, over 3 mm.
    np.testing.assert_allclose(uneven, second * np.exp(2j * TURN.shaft_rad), atol=0.01 * abs(second))


def test_plates_that_are_not_at_right_angles_bend_no_moment() -> None:
    """They mix the field with its mirror image, which has no order that turns four times with the shaft."""
    chain = Chain().with_effect("phase", beta_deg=1.0)
    x, y = chain.with_effect("magnet_misalignment", product_mm2=0.08, uneven=1.0).channels(TURN)
    fourth = np.mean((x + 1j * y) * np.exp(-4j * TURN.shaft_rad))
    second = np.mean((x + 1j * y) * np.exp(-2j * TURN.shaft_rad))
    # In first order of the plates' angle it would be half of it, 9e-3.
    assert abs(fourth) < 1e-4 * abs(second)
