"""Unnamed structure over time: a tone, a slow drift that need not go one way, and an offset that creeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from twin.angles import TAU, Array, radians
from twin.effect import BoolArray, Effect, Line, Param, Parameters
from twin.hall.offset import add
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

CREEPS = (0.05, 0.1, 0.2, 0.4, 1.0)
"""Time constants that are tried, in lengths of the record: of one several times as long little but a slope is seen."""


def _creep(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    rate = -1.0 / np.asarray(values["time_constant_s"])
    grown = np.expm1((motion.time_s - motion.time_s[:1]) * rate) / np.expm1(np.asarray(values["at_s"]) * rate)
    size, phase = radians(values["amplitude_deg"]) * grown, radians(values["phase_deg"])
    return add(signal, size * np.cos(phase), size * np.sin(phase))


def _creep_shapes(motion: Motion) -> Sequence[Mapping[str, float]]:
    duration = float(np.ptp(motion.time_s)) or 1.0
    return [{"time_constant_s": share * duration, "at_s": duration} for share in CREEPS]


UNNAMED_CREEP = Effect(
    name="unnamed_creep",
    stage="empirical",
    acts_on="channels",
    params={
        "amplitude_deg": Param(
            unit="deg", null=0.0, lower=0.0, upper=90.0, doc="offset so long after the start", owner="recording"
        ),
        # With y turned over so is its offset.
        "phase_deg": Param(
            unit="deg",
            null=0.0,
            lower=-360.0,
            upper=360.0,
            doc="its direction from x to y",
            role="phase",
            owner="recording",
            mirror=-1,
        ),
        "time_constant_s": Param(
            unit="s",
            null=10.0,
            lower=1e-6,
            upper=1e9,
            doc="in which it settles",
            role="shape",
            typical=10.0,
            owner="recording",
        ),
        "at_s": Param(
            unit="s",
            null=100.0,
            lower=1e-6,
            upper=1e9,
            doc="time from the start at which it is stated",
            role="shape",
            owner="recording",
        ),
    },
    forward=_creep,
    shapes=_creep_shapes,
    zoomed=("time_constant_s",),
    fitted_shapes=("time_constant_s",),
    needs=frozenset({"time_s", "several turns"}),
    repeatable=True,
    kind="creep",
    words="an offset that creeps in time, {amplitude_deg} deg at the end, time constant {time_constant_s} s",
    source="step response of a first-order lag from the first reading on, times a direction in the channels' plane",
    signature="order 1 that grows from the first reading on, as where the sensor warms up",
)
