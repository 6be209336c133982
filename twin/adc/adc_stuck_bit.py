"""adc_stuck_bit: one bit of the converter's offset binary code never changes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.adc.adc_quantisation import FULL_SCALE
from twin.angles import Array
from twin.drawing import YARDSTICK_DEG
from twin.effect import BoolArray, Effect, Line, Param, Parameters
from twin.motion import Motion

HARMONICS = 6
BITS = 14
"""Word length that the bit's number is counted in (the paper's converter)."""
WORDS = (12, 16)
"""Shortest and longest word that the converter of an angle sensor is taken to have."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # Mid-scale is a multiple of two steps for all but the highest two bits, so the bit's value depends on the signal
    # and the step alone, not on full scale. A bit held at its level shifts the mean by half a step one way or the
    # other; that shift belongs to the offset, so the bit is read from the signal with it taken back.
    step = 0.01 * np.abs(np.asarray(values["step_percent"], dtype=np.float64))
    safe = np.where(step > 0.0, step, 1.0)
    level = np.asarray(values.get("level", 0.0))
    blur = 0.01 * np.asarray(values.get("blur_percent", 0.0))
    if rng is not None or np.all(blur == 0.0):
        held = 0.5 - np.floor(signal / safe + (0.5 - level)) % 2.0
    else:
        # In expectation, noise ahead of the converter smooths the square wave: each harmonic by its own Gaussian.
        held = np.zeros(np.broadcast_shapes(signal.shape, np.shape(step)))
        for k in range(1, 2 * HARMONICS, 2):
            sign = (1.0 - 2.0 * level) * (-1.0) ** (k // 2)
            damping = np.exp(-0.5 * (np.pi * k * blur / safe) ** 2)
            held = held + sign * (2.0 / (np.pi * k)) * damping * np.cos(np.pi * k * signal / safe)
    return signal + np.where(step > 0.0, step * held, 0.0)


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """The bit's number in a 14-bit code whose full scale lies between 1 and 2 amplitudes.

    Neither is known: low and high are those of words of 12 to 16 bits, full scale from 1 to 4 amplitudes.
    """
    step = 0.01 * float(np.ravel(values["step_percent"])[0])
    if step <= 0.0:
        return {"bit": (0.0, 0.0, 0.0, "bit")}
    # Full scale is step 2^halvings.
    halvings = float(np.ceil(-np.log2(step)))
    low, high = (bits - 1.0 - halvings for bits in WORDS)
    return {"bit": (max(BITS - 1.0 - halvings, 0.0), max(low - 1.0, 0.0), max(high, 0.0), "bit")}


def within(step_percent: Array) -> BoolArray:
    """Which weights (any shape) a bit below the highest two can have."""
    return np.asarray((step_percent > 0.0) & (step_percent < 30.0))


def begin(step_percent: float, sign: float) -> Mapping[str, float]:
    """Held at 0 the bit leaves +cos(pi x / step) once its mean is in the offset; held at 1, the opposite.

    Noise ahead of the bit of a fifth of its weight to begin with: a fit finds its own.
    """
    return {"level": 0.0 if sign > 0.0 else 1.0, "blur_percent": 0.2 * step_percent}


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A bit of weight w errs by up to w / 2 in each channel: 0.1 deg is 0.35 % of the amplitude."""
    full_scale_percent = 200.0 * FULL_SCALE
    weight = 0.35 * strength_deg / YARDSTICK_DEG
    return {
        "step_percent": full_scale_percent * 2.0 ** np.round(np.log2(weight / full_scale_percent)),
        "level": np.where(uniform[:, 0] < 0.5, 0.0, 1.0),
    }


ADC_STUCK_BIT = Effect(
    name="adc_stuck_bit",
    stage="adc",
    acts_on="channels",
    params={
        # The converter's range is fixed in volts, and so is a bit's weight.
        "step_percent": Param(
            unit="%", null=0.0, lower=0.0, upper=30.0, doc="weight of the bit", role="level", field_power=-1.0
        ),
        # With y turned over a bit held at one is a bit held at zero, but in y alone: no level does that.
        "level": Param(unit="1", null=0.0, lower=0.0, upper=1.0, doc="stuck at", role="shape", counts=True, mirror=0),
        "blur_percent": Param(
            unit="%",
            null=0.0,
            lower=0.0,
            upper=1.0,
            doc="noise ahead of the bit",
            role="shape",
            typical=0.03,
            field_power=-1.0,
        ),
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    derived=derived,
    zoomed=("step_percent",),
    fitted_shapes=("step_percent", "blur_percent"),
    line=Line(param="step_percent", clock="channels", limits=lambda motion: (0.04, 4.0), within=within, begin=begin),
    drawing=drawing,
    source="offset binary code with one bit held; its mean goes into the offset",
    signature="0 or one step per channel: a square pattern in code",
)
