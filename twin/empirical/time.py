"""Unnamed structure over time: a tone, and a slow drift that need not go one way."""

from __future__ import annotations

import numpy as np

from twin.angles import TAU, Array, radians
from twin.effect import BoolArray, Effect, Line, Param, Parameters
from twin.motion import Motion


def _tone(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    # Counted from the middle of the record, so that a small change of frequency hardly moves the fitted phase.
    elapsed = motion.time_s - 0.5 * (motion.time_s[0] + motion.time_s[-1])
    wave: Array = np.cos(TAU * np.asarray(values["frequency_Hz"]) * elapsed + radians(values["phase_deg"]))
    return signal + radians(values["amplitude_deg"]) * wave


def _tone_limits(motion: Motion) -> tuple[float, float]:
    duration = float(np.ptp(motion.time_s)) or 1.0
    step = np.diff(motion.time_s)
    return 2.0 / duration, 0.5 / float(np.min(step[step > 0.0], initial=1e9))


def _any_tone(frequency_hz: Array) -> BoolArray:
    return np.asarray(frequency_hz > 0.0)


UNNAMED_TONE = Effect(
    name="unnamed_tone",
    stage="empirical",
    acts_on="angle",
    params={
        "frequency_Hz": Param(
            unit="Hz", null=1.0, lower=0.0, upper=1e7, doc="frequency", role="shape", owner="recording"
        ),
        "amplitude_deg": Param(unit="deg", null=0.0, lower=0.0, upper=90.0, doc="amplitude", owner="recording"),
        "phase_deg": Param(
            unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase, mid-record", role="phase", owner="recording"
        ),
    },
    forward=_tone,
    line=Line(param="frequency_Hz", clock="time", limits=_tone_limits, within=_any_tone),
    # On a shaft that is stopped for each reading a tone in time is one more order.
    needs=frozenset({"time_s", "moving shaft"}),
    repeatable=True,
    record_wide=True,
    # On a shaft that steps evenly a tone in time is an order too: the order is the plainer description.
    handicap=2.0,
    kind="time_frequency",
    words="{frequency_Hz:4} Hz in time, which the shaft angle does not carry, amplitude {amplitude_deg} deg",
    source="Fourier component in time",
    signature="a tone that the shaft angle does not carry",
)

MODES = 4


def _drift(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    duration = float(np.ptp(motion.time_s)) or 1.0
    share = (motion.time_s - motion.time_s[0]) / duration
    moved = sum(
        (radians(values[f"mode{k}_deg"]) * np.cos(np.pi * k * share) for k in range(1, MODES + 1)),
        start=np.zeros(len(motion)),
    )
    return signal + moved


UNNAMED_DRIFT = Effect(
    name="unnamed_drift",
    stage="empirical",
    acts_on="angle",
    params={
        f"mode{k}_deg": Param(
            unit="deg", null=0.0, lower=-90.0, upper=90.0, doc=f"cos({k} pi t / duration)", owner="recording"
        )
        for k in range(1, MODES + 1)
    },
    forward=_drift,
    needs=frozenset({"time_s"}),
    repeatable=True,
    record_wide=True,
    kind="drift",
    words="a slow movement of the zero, {largest_deg} deg at most in one mode",
    source="cosine series in time",
    signature="a slow movement of the zero that comes back",
)
