"""Tracking loops and filters on the angle, run in time at far finer steps than the readings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..baseline import Setting
from ..motion import Array, Motion
from .device import AngleAt, Mechanism
from .kind import Planned


def legs(motion: Motion) -> list[Array]:
    """Rows of each stretch of one speed and direction."""
    change = np.flatnonzero(np.diff(motion.speed_rpm) != 0) + 1
    return np.split(np.arange(len(motion.time_s)), change)


def follow_by(taps: Array, step_s: float) -> Callable[[AngleAt, Motion], Array]:
    """How far a filter's output is from its input at each reading, degrees.

    `taps` are the filter's response to a pulse, steps of `step_s` apart, sum 1. Each stretch of one speed is filtered
    from a run-in at that speed, as a bench that lets the shaft settle.
    """

    def follow(angle_at: AngleAt, motion: Motion) -> Array:
        behind = np.zeros(len(motion.time_s))
        for rows in legs(motion):
            time, shaft = motion.time_s[rows], motion.shaft_deg[rows]
            speed = motion.speed_deg_s[rows[0]]
            fine = np.arange(time[0] - (len(taps) + 1) * step_s, time[-1] + 2 * step_s, step_s)
            # off an even run the shaft wanders, slowly
            off = shaft - (shaft[0] + speed * (time - time[0]))
            angle = angle_at(shaft[0] + speed * (fine - time[0]) + np.interp(fine, time, off))
            out = np.convolve(angle, taps, mode="valid") - angle[len(taps) - 1 :]
            behind[rows] = np.interp(time, fine[len(taps) - 1 :], out)
        return behind

    return follow


def second_order(damping: float, steps: int = 120) -> Array:
    """Pulse response of a tracking loop, a step being a tenth of its delay, 2 damping / natural frequency."""
    time, natural = np.arange(steps) / 10.0, 2 * damping
    ringing = natural * np.sqrt(1 - damping**2)
    response: Array = np.exp(-damping * natural * time) * np.sin(ringing * time)
    return response / response.sum()


def first_order(steps: int = 120) -> Array:
    """Pulse response of an analogue low-pass, a step being a tenth of its time constant."""
    response: Array = np.exp(-np.arange(steps) / 10.0)
    return response / response.sum()


def exponential(share: float) -> Array:
    """Pulse response of a digital low-pass: each sample moves the output by a share of what it is off."""
    response: Array = share * (1 - share) ** np.arange(int(np.ceil(20.0 / share)))
    return response / response.sum()


def mean_delay(taps: Array) -> float:
    """By how many steps a filter is behind a ramp: the first moment of its response."""
    return float(np.arange(len(taps)) @ taps)


def _planned(taps: Array, rng: np.random.Generator, setting: Setting) -> Planned:
    """The filter at a delay that the fastest shaft shows clear of the noise."""
    fastest, size = float(np.max(np.abs(setting.motion.speed_deg_s))), float(rng.uniform(0.15, 0.5))
    delay_s = size / fastest
    acts = Mechanism(follow=follow_by(taps, delay_s / mean_delay(taps)))
    return Planned(acts, size, {"latency": {"delay_us": 1e6 * delay_s}})


def tracking_loop(rng: np.random.Generator, setting: Setting) -> Planned:
    """A loop of second order."""
    return _planned(second_order(float(rng.uniform(0.5, 0.9))), rng, setting)


def low_pass(rng: np.random.Generator, setting: Setting) -> Planned:
    """An analogue low-pass of first order."""
    return _planned(first_order(), rng, setting)


def moving_average(rng: np.random.Generator, setting: Setting) -> Planned:
    """The mean of the last 4, 8 or 16 samples."""
    samples = int(rng.choice((4, 8, 16)))
    return _planned(np.full(samples, 1.0 / samples), rng, setting)


def digital_low_pass(rng: np.random.Generator, setting: Setting) -> Planned:
    """An exponential filter of share 1/4, 1/8 or 1/16."""
    return _planned(exponential(1.0 / float(rng.choice((4, 8, 16)))), rng, setting)
