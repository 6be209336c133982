"""States whose readings scatter unevenly, by a known amount."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.state import Stage, State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.adc.reference_jitter import spread as jitter_variance

NOISE_DEG = 0.02
MADE = Made(points=180, turns=2, bits=30)


@dataclass(frozen=True, kw_only=True)
class Loud:
    """Noise of 0.02 deg, ``stretch`` times that in ``length`` rows from ``first`` on, and a converter's jitter [%]."""

    stretch: float = 1.0
    first: int = 100
    length: int = 40
    jitter_percent: float = 0.0


def handed(stage: Stage, loud: Loud) -> State:
    """The state that a stage is handed, with readings that scatter so about its fit."""
    state = before(stage, MADE)
    angle = state.fit.linear.sensor_angle
    variance = np.full(angle.size, np.radians(NOISE_DEG) ** 2)
    variance[loud.first : loud.first + loud.length] *= loud.stretch**2
    variance += jitter_variance(angle, {"percent_rms": loud.jitter_percent})
    return with_residual(state, noise(angle.size, 1.0) / np.radians(1.0) * np.sqrt(variance))
