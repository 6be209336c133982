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

REACH = 3.0
"""Path in memories after which nothing is left of the lag before a turning point: (1 - p/reach)^2 then holds over the
path as much as an exponential."""


def lag(motion: Motion, lag_rad: Array, memory_rad: Array) -> Array:
    """Lag angle (..., n) [rad]: dL/d|theta| = (-d h - L)/memory, steady at the first row."""
    out = np.empty(np.broadcast_shapes(np.shape(lag_rad), np.shape(memory_rad), (len(motion),)))
    state = None
    for first, last, way in motion.segments:
        target = -way * lag_rad
        if state is None:
            out[..., first:last] = target
        else:
            path = motion.travel_rad[first:last] - motion.travel_rad[first - 1]
            out[..., first:last] = target + (state - target) * np.exp(-path / memory_rad)
        state = out[..., last - 1 : last]
    return out


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    memory = radians(np.maximum(values["memory_deg"], 1e-3))
    of_angle = radians(values["lag_deg"]) * (1.0 - np.asarray(values.get("on_axes", 0.0)))
    return signal + lag(motion, np.atleast_1d(of_angle), np.atleast_1d(memory))


def axis_lag(value: Array, lag: Array, memory: Array) -> Array:
    """By how much one axis lags (..., n), in amplitudes: after each turning point by Rayleigh's law, in a parabola.

    ``value`` (n,) is the path c of the axis, of amplitude 1; ``lag`` h and ``memory`` (..., 1) are in amplitudes too:
    what is left of the lag before the turning point falls as (1 - p/reach)^2 of the path p, over a reach of three
    memories. Before the first row the field has come from the end of the axis.
    """
    step = np.diff(value)
    moving = np.where(step != 0.0, np.arange(step.size), -1)
    last = np.maximum.accumulate(moving)
    # A row at rest goes on as the one before it, the first ones as the first that moves.
    way = np.sign(step[np.where(last >= 0, last, np.argmax(moving >= 0))]) if step.size else np.zeros(0)
    way = np.concatenate([way[:1], way]) if way.size else np.zeros(value.size)
    if not value.size:
        return np.zeros((*np.broadcast_shapes(lag.shape, memory.shape)[:-1], 0))
    cuts = [0, *(np.flatnonzero(np.diff(way)) + 1).tolist(), value.size]
    out = np.empty((*np.broadcast_shapes(lag.shape, memory.shape)[:-1], value.size))
    state, before = way[:1] * lag, -way[:1]
    for first, end in itertools.pairwise(cuts):
        target = -way[first] * lag
        path = np.abs(value[first:end] - before)
        out[..., first:end] = target + (state - target) * np.maximum(1.0 - path / (REACH * memory), 0.0) ** 2
        state, before = out[..., end - 1 : end], value[end - 1 : end]
    return out


def mean_lag(memory: Array) -> Array:
    """By how much the angle lags in the mean over a turn, of axes that lag by 1 at most: 4 / pi of a short memory.

    An axis that is behind by L turns the angle by L sin a, so the mean is that of L over the way of the axis, of length
    2, times 4 / pi. With the share f of what is before a turning point left after the whole way it turns from h to -h
    by (1 - f) / (1 + f) only.
    """
    short = np.maximum(1.0 - 2.0 / (REACH * memory), 0.0)
    held = REACH / 3.0 * memory * (1.0 - short**3)
    return np.asarray(4.0 / np.pi * (1.0 - held / (1.0 + short**2)))


def on_axes(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """Each axis with its own lag: over a turn the angle lags by the stated one in the mean, and ripples."""
    memory = np.reshape(radians(np.maximum(values["memory_deg"], 1e-3)), (-1, 1))
    mean = np.reshape(radians(values["lag_deg"]) * np.asarray(values["on_axes"]), (-1, 1))
    height = mean / mean_lag(memory)
    if signal.ndim == 2:
        lags = np.stack([axis_lag(axis, height, memory) for axis in signal], axis=-2)
        return signal + (lags if len(lags) > 1 else lags[0])
    each = zip(signal, *np.broadcast_arrays(height, memory, np.empty((len(signal), 1)))[:2], strict=True)
    return signal + np.stack([[axis_lag(axis, high, path) for axis in one] for one, high, path in each])


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
    },
    forward=forward,
    behind=Behind(acts_on="channels", forward=on_axes, params=("on_axes",)),
    needs=frozenset({"both directions"}),
    shapes=shapes,
    zoomed=("memory_deg",),
    fitted_shapes=("memory_deg",),
    drawing=drawing,
    source="in the angle first-order return-point memory (Dahl's friction model, 1968); in each axis Rayleigh's law of "
    "weak fields (Philosophical Magazine 23 (1887) 225)",
    signature="-h d, relaxing exponentially after a reversal; of axes also order 4, with the direction and without",
)
