"""The described converter as it acts on the chain: when it samples x and y, and what its codes make of their values."""

from __future__ import annotations

import numpy as np

from twin.adc.converter import Converter, convert, instants
from twin.angles import TAU, Array
from twin.effect import Effect, Parameters
from twin.motion import Motion
from twin.part import part

SOURCE = "the converter as described in [hardware.converter]"


def described(converter: Converter) -> tuple[Effect, ...]:
    """The converter as operations on the shaft's angle at both samplings, and on the channels' values."""

    def sample(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        # A reading is paired with the reference when its code is ready.
        late = instants(np.zeros(len(motion)), converter, rng) - converter.latency_s
        return np.asarray(signal + late * motion.speed_rad_s)

    def digitise(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        start = np.stack([motion.time_s, motion.time_s + converter.gap_s])
        if rng is None:
            return expected(signal, start, converter)
        return np.asarray(convert(signal, start, converter, rng) * converter.step)

    noisy = converter.noise_rms > 0.0 or converter.reference_rms > 0.0
    shaft = part("sampling", "adc", sample, SOURCE, noisy=converter.aperture_s > 0.0, acts_on="shaft")
    return shaft, part("converter", "adc", digitise, SOURCE, noisy=noisy)


def expected(values: Array, at_s: Array, converter: Converter) -> Array:
    """What the codes of values (..., 2, n) are in expectation: noise ahead of them smooths the steps.

    A bit that is stuck is none of this: describe it by the effect ``adc_stuck_bit``.
    """
    held = values * np.array([[1.0], [1.0 - converter.droop_per_s * converter.gap_s]])
    seen = held / (1.0 + converter.ripple * np.cos(TAU * converter.ripple_Hz * at_s))
    u = np.clip(seen / converter.full_scale, -1.0, 1.0)
    # Where its curve lies too high a code comes too late.
    return np.asarray(u * converter.full_scale - converter.bow(u) * converter.step)
