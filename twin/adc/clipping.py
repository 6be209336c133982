"""clipping: a channel cannot exceed the converter's range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from twin.adc.square_wave import find
from twin.angles import Array, channels_of
from twin.drawing import YARDSTICK_DEG
from twin.effect import Effect, Param, Parameters
from twin.motion import Motion
from twin.words import InWords


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    level = 0.01 * np.asarray(values["level_percent"])
    x = _cut(signal[..., :1, :], level, np.asarray(values["x_side"]))
    return channels_of(x, _cut(signal[..., 1:, :], level, np.asarray(values["y_side"])))


def _cut(channel: Array, level: Array, side: Array) -> Array:
    """One channel (..., 1, n) cut off at both ends of the range, at the top alone (side 1) or at the bottom (-1)."""
    return np.clip(channel, np.where(side > 0.0, -np.inf, -level), np.where(side < 0.0, np.inf, level))


def shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    # Near the amplitude half a percent halves or doubles what is cut off: a coarser grid would step over it.
    both = (*np.geomspace(3.0, 35.0, 12), *np.arange(40.0, 84.0, 2.0), *np.linspace(84.0, 116.0, 65))
    found = [_shape(level, 0.0, 0.0) for level in both]
    # At one end the mean goes along, which the offsets take up meanwhile: what is cut off seems to be less.
    ends = [(x, y) for x in (1.0, -1.0) for y in (1.0, -1.0)]
    return [*found, *(_shape(level, x, y) for x, y in ends for level in np.arange(7.5, 100.0, 10.0))]


def _shape(level: float, x_side: float, y_side: float) -> Mapping[str, float]:
    return {"level_percent": float(level), "x_side": x_side, "y_side": y_side}


def _side(channel: str, mirror: Literal[-1, 1]) -> Param:
    doc = f"end of its range at which {channel} is cut off: 1 the top alone, -1 the bottom alone, 0 both"
    return Param(
        unit="1", null=0.0, lower=-1.0, upper=1.0, doc=doc, role="shape", counts=True, aside=True, mirror=mirror
    )


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """c - L lost near an axis turns the angle by up to about 0.5 (1 - L)^1.5: the yardstick is 2 %."""
    return {"level_percent": 100.0 - 2.0 * (strength_deg / YARDSTICK_DEG) ** (2.0 / 3.0)}


def said(values: Mapping[str, float]) -> str:
    """Where the channels are cut off."""
    return f"both channels stop at {values['level_percent']:.3g} % of their amplitude"


CLIPPING = Effect(
    name="clipping",
    stage="adc",
    acts_on="channels",
    params={
        "level_percent": Param(
            unit="%",
            null=1000.0,
            lower=1.0,
            upper=1000.0,
            doc="the limit, in amplitudes of x",
            role="level",
            typical=2.0,
            field_power=-1.0,
        ),
        "x_side": _side("x", 1),
        "y_side": _side("y", -1),
    },
    forward=forward,
    needs=frozenset({"one turn"}),
    shapes=shapes,
    zoomed=("level_percent",),
    in_words=InWords(find=find, said=said),
    fitted_shapes=("level_percent",),
    drawing=drawing,
    source="definition: full scale of the converter below the signal's amplitude",
    signature="four narrow spots, at the axes, or two where one end alone cuts; at the last a square wave",
)
