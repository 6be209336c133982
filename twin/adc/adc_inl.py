"""adc_inl: the converter's transfer curve is not straight: a bow, an S, bits whose weights are off, a stage's gain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion

STEP_PERCENT = 100.0 / 2**13
"""One step of a 14-bit converter, in percent of its full scale (the paper's converter)."""
BITS = 6
"""Bits whose weights may be off: the next one's steps, of 1/64 of the range, are as narrow as strong noise."""
LARGEST_SD_LSB = 15.0
"""Standard deviation of the first bit's error before anything is known of it: about four steps of 12 bit, of a poor
converter, a typical assumption."""
HEAD_ROOM_PERCENT = 30.0
"""Standard deviation of the range before anything is known of it: from hardly more than an amplitude to twice one."""
LARGEST_S_LSB = 1500.0
"""An S of a range of 1.25 amplitudes that bends a channel as the strongest saturation does, by 30 %."""
_STEP = 0.01 * STEP_PERCENT
"""The same over full scale, of which the range is two."""
BLUR = 3e-4
"""Width over which noise rounds an edge off in expectation, in full scales: 0.02 deg of noise."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    full_scale = 0.01 * np.asarray(values["full_scale_percent"], dtype=np.float64)
    u = signal / full_scale
    curve = np.zeros(1)
    # Straight through both ends. A search asks for one of them at a time.
    bow = values["bow_lsb"]
    if np.any(bow):
        curve = curve + bow * (1.0 - u * u)
    s_shape = values["s_lsb"]
    if np.any(s_shape):
        curve = curve + (np.sqrt(27.0) / 2.0) * s_shape * (u - u * u * u)
    errors = (
        values["bit1_lsb"],
        values["bit2_lsb"],
        values["bit3_lsb"],
        values["bit4_lsb"],
        values["bit5_lsb"],
        values["bit6_lsb"],
    )
    if any(np.any(error) for error in errors):
        curve = curve + _of_weights(u, errors, blurred=rng is None)
    first_stage = values.get("first_stage_lsb", 0.0)
    if np.any(first_stage):
        curve = curve + first_stage * (_first_digit(u, blurred=rng is None) - u)
    return np.asarray(signal + 0.01 * STEP_PERCENT * full_scale * curve)


def _of_weights(u: Array, errors: Sequence[Any], *, blurred: bool) -> Array:
    """What a successive approximation of u in [-1, 1) reads too much, in steps, where heavy bits' weights are off.

    Each bit stays on where what is left reaches its true weight, and counts its nominal one: too much by ``errors``
    (steps). What the lower bits cannot make up for is cut off: ahead of a bit that is too heavy the code stands still,
    behind one that is too light it leaps. Straight through both ends.
    """
    last = max(bit for bit, error in enumerate(errors, start=1) if np.any(error))
    # Beyond its range, which true weights make up, a converter stays at its last code.
    range_of = 2.0 - _STEP * sum(np.asarray(error) for error in errors)
    left = np.clip(u + 1.0, BLUR, np.minimum(range_of, 2.0) - BLUR)
    line = 0.5 * (u + 1.0)
    made = -left
    for bit, error in enumerate(errors[:last], start=1):
        nominal, off = 2.0 ** (1 - bit), _STEP * np.asarray(error)
        reached = (left - (nominal - off)) / BLUR
        on = 0.5 * (1.0 + np.tanh(reached)) if blurred else np.where(reached >= 0.0, 1.0, 0.0)
        left = left - (nominal - off) * on
        made = made + nominal * on - off * line
    return np.asarray((made + np.clip(left, 0.0, 2.0 ** (1 - last))) / _STEP)


def _first_digit(u: Array, *, blurred: bool) -> Array:
    """What a pipeline's first stage of 1.5 bits decides of u in [-1, 1): -1, 0 or 1, at a quarter to either side."""
    if blurred:
        return np.asarray(0.5 * (np.tanh((u - 0.25) / BLUR) + np.tanh((u + 0.25) / BLUR)))
    return np.asarray(0.5 * (np.sign(u - 0.25) + np.sign(u + 0.25)))


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """The share of c^3 in a channel of amplitude 1 that an S makes; of a channel that bends down it is below 0.

    It is what a sweep tells: the same share is a larger S of a wider range.
    """
    s_lsb, range_of = float(values.get("s_lsb", 0.0)), 0.01 * float(values["full_scale_percent"])
    if s_lsb == 0.0:
        return {}
    of_linear = 0.5 * np.sqrt(27.0) * 0.01 * STEP_PERCENT * s_lsb
    percent = float(-100.0 * of_linear / range_of**2 / (1.0 + of_linear))
    return {"cubic_percent": (percent, percent, percent, "%")}


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"full_scale_percent": float(level)} for level in np.arange(102.0, 200.0, 4.0)]


def _lsb(doc: str, *, largest: float = 200.0, **about: Any) -> Param:
    return Param(unit="LSB", null=0.0, lower=-largest, upper=largest, doc=doc, typical=15.0, aside=True, **about)


def _weight(bit: int) -> Param:
    # The errors of so many units of capacitance, each with its own, add up as squares: that of half the weight is
    # smaller by the root of two.
    sd = LARGEST_SD_LSB / float(np.sqrt(2.0 ** (bit - 1)))
    return _lsb(f"error of the weight of bit {bit}; 1: the largest", prior_sd=sd, prior_mean=0.0)


ADC_INL = Effect(
    name="adc_inl",
    stage="adc",
    acts_on="channels",
    params={
        # With y turned over a bow is one of the other sign in y alone: no value does that.
        "bow_lsb": _lsb("largest deviation of a bow, in steps of 14 bit", mirror=0),
        # One that bends down is what a saturation is, which says it more plainly; nothing else bends up.
        "s_lsb": _lsb("largest deviation of an S", largest=LARGEST_S_LSB, role="level", sought=(-LARGEST_S_LSB, 0.0)),
        **{f"bit{bit}_lsb": _weight(bit) for bit in range(1, BITS + 1)},
        "first_stage_lsb": _lsb(
            "step where the first stage of a pipeline changes its digit, as its gain is off",
            role="shape",
            detail=True,
            by_itself=True,
        ),
        "full_scale_percent": Param(
            unit="%",
            null=125.0,
            lower=100.0,
            upper=400.0,
            doc="the converter's range, in amplitudes",
            role="shape",
            typical=5.0,
            field_power=-1.0,
            prior_sd=HEAD_ROOM_PERCENT,
        ),
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    shapes=shapes,
    zoomed=("full_scale_percent",),
    fitted_shapes=("full_scale_percent",),
    derived=derived,
    source="integral non-linearity, IEEE Std 1241; binary-weighted capacitors: J. L. McCreary and P. R. Gray, IEEE J. "
    "Solid-State Circuits 10 (1975) 371",
    signature="bow: order 3, the same as quadratic_nonlinearity; S: order 4 in angle and radius, the same as "
    "saturation where it bends down; weights: steps at the major codes, many orders",
)
