"""A stuck bit: what it does to the mean of readings whose noise lies ahead of it."""

from __future__ import annotations

import numpy as np
import pytest

from twin.adc.adc_stuck_bit import ADC_STUCK_BIT, NEAR
from twin.motion import Motion


@pytest.mark.parametrize("in_approximation", [0.0, 1.0])
@pytest.mark.parametrize("level", [0.0, 1.0])
@pytest.mark.parametrize("blur", [0.02, 0.99 * NEAR, 1.01 * NEAR, 0.6])
def test_the_mean_is_that_over_the_noise(level: float, in_approximation: float, blur: float) -> None:
    """By a Riemann sum over the noise's density, of which an edge of half an amplitude may take half a spacing."""
    weight, spacing = 0.5, 1e-3
    signal = np.linspace(-1.5, 1.5, 91)
    rest = Motion.from_angle(np.zeros(signal.size))
    values = {"step_percent": 100.0 * weight, "level": level, "in_approximation": in_approximation}
    noise = np.arange(-6.0, 6.0, spacing)
    density = np.exp(-0.5 * noise**2) / np.sqrt(2.0 * np.pi)
    behind = signal[:, None] + weight * blur * noise
    sharp = ADC_STUCK_BIT.forward(behind, rest, {**values, "blur_percent": 0.0}, None)
    mean = ADC_STUCK_BIT.forward(signal, rest, {**values, "blur_percent": 100.0 * weight * blur}, None)
    assert np.max(np.abs(mean - spacing * sharp @ density)) < weight * 0.5 * spacing * np.max(density) * 1.05
