"""cordic_truncation: the vectoring CORDIC stops after too few iterations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.adc.adc_quantisation import codes_of, full_scale, range_of
from twin.angles import Array, radians, wrap
from twin.cordic import bit_true
from twin.cordic.bit_true import Cordic, angle_rad
from twin.effect import BoolArray, Effect, Param, Parameters
from twin.motion import Motion

EXACT_BITS = 40
"""Angle register where none is stated: longer than any that shows."""
REGISTERS = (14, 16, 18, 20)
"""Angle registers [bit] that a search tries beside an exact one."""


def rotations(values: Parameters) -> Array:
    """The angles [rad] of the micro-rotations, atan(2^-k); whole words where the angle's register is stated."""
    count, bits = (int(np.ravel(values.get(name, 0))[0]) for name in ("iterations", "angle_bits"))
    if bits == 0:
        return np.arctan(2.0 ** -np.arange(count, dtype=np.float64))
    return angle_rad(Cordic(iterations=count, angle_bits=bits).steps, bits)


def vectoring(angle: Array, steps: Array) -> Array:
    """The angle [rad], any shape, as vectoring by these rotations [rad] returns it (codes of unbounded length).

    Shifts 2^0, 2^-1 and so on; the half-plane x < 0 is folded by 180 deg first.
    """
    x, y = np.cos(angle), np.sin(angle)
    folded = x < 0.0
    turned = np.where(folded, np.where(y >= 0.0, np.pi, -np.pi), 0.0)
    x, y = np.where(folded, -x, x), np.where(folded, -y, y)
    for k, step in enumerate(steps):
        way = np.where(y >= 0.0, 1.0, -1.0)
        x, y = x + way * y * 2.0**-k, y - way * x * 2.0**-k
        turned = turned + way * step
    return np.asarray(turned)


def unit_of(values: Parameters) -> Cordic | None:
    """The integer unit that the parameters describe; None where they leave its codes unbounded, or it has no step."""
    numbers = {name: int(np.ravel(values.get(name, 0))[0]) for name in ("iterations", "word_bits", "guard_bits")}
    if numbers["word_bits"] == 0 or numbers["iterations"] == 0:
        return None
    angle_bits = int(np.ravel(values.get("angle_bits", 0))[0]) or EXACT_BITS
    return Cordic(**numbers, angle_bits=angle_bits)


def alike(values: Parameters) -> list[tuple[BoolArray, Parameters]]:
    """The entries of a batch that share all whole numbers, as masks (batch,), with these numbers."""
    names = [name for name in CORDIC_TRUNCATION.params if name in values]
    table = np.stack(np.broadcast_arrays(*(np.ravel(values[name]) for name in names)), axis=-1)
    kinds = np.unique(table, axis=0)
    return [(np.all(table == kind, axis=-1), dict(zip(names, kind.tolist(), strict=True))) for kind in kinds]


def computes(channels: Array, values: Parameters) -> Array | None:
    """The angle [rad] (..., 1, n) that the integer unit returns for the converter's codes of the channels.

    In a batch an entry without such a unit gets the arctangent, cut short by its own iterations.
    """
    kinds = alike(values)
    if all(unit_of(one) is None for _, one in kinds):
        return None
    if len(kinds) == 1:
        return _angle(channels, kinds[0][1])
    channels = np.broadcast_to(channels, (kinds[0][0].size, *channels.shape[-2:]))
    angle = np.empty((len(channels), 1, channels.shape[-1]))
    for rows, one in kinds:
        angle[rows] = _angle(channels[rows], one)
    return angle


def _angle(channels: Array, values: Parameters) -> Array:
    """The angle [rad] (..., 1, n) of one unit, or of one number of iterations on unbounded codes."""
    x, y = channels[..., :1, :], channels[..., 1:, :]
    unit = unit_of(values)
    if unit is None:
        return _cut_short(np.asarray(np.arctan2(y, x)), values)
    reach = float(np.ravel(range_of(values))[0])
    codes = [codes_of(one, unit.word_bits, reach) for one in (x, y)]
    words, _ = bit_true.vectoring(codes[0], codes[1], unit)
    return angle_rad(words, unit.angle_bits)


def _cut_short(angle: Array, values: Parameters) -> Array:
    """Angles [rad], any shape, as these iterations on unbounded codes return them."""
    return angle if values["iterations"] == 0 else angle + wrap(vectoring(angle, rotations(values)) - angle)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    kinds = alike(values)
    if rng is not None and any(unit_of(one) is not None for _, one in kinds):
        return signal  # The integer units have computed it.
    if len(kinds) == 1:
        return _cut_short(signal, kinds[0][1])
    out = np.array(np.broadcast_to(signal, (kinds[0][0].size, *signal.shape[-2:])))
    for rows, one in kinds:
        out[rows] = _cut_short(out[rows], one)
    return out


def attainable(values: Parameters) -> Array:
    """All angles [rad], sorted in [-pi, pi), that this many iterations can return; each step a whole word where so."""
    angles = np.zeros(1)
    for step in rotations(values):
        angles = np.concatenate([angles + step, angles - step])
    return np.sort(np.unique(wrap(np.concatenate([angles, angles + np.pi]))))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    exact = [{"iterations": float(count)} for count in range(5, 15)]
    return exact + [{**one, "angle_bits": float(bits)} for bits in REGISTERS for one in exact]


def stair(values: Parameters) -> float:
    """Twice the largest error, the last rotation [rad]."""
    return 2.0 * float(np.arctan(2.0 ** (1.0 - float(values["iterations"]))))


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """n iterations leave up to atan 2^-(n-1), evenly spread."""
    return {"iterations": np.clip(np.round(1.0 - np.log2(np.sqrt(3.0) * radians(strength_deg))), 5, 14)}


def _words(null: int, doc: str, *, lower: int, upper: int) -> Param:
    return Param(unit="bit", null=null, lower=lower, upper=upper, doc=doc, role="shape", counts=True, aside=True)


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
        "angle_bits": _words(0, "of the angle's register; 0: exact", lower=0, upper=48),
        "full_scale_percent": full_scale(),
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
