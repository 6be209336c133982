"""adc_stuck_bit: one bit of the converter's offset binary code never changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from twin.adc.adc_quantisation import FULL_SCALE
from twin.angles import Array
from twin.drawing import YARDSTICK_DEG
from twin.effect import BoolArray, Effect, Line, Param, Parameters
from twin.motion import Motion

NEAR = 0.25
"""Noise, in steps, up to which ends one and a half steps away, and beyond which the ninth harmonic, are below 1e-8."""
TINY = 1e-9
"""Noise, in steps, that stands for none."""
_K = np.arange(1, 9)
_MISSED = np.where(_K % 2 == 1, (-1.0) ** (_K // 2) * 2.0 / (np.pi * _K), 0.0) + 0j
_MADE_UP = np.exp(0.25j * np.pi * _K) * (-1j / (np.pi * _K) - np.where(_K % 2 == 1, 2.0 / (np.pi * _K) ** 2, 0.0))
BITS = 14
"""Word length that the bit's number is counted in (the paper's converter)."""
WORDS = (12, 16)
"""Shortest and longest word that the converter of an angle sensor is taken to have."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # Mid-scale is a multiple of two steps for all but the highest two bits, so the bit's value depends on the signal
    # and the step alone, not on full scale. A bit held at its level shifts the mean by a share of a step one way or the
    # other; that shift belongs to the offset, so the bit is read from the signal with it taken back.
    step = 0.01 * np.abs(np.asarray(values["step_percent"], dtype=np.float64))
    safe = np.where(step > 0.0, step, 1.0)
    # Counted from the level at which it is held: a bit held at one does to -c what one held at zero does to c.
    side = 1.0 - 2.0 * np.asarray(values.get("level", 0.0))
    blur = 0.01 * np.asarray(values.get("blur_percent", 0.0)) / safe
    if rng is not None or bool(np.all(blur == 0.0)):
        blur = np.zeros(())
    value, cut_off = side * signal / safe, np.asarray(values.get("in_approximation", 0.0)) == 1.0
    if np.all(cut_off) or not np.any(cut_off):
        moved = _moved(value, blur, made_up=bool(np.any(cut_off)))
    else:
        # In a batch each entry has its own form.
        moved = np.empty(np.broadcast_shapes(value.shape, blur.shape, cut_off.shape))
        each = np.broadcast_to(cut_off, (*moved.shape[:-2], 1, 1))[..., 0, 0]
        value, blur = np.broadcast_to(value, moved.shape), np.broadcast_to(blur, (*moved.shape[:-2], 1, 1))
        for form in (False, True):
            moved[each == form] = _moved(value[each == form], blur[each == form], made_up=form)
    return signal + np.where(step > 0.0, step * side * moved, 0.0)


def _moved(value: Array, blur: Array, *, made_up: bool) -> Array:
    """What the bit does to values, in its steps: exactly without a blur, else what is expected."""
    if not np.any(blur):
        return _made_up(value) if made_up else _missed(value)
    return _expected(_made_up_ends, _MADE_UP, value, blur) if made_up else _expected(_missed_ends, _MISSED, value, blur)


def _within_two(value: Array) -> Array:
    """The remainder of a division by two: in a tenth of the time that the operator takes, and as exact."""
    return np.asarray(value - 2.0 * np.floor(0.5 * value))


def _missed(value: Array) -> Array:
    """What a bit held at zero leaves of a value, both in its steps, less its mean: half a step more, or less."""
    return np.asarray(0.5 - _within_two(np.floor(value + 0.5)))


def _made_up(value: Array) -> Array:
    """The same where the lower bits fill up in its place: what is beyond them is cut off."""
    return np.asarray(0.25 - np.maximum(_within_two(value + 0.25) - 1.0, 0.0))


def _expected(ends: Callable[[Array, Array], Array], waves: NDArray[np.complex128], value: Array, blur: Array) -> Array:
    """Either of the two in expectation, of a value in Gaussian noise whose standard deviation is `blur`, in steps.

    By the ends of the next few ranges where the noise is small, else by the first harmonics of the two steps in which
    all repeats (`waves`, amplitudes of exp(i pi k value)), each damped by the noise. Either is exact where it is taken:
    what is left out is less than 1e-8 of a step.
    """
    near = blur < NEAR
    safe = np.where(blur > 0.0, blur, TINY)
    if np.all(near):
        return ends(value, safe)
    out = np.zeros(np.broadcast_shapes(value.shape, np.shape(blur)))
    first = np.exp(1j * np.pi * value)
    wave = first
    for k, one in enumerate(waves, start=1):
        out += (one * wave).real * np.exp(-0.5 * (np.pi * k * blur) ** 2)
        # Sines and cosines cost more than the power of the one before.
        wave = wave * first
    return np.where(near, ends(value, np.minimum(safe, NEAR)), out) if np.any(near) else out


def _missed_ends(value: Array, blur: Array) -> Array:
    """Each range of a missed bit ends by a step down, each of the others by a step up."""
    from scipy.special import ndtr

    # It is even about the middle of a range.
    off = np.abs(_within_two(value + 1.0) - 1.0)
    return np.asarray(0.5 - ndtr((off - 0.5) / blur) - ndtr((off + 0.5) / -blur) + ndtr((off - 1.5) / blur))


def _made_up_ends(value: Array, blur: Array) -> Array:
    """Where lower bits make up for it, each range begins with a slope that its end takes back by a step."""
    from scipy.special import ndtr

    place = _within_two(value + 0.75) - 0.5
    out = np.full(np.broadcast_shapes(value.shape, np.shape(blur)), 0.25)
    for end, slope, step in ((-1.0, -1.0, 0.0), (0.0, 1.0, 1.0), (1.0, -1.0, 0.0), (2.0, 1.0, 1.0)):
        ahead = (place - end) / blur
        beyond = ndtr(ahead)
        out += (step + slope * blur * ahead) * beyond + slope * blur * np.exp(-0.5 * ahead**2) / np.sqrt(2.0 * np.pi)
    return out


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


def begin(step_percent: float) -> Mapping[str, float]:
    """Noise ahead of the bit of a fifth of its weight to begin with: a fit finds its own."""
    return {"blur_percent": 0.2 * step_percent}


_CUT_OFF = _MADE_UP[0] / abs(_MADE_UP[0])
WAVES: tuple[tuple[complex, Mapping[str, float]], ...] = (
    (1.0, {"level": 0.0, "in_approximation": 0.0}),
    (-1.0, {"level": 1.0, "in_approximation": 0.0}),
    (complex(_CUT_OFF), {"level": 0.0, "in_approximation": 1.0}),
    (complex(-np.conj(_CUT_OFF)), {"level": 1.0, "in_approximation": 1.0}),
)
"""Direction of each form's fundamental, c of Re[c exp(i pi x / step)], with its mean in the offset."""


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
        "in_approximation": Param(
            unit="1",
            null=0.0,
            lower=0.0,
            upper=1.0,
            doc="1: it is stuck inside the approximation, so that the lower bits fill up or run empty in its place",
            role="shape",
            counts=True,
            aside=True,
        ),
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
    line=Line(
        param="step_percent",
        clock="channels",
        limits=lambda motion: (0.04, 4.0),
        within=within,
        begin=begin,
        waves=WAVES,
    ),
    drawing=drawing,
    source="offset binary code with one bit held, behind the converter or in its successive approximation; its mean "
    "goes into the offset",
    signature="0 or one step per channel: a square pattern in code, or a half of a saw where lower bits make up",
)
