"""The reference encoder and the drive's orders."""

from __future__ import annotations

import numpy as np
import pytest

from twin.angles import TAU
from twin.limits import OutOfRangeError
from twin.reference.encoder import Encoder, bldc_order, stepper_order

SHAFT = np.linspace(0.3, 9.0, 4001)


def test_counts_within_half_a_count() -> None:
    encoder = Encoder(lines=500, index_deg=10.0)
    reading = encoder.read(SHAFT)
    assert encoder.counts == 2000
    assert np.max(np.abs(reading - SHAFT)) <= 0.5 * TAU / 2000 * (1 + 1e-9)
    counts = (reading - np.radians(10.0)) / TAU * 2000
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)


def test_without_an_index_it_starts_at_zero() -> None:
    reading = Encoder(lines=5000, has_index=False).read(SHAFT)
    assert reading[0] == 0.0
    assert np.max(np.abs(reading - (SHAFT - SHAFT[0]))) <= 0.5 * TAU / 20000 * (1 + 1e-9)


def test_orders_of_drives() -> None:
    assert stepper_order(200) == 50
    assert bldc_order(7) == 42


def test_refuses_by_name_value_and_range() -> None:
    with pytest.raises(OutOfRangeError, match="lines is 0; expected a whole number from 1 to 1e"):
        Encoder(lines=0)
