"""Cosine and sine from the tangent of half the angle, and angles brought to one turn."""

from __future__ import annotations

import numpy as np
import pytest

from twin.angles import TAU, cos_sin, wrap

EPS = float(np.finfo(np.float64).eps)


@pytest.mark.parametrize("turns", [1.0, 100.0, 1e6])
def test_cosine_and_sine_to_the_last_digits(turns: float) -> None:
    angle = np.random.default_rng(0).uniform(-turns, turns, (3, 40_000)) * 2.0 * np.pi
    cosine, sine = cos_sin(angle)
    assert cosine.shape == sine.shape == angle.shape
    np.testing.assert_allclose(cosine, np.cos(angle), rtol=0.0, atol=4 * EPS)
    np.testing.assert_allclose(sine, np.sin(angle), rtol=0.0, atol=4 * EPS)


def test_at_the_axes() -> None:
    angle = 0.5 * np.pi * np.arange(-8, 9)
    for near in (angle, np.nextafter(angle, np.inf), np.nextafter(angle, -np.inf)):
        cosine, sine = cos_sin(near)
        np.testing.assert_allclose(cosine, np.cos(near), rtol=0.0, atol=2 * EPS)
        np.testing.assert_allclose(sine, np.sin(near), rtol=0.0, atol=2 * EPS)


def test_of_one_and_of_none() -> None:
    assert [float(one) for one in cos_sin(np.float64(0.0))] == [1.0, 0.0]
    assert all(one.shape == (0,) for one in cos_sin(np.empty(0)))
    assert all(one.shape == (2, 3) for one in cos_sin(np.zeros((3, 2)).T))


@pytest.mark.parametrize("size", [100, 20_000])
@pytest.mark.parametrize("turns", [0.4, 0.5, 30.0])
def test_many_angles_are_wrapped_as_few_are(size: int, turns: float) -> None:
    angle = np.random.default_rng(1).uniform(-turns, turns, size) * TAU
    angle[:5] = [np.pi, -np.pi, np.nan, 3.0 * np.pi, np.nextafter(np.pi, 0.0)]
    np.testing.assert_array_equal(wrap(angle), (angle + np.pi) % TAU - np.pi)
    assert wrap(angle.reshape(2, -1)).shape == (2, size // 2)
