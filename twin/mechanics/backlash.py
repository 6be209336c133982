"""backlash: a dead zone in the coupling between shaft and magnet."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, radians
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion


def play(shaft: Array, motion: Motion, half_width: Array) -> Array:
    """Output (..., n) [rad] of a play operator of total width ``2 * half_width`` driven by ``shaft``.

    It starts engaged in the direction of the first row. Within a stretch of one direction the play is a running
    maximum (or minimum), so only the stretches are looped over.
    """
    out = np.empty(np.broadcast_shapes(shaft.shape, np.shape(half_width)))
    position = None
    for first, last, way in motion.segments:
        engaged = shaft[..., first:last] - way * half_width
        pick = np.maximum if way > 0 else np.minimum
        engaged = pick.accumulate(engaged, axis=-1)
        out[..., first:last] = engaged if position is None else pick(engaged, position)
        position = out[..., last - 1 : last]
    return out


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # The play follows the nominal shaft angle: what the other effects add to it is far below its width.
    shaft = motion.shaft_rad
    return signal + (play(shaft, motion, np.abs(radians(values["half_width_deg"]))) - shaft)


BACKLASH = Effect(
    name="backlash",
    stage="mechanics",
    acts_on="shaft",
    params={
        "half_width_deg": Param(unit="deg", null=0.0, lower=0.0, upper=5.0, doc="half of the dead zone", typical=0.1)
    },
    forward=forward,
    needs=frozenset({"both directions"}),
    source="play operator: Brokate and Sprekels, Hysteresis and Phase Transitions, Springer 1996, section 2.1",
    signature="-b d, taken up linearly right after a reversal",
)
