"""A harmonic of the magnet: beside a cylinder the size of its field changes with the direction."""

from __future__ import annotations

import numpy as np
import pytest

from twin.chain import Chain
from twin.magnet.magnet_harmonic import shapes
from twin.motion import Motion

TURN = Motion.from_angle(np.arange(720) * np.pi / 360.0)


@pytest.mark.parametrize("order", [3, 5, 8])
def test_the_field_of_a_cylinder_beside_its_dipoles(order: int) -> None:
    """A potential that falls as the nth power of the distance has a field that turns n - 1 times more than a dipole.

    Beside the effect the square of its share is left, and order times that in the size, which is counted from where the
    shaft is.
    """
    share, phase = 0.002, 0.7
    field = np.exp(1j * TURN.shaft_rad) * (1.0 + share * np.exp(1j * (order * TURN.shaft_rad + phase)))
    line = {"order": order, "amplitude_deg": np.degrees(share), "phase_deg": np.degrees(phase)}
    x, y = Chain().with_effect("magnet_harmonic", **line, radius_ratio=1.0).channels(TURN)
    np.testing.assert_allclose(x + 1j * y, field, atol=(1.0 + order) * share**2)
    x, y = Chain().with_effect("magnet_harmonic", **line).channels(TURN)
    np.testing.assert_allclose(np.hypot(x, y), 1.0, atol=1e-12)


def orders(points_a_turn: float) -> set[float]:
    """Orders that are looked for in forty turns with so many readings each."""
    motion = Motion.from_angle(np.arange(int(40 * points_a_turn)) * 2.0 * np.pi / points_a_turn)
    return {shape["order"] for shape in shapes(motion)}


def test_turns_at_other_angles_tell_finer_structure() -> None:
    """Eleven readings a turn, in each turn at the same angles, and about as many that are not."""
    assert orders(11.0) == {3.0, 4.0, 5.0}
    assert orders(11.1) == {3.0, 4.0, 5.0, 6.0, 7.0, 8.0}
