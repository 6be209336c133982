"""The concentrator's disk: gain, and what shift and rough edge do to the axes."""

from __future__ import annotations

import numpy as np
import pytest

from twin.chain import Chain
from twin.concentrator.disk import Disk, vertical_mT
from twin.limits import OutOfRangeError
from twin.motion import Motion

TURN = Motion.from_angle(np.arange(360) * np.pi / 180.0)


def field(amplitude_mT: float) -> np.ndarray:
    return amplitude_mT * np.stack([np.cos(TURN.shaft_rad), np.sin(TURN.shaft_rad)])


def test_a_centred_disk_only_amplifies() -> None:
    disk = Disk()
    np.testing.assert_allclose(vertical_mT(field(50.0), disk), 6.0 * field(50.0), atol=1e-9)
    assert disk.orthogonality_deg == pytest.approx(0.0, abs=1e-12)
    assert disk.ratio == pytest.approx(1.0, abs=1e-12)


def test_a_shift_along_one_axis_leaves_them_square_and_along_both_does_not() -> None:
    assert Disk(shift_x_um=2.0).orthogonality_deg == pytest.approx(0.0, abs=1e-9)
    assert abs(Disk(shift_x_um=2.0).ratio - 1.0) > 1e-3
    assert abs(Disk(shift_x_um=2.0, shift_y_um=2.0).orthogonality_deg) > 0.01


def test_the_disk_is_zero_phase_and_gain_mismatch() -> None:
    disk = Disk(shift_x_um=3.0, shift_y_um=-2.0, roughness_um=0.2, part=5)
    channels = vertical_mT(field(1.0), disk)
    chain = Chain().with_effect("zero", zero_deg=-disk.axis_deg).with_effect("phase", beta_deg=disk.orthogonality_deg)
    chain = chain.with_effect("gain_mismatch", ratio=disk.ratio)
    assert abs(disk.orthogonality_deg) > 0.05
    np.testing.assert_allclose(np.arctan2(channels[1], channels[0]), chain.readings(TURN), atol=1e-12)


def test_rough_edges_differ_from_part_to_part() -> None:
    parts = [Disk(roughness_um=0.1, part=part).orthogonality_deg for part in range(200)]
    # Each axis turns by the mean of two edges' slopes of 0.1 / 20 RMS, the angle between them by sqrt(2) / sqrt(2).
    assert np.std(parts) == pytest.approx(np.degrees(0.1 / 20.0), rel=0.25)


def test_saturation_is_the_cubic_term_of_tanh() -> None:
    disk = Disk(saturation_mT=500.0)
    k = 0.01 * disk.k_percent(50.0)
    share = np.linspace(-1.0, 1.0, 21)
    np.testing.assert_allclose(10.0 * np.tanh(0.1 * share), share - k * share**3, atol=2e-5)


def test_refuses_by_name_value_and_range() -> None:
    with pytest.raises(OutOfRangeError, match=r"shift_x_um is 80 um; expected from -50 to 50 um"):
        Disk(shift_x_um=80.0)
