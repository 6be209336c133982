"""mains_pickup: the supply's 50 or 60 Hz and its harmonics couple into the channels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from twin.angles import TAU, Array, radians
from twin.drawing import span
from twin.effect import BoolArray, Effect, Line, Param, Parameters
from twin.hall.offset import add
from twin.motion import Motion

HARMONICS = (2, 3, 4, 5, 6, 7)
"""Of the supply's frequency: odd ones of transformers and converters, even ones of rectifiers."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # Counted from the middle of the record, so that a small change of frequency hardly moves the fitted phase.
    elapsed = motion.time_s - 0.5 * (motion.time_s[0] + motion.time_s[-1])
    wave = 0.01 * np.cos(TAU * np.asarray(values["frequency_Hz"]) * elapsed + radians(values["phase_deg"]))
    return add(signal, np.asarray(values["x_percent"]) * wave, np.asarray(values["y_percent"]) * wave)


def within(frequency_hz: Array) -> BoolArray:
    """Which frequencies (any shape) are a supply's: 50 or 60 Hz within 1 %, or one of the harmonics of these."""
    times = np.array([1, *HARMONICS])
    supply = np.concatenate([50.0 * times, 60.0 * times])
    return np.asarray(np.any(np.abs(np.asarray(frequency_hz)[..., None] / supply - 1.0) <= 0.01, axis=-1))


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A supply's frequency is kept within half a per cent."""
    nominal = np.where(uniform[:, 2] < 0.5, 50.0, 60.0)
    return {"frequency_Hz": nominal * span(uniform[:, 3], 0.995, 1.005)}


def _amplitude(axis: str, *, mirror: Literal[-1] | None = None) -> Param:
    return Param(
        unit="%",
        null=0.0,
        lower=-50.0,
        upper=50.0,
        doc=f"amplitude on {axis}",
        typical=0.2,
        field_power=-1.0,
        mirror=mirror,
        owner="bench",
    )


MAINS_PICKUP = Effect(
    name="mains_pickup",
    stage="hall",
    acts_on="channels",
    params={
        "frequency_Hz": Param(
            unit="Hz",
            null=50.0,
            lower=49.5,
            upper=60.6 * HARMONICS[-1],
            doc="50 or 60 Hz within 1 %, or a harmonic",
            role="shape",
            typical=0.1,
            owner="recording",
        ),
        "x_percent": _amplitude("x"),
        "y_percent": _amplitude("y", mirror=-1),
        "phase_deg": Param(
            unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase, mid-record", role="phase", owner="recording"
        ),
    },
    forward=forward,
    needs=frozenset({"time_s", "moving shaft"}),
    line=Line(
        param="frequency_Hz",
        clock="time",
        limits=lambda motion: (49.5, 60.6),
        within=within,
        multiples=HARMONICS,
    ),
    repeatable=True,
    record_wide=True,
    drawing=drawing,
    source="magnetic or capacitive coupling of the supply into the signal leads",
    signature="order 1 times cos(2 pi f t + psi), and times harmonics of it",
)
