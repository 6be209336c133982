"""cordic_truncation: the vectoring CORDIC stops after too few iterations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.adc.adc_quantisation import codes_of
from twin.angles import Array, radians, wrap
from twin.cordic import bit_true
from twin.cordic.bit_true import Cordic, angle_rad
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def vectoring(angle: Array, iterations: int) -> Array:
    """The angle [rad], any shape, as ``iterations`` vectoring steps return it (unbounded word length).

    Shifts 2^0 to 2^-(iterations-1); the half-plane x < 0 is folded by 180 deg first.
    """
    x, y = np.cos(angle), np.sin(angle)
    folded = x < 0.0
    turned = np.where(folded, np.where(y >= 0.0, np.pi, -np.pi), 0.0)
    x, y = np.where(folded, -x, x), np.where(folded, -y, y)
    for k in range(iterations):
        way = np.where(y >= 0.0, 1.0, -1.0)
        x, y = x + way * y * 2.0**-k, y - way * x * 2.0**-k
        turned = turned + way * np.arctan(2.0**-k)
    return np.asarray(turned)


def unit_of(values: Parameters) -> Cordic | None:
    """The integer unit that the parameters describe; None where they leave its words unbounded."""
    words = {name: int(np.ravel(values.get(name, 0))[0]) for name in ("word_bits", "guard_bits", "angle_bits")}
    if words["word_bits"] == 0:
        return None
    return Cordic(iterations=int(np.ravel(values["iterations"])[0]), **words)


def computes(channels: Array, values: Parameters) -> Array | None:
    """The angle [rad] (..., 1, n) that the integer unit returns for the converter's codes of the channels."""
    unit = unit_of(values)
    if unit is None:
        return None
    codes = codes_of(channels, unit.word_bits)
    words, _ = bit_true.vectoring(codes[..., :1, :], codes[..., 1:, :], unit)
    return angle_rad(words, unit.angle_bits)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is not None and unit_of(values) is not None:
        return signal  # The integer unit has computed it.
    iterations = np.asarray(values["iterations"])
    if iterations.size == 1:
        count = int(iterations.ravel()[0])
        return signal if count == 0 else signal + wrap(vectoring(signal, count) - signal)
    counts = np.ravel(iterations)
    parts = np.broadcast_to(signal, (counts.size, *signal.shape[-2:]))
    single = ({"iterations": float(count)} for count in counts)
    return np.stack([forward(part, motion, one, rng) for part, one in zip(parts, single, strict=True)])


def attainable(values: Parameters) -> Array:
    """All angles [rad], sorted in [-pi, pi), that this many iterations can return; each step a whole word where so."""
    unit, count = unit_of(values), int(np.ravel(values["iterations"])[0])
    steps = (
        np.arctan(2.0 ** -np.arange(count, dtype=np.float64))
        if unit is None
        else angle_rad(unit.steps, unit.angle_bits)
    )
    angles = np.zeros(1)
    for step in steps:
        angles = np.concatenate([angles + step, angles - step])
    return np.sort(np.unique(wrap(np.concatenate([angles, angles + np.pi]))))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"iterations": float(count)} for count in range(5, 15)]


def stair(values: Parameters) -> float:
    """Twice the largest error, the last rotation [rad]."""
    return 2.0 * float(np.arctan(2.0 ** (1.0 - float(values["iterations"]))))


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """n iterations leave up to atan 2^-(n-1), evenly spread."""
    return {"iterations": np.clip(np.round(1.0 - np.log2(np.sqrt(3.0) * radians(strength_deg))), 5, 14)}


def _words(null: int, doc: str, *, lower: int, upper: int) -> Param:
    return Param(unit="bit", null=null, lower=lower, upper=upper, doc=doc, role="shape", counts=True)


CORDIC_TRUNCATION = Effect(
    name="cordic_truncation",
    stage="cordic",
    acts_on="angle",
    params={
        "iterations": Param(
            unit="1",
            null=0,
            lower=0,
            upper=40,
            doc="vectoring iterations; 0: exact",
            role="level",
            counts=True,
        ),
        "word_bits": _words(0, "of the codes that it takes; 0: unbounded", lower=0, upper=32),
        "guard_bits": _words(3, "more in its data path", lower=0, upper=24),
        "angle_bits": _words(18, "of the angle's register", lower=4, upper=48),
    },
    forward=forward,
    computes=computes,
    footprint="values",
    attainable=attainable,
    stair=stair,
    drawing=drawing,
    shapes=shapes,
    needs=frozenset({"one turn"}),
    source="J. E. Volder, The CORDIC Trigonometric Computing Technique, IRE Trans. EC-8 (1959); paper, section 2.2.6",
    signature="the finite set of angles that n iterations can return",
)
