"""reference_ripple: the converter's reference carries a ripple, and x and y are converted one after the other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import TAU, Array, channels_of, radians
from twin.drawing import log_span
from twin.effect import BoolArray, Effect, Line, Param, Parameters
from twin.motion import Motion


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    frequency = np.asarray(values["frequency_Hz"])
    # Counted from the middle of the record, so that a small change of frequency hardly moves the fitted phase.
    elapsed = motion.time_s - 0.5 * (motion.time_s[0] + motion.time_s[-1])
    phase = TAU * frequency * elapsed + radians(values["phase_deg"])
    # Without a delay of its own the second conversion comes a sixth of a period later: in an angle only the product
    # of amplitude and delay is visible, and at a sixth the difference is as large as the ripple itself.
    delay_us = values.get("delay_us", 0.0)
    shift = TAU * np.where(np.asarray(delay_us) == 0.0, 1.0 / 6.0, 1e-6 * frequency * np.asarray(delay_us))
    size = 0.01 * np.asarray(values["amplitude_percent"])
    gain_x = 1.0 + size * np.cos(phase)
    gain_y = 1.0 + size * np.cos(phase + shift)
    return channels_of(signal[..., :1, :] * gain_x, signal[..., 1:, :] * gain_y)


def begin(values: Parameters) -> Parameters:
    """The delay spelt out, so that a fit can move it."""
    return {**values, "delay_us": values["delay_us"] or 1e6 / (6.0 * values["frequency_Hz"])}


def angle_only(values: Parameters) -> Mapping[str, tuple[float, float]]:
    """All that amplitude, delay and phase may be for the same angle, the delay up to half a period.

    The angle shows amplitude times sin(pi f delay) and phase plus 180 f delay alone.
    """
    frequency, phase = float(values["frequency_Hz"]), float(values["phase_deg"])
    share = 1e-6 * float(values["delay_us"]) * frequency or 1.0 / 6.0
    visible_percent = abs(float(values["amplitude_percent"]) * float(np.sin(np.pi * share)))
    visible_deg = phase + 180.0 * share
    return {
        "amplitude_percent": (visible_percent, REFERENCE_RIPPLE.params["amplitude_percent"].upper),
        "delay_us": (0.0, 0.5e6 / frequency),
        "phase_deg": (visible_deg - 90.0, visible_deg),
    }


def limits(motion: Motion) -> tuple[float, float]:
    duration = float(np.ptp(motion.time_s)) or 1.0
    step = np.diff(motion.time_s)
    fastest = float(np.min(step[step > 0.0], initial=1.0))
    return 2.0 / duration, 0.5 / fastest


def within(frequency_hz: Array) -> BoolArray:
    """Any frequency (any shape) can be a ripple's."""
    return np.asarray(frequency_hz > 0.0)


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A ripple that the time stamps resolve, and the delay at which its effect on the angle is largest."""
    interval = float(np.median(np.diff(motion.time_s)))
    frequency = log_span(uniform[:, 2], 2.0 / (motion.time_s[-1] - motion.time_s[0]), 0.4 / interval)
    return {"frequency_Hz": frequency, "delay_us": np.minimum(0.5e6 / frequency, 1e6)}


REFERENCE_RIPPLE = Effect(
    name="reference_ripple",
    stage="adc",
    acts_on="channels",
    params={
        "frequency_Hz": Param(unit="Hz", null=100.0, lower=1e-3, upper=1e7, doc="frequency", role="shape"),
        "amplitude_percent": Param(unit="%", null=0.0, lower=0.0, upper=50.0, doc="of the reference", typical=0.3),
        "delay_us": Param(
            unit="us",
            null=0.0,
            lower=0.0,
            upper=1e6,
            doc="from x to y; 0: a sixth of a period",
            role="shape",
            typical=1e3,
        ),
        "phase_deg": Param(
            unit="deg", null=0.0, lower=-360.0, upper=360.0, doc="phase, mid-record", role="phase", owner="recording"
        ),
    },
    forward=forward,
    channel_shapes=("delay_us",),
    begin=begin,
    angle_only=angle_only,
    # At one speed an angle without a reference has two waves in time, as torques make them too.
    needs=frozenset({"time_s", "moving shaft", "a reference|two speeds|vx"}),
    line=Line(param="frequency_Hz", clock="time", limits=limits, within=within, multiples=(2, 3, 4, 5), sidebands=2),
    repeatable=True,
    record_wide=True,
    drawing=drawing,
    source="ratio of the signal to the converter's reference; paper, Eq. 3, for a periodic fluctuation",
    signature="sin 2a times cos(2 pi f t + psi)",
)
