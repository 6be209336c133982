"""backlash: a dead zone in the coupling between shaft and magnet."""

from __future__ import annotations

import itertools

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def play(shaft: Array, half_width: Array, *, way: float) -> Array:
    """Output (..., n) [rad] of a play operator of total width ``2 * half_width`` driven by ``shaft`` (n,).

    It starts engaged in the direction ``way``. Each output is the one before, clipped to the dead zone around the
    shaft: over a stretch in which the shaft only rises (falls) that is a running maximum (minimum) of its lower
    (upper) edge, so only the stretches are looped over.
    """
    out = np.empty(np.broadcast_shapes(shaft.shape, np.shape(half_width)))
    if np.size(half_width) == 1 and 8 * np.count_nonzero(np.diff(np.diff(shaft) >= 0.0)) > shaft.size:
        out[...] = _reading_by_reading(shaft, float(half_width.item()), way=way)
        return out
    rising = np.diff(shaft) >= 0.0
    cuts = [0, *(np.flatnonzero(rising[1:] != rising[:-1]) + 2).tolist(), shaft.size]
    position: Array = shaft[:1] - way * half_width
    for first, last in itertools.pairwise(cuts):
        if last <= first:
            continue
        up = bool(rising[max(first - 1, 0)]) if rising.size else True
        edge = shaft[first:last] - half_width if up else shaft[first:last] + half_width
        pick = np.maximum if up else np.minimum
        out[..., first:last] = pick(pick.accumulate(edge, axis=-1), position)
        position = out[..., last - 1 : last]
    return out


def _reading_by_reading(shaft: Array, half_width: float, *, way: float) -> Array:
    """The same of one width (n,), for a shaft that trembles: stretches of two readings each are slower to loop over."""
    position = float(shaft[0]) - way * half_width
    found = []
    for angle in shaft.tolist():
        position = min(max(position, angle - half_width), angle + half_width)
        found.append(position)
    return np.array(found)


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # The play follows the nominal shaft angle: what the other effects add to it is far below its width.
    shaft = motion.shaft_rad
    half_width = np.atleast_1d(radians(values["half_width_deg"]))
    return signal + (play(shaft, half_width, way=float(motion.direction[0])) - shaft)


BACKLASH = Effect(
    name="backlash",
    stage="mechanics",
    acts_on="shaft",
    params={
        "half_width_deg": Param(
            unit="deg",
            null=0.0,
            lower=0.0,
            upper=5.0,
            doc="half of the dead zone",
            typical=0.1,
        )
    },
    forward=forward,
    needs=frozenset({"a reference", "both directions"}),
    source="play operator: Brokate and Sprekels, Hysteresis and Phase Transitions, Springer 1996, section 2.1",
    signature="-b d, taken up linearly right after a reversal",
)
