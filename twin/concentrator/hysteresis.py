"""hysteresis: the concentrator's remanence makes the field angle lag the direction of turning.

What lags is the field's angle, each of the two axes by itself, or a share of either.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import Array, radians
from twin.drawing import log_span
from twin.effect import Behind, Effect, Param, Parameters
from twin.motion import Motion

RAYLEIGH = 2.0
"""Power of the fall after a turning point in weak fields: plays of all widths up to the reach, each as strong."""


def lag(motion: Motion, lag_rad: Array, memory_rad: Array) -> Array:
    """Lag angle (..., n) [rad]: dL/d|theta| = (-d h - L)/memory, steady at the first row."""
    first, last = (np.array([rows[end] for rows in motion.segments], dtype=np.int64) for end in (0, 1))
    way = np.array([way for _, _, way in motion.segments])
    segment = np.repeat(np.arange(first.size), last - first)
    # Ahead of the first row it has gone on for ever.
    path = motion.travel_rad - np.where(segment > 0, motion.travel_rad[first - 1][segment], -np.inf)
    left = np.exp(-path / memory_rad)
    target = -way * lag_rad
    begun = np.broadcast_to(target, np.broadcast_shapes(target.shape, np.shape(memory_rad))).copy()
    for number, end in enumerate(last[:-1], start=1):
        before = target[..., number - 1]
        begun[..., number] = before + (begun[..., number - 1] - before) * left[..., end - 1]
    return np.asarray(target[..., segment] + (begun - target)[..., segment] * left)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    memory = radians(np.maximum(values["memory_deg"], 1e-3))
    of_angle = radians(values["lag_deg"]) * (1.0 - np.asarray(values.get("on_axes", 0.0)))
    return signal + lag(motion, np.atleast_1d(of_angle), np.atleast_1d(memory))


def axis_lag(value: Array, lag: Array, memory: Array, fall: Array | float = RAYLEIGH) -> Array:
    """By how much one axis lags (..., n), in amplitudes: as a stack of plays does.

    ``value`` (n,) is the path c of the axis, of amplitude 1; ``lag`` h and ``memory`` (..., 1) are in amplitudes too.
    After a turning point of a long path the lag goes from -h to h by 2 h (1 - (1 - p/reach)^fall) of the path p, over
    a reach of 1 + ``fall`` (..., 1) memories: this way its lag before holds over the path as much as an exponential.
    Loops within it close as the plays do. Before the first row the field has come from the end of the axis.
    """
    width, weight = _plays(lag, memory, fall)
    if not value.size:
        return np.zeros((*weight.shape[:-1], 0))
    way = np.sign(value[np.argmax(value != value[0])] - value[0])
    path = np.concatenate([[-way, value[0]], value])
    held = np.broadcast_to(path[0] + way * width, weight.shape)
    out = np.empty((*weight.shape[:-1], path.size))
    for first, end in itertools.pairwise(_turns(path)):
        at = path[first:end]
        dragged = np.maximum if at[-1] >= path[max(first - 1, 0)] else np.minimum
        rising = 1.0 if dragged is np.maximum else -1.0
        states = dragged(held[..., None], at - rising * width[..., None])
        out[..., first:end] = np.sum(weight[..., None] * (states - at), axis=-2)
        held = states[..., -1]
    return out[..., 2:]


_LEAST = 1e-3
"""Of the mean lag: below, hardly any play moves at all."""
_PLAYS = 24
"""Of a stack: the lag is then a polygon that leaves Rayleigh's parabola by a thousandth of the lag."""


def _plays(lag: Array, memory: Array, fall: Array | float) -> tuple[Array, Array]:
    """Half widths and weights (..., k) of the plays by which a lag is at its curve in so many places of the reach."""
    place = np.arange(1, _PLAYS + 1) / _PLAYS
    reach = (1.0 + fall) * memory
    risen = 1.0 - (1.0 - np.concatenate([[0.0], place])) ** np.asarray(fall)
    slope = np.diff(risen, axis=-1, append=risen[..., -1:])
    return 0.5 * reach * place, -2.0 * lag * np.diff(slope, axis=-1) * _PLAYS / reach


def _turns(path: Array) -> list[int]:
    """Rows at which the stretches of a path (n,) begin in which it goes one way, and its length."""
    step = np.sign(np.diff(path))
    moving = np.flatnonzero(step)
    turns = moving[1:][step[moving[1:]] != step[moving[:-1]]] + 1
    return [0, *turns.tolist(), path.size]


def mean_lag(memory: Array, fall: Array | float = RAYLEIGH) -> Array:
    """By how much the angle lags in the mean over a turn, of axes that lag by 1 at most: 4 / pi of a short memory.

    An axis that is behind by L turns the angle by L sin a, so the mean is that of L over the way of the axis, of length
    2, times 4 / pi. Plays that are wider than that way stay where they are.
    """
    short = np.maximum(1.0 - 2.0 / ((1.0 + fall) * memory), 0.0)
    held = memory * (1.0 - short ** (1.0 + fall))
    return np.asarray(4.0 / np.pi * np.maximum(1.0 - held + short**fall, _LEAST))


def on_axes(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """Each axis with its own lag: over a turn the angle lags by the stated one in the mean, and ripples."""
    memory = np.reshape(radians(np.maximum(values["memory_deg"], 1e-3)), (-1, 1))
    mean = np.reshape(radians(values["lag_deg"]) * np.asarray(values["on_axes"]), (-1, 1))
    fall = np.reshape(np.asarray(values.get("fall", RAYLEIGH), dtype=np.float64), (-1, 1))
    height = mean / mean_lag(memory, fall)
    if signal.ndim == 2:
        lags = np.stack([axis_lag(axis, height, memory, fall) for axis in signal], axis=-2)
        return signal + (lags if len(lags) > 1 else lags[0])
    each = zip(signal, *np.broadcast_arrays(height, memory, fall, np.empty((len(signal), 1)))[:3], strict=True)
    return signal + np.stack([[axis_lag(axis, *own) for axis in one] for one, *own in each])


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    return [{"memory_deg": memory} for memory in (0.5, 2.0, 5.0, 12.0, 25.0, 50.0)]


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A memory of degrees."""
    return {"memory_deg": log_span(uniform[:, 2], 2.0, 30.0)}


HYSTERESIS = Effect(
    name="hysteresis",
    stage="concentrator",
    acts_on="shaft",
    params={
        # The coercive field is the material's, in A/m: the angle by which it holds the field back is its share of it.
        "lag_deg": Param(
            unit="deg",
            null=0.0,
            lower=0.0,
            upper=5.0,
            doc="steady lag, in the mean over a turn",
            field_power=-1.0,
        ),
        "memory_deg": Param(
            unit="deg",
            null=10.0,
            lower=0.05,
            upper=90.0,
            doc="travel over which it relaxes",
            role="shape",
            typical=10.0,
        ),
        "on_axes": Param(
            unit="1",
            null=0.0,
            lower=0.0,
            upper=1.0,
            doc="share of the lag that each axis has by itself; 0: the field's angle lags",
            role="shape",
            aside=True,
            detail=True,
        ),
        "fall": Param(
            unit="1",
            null=RAYLEIGH,
            lower=1.0,
            upper=6.0,
            doc="of the lag of an axis after a turning point, as a power of the path; 2: Rayleigh's law, 1: one play",
            role="shape",
            typical=0.5,
            aside=True,
            detail=True,
        ),
    },
    forward=forward,
    behind=Behind(acts_on="channels", forward=on_axes, params=("on_axes",)),
    needs=frozenset({"both directions"}),
    shapes=shapes,
    zoomed=("memory_deg",),
    fitted_shapes=("memory_deg",),
    drawing=drawing,
    source="in the angle first-order return-point memory (Dahl's friction model, 1968); in each axis a stack of "
    "plays: Rayleigh's law of weak fields (Philosophical Magazine 23 (1887) 225)",
    signature="-h d, relaxing exponentially after a reversal; of axes also order 4, with the direction and without",
)
