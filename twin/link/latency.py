"""latency: the reading is tau old when it is paired with the reference (transport delay, or a filter's group delay).

A filter or tracking loop of response H(s) has ln H(s) = -tau s + v s^2 / 2 - w s^3 / 6 + ...: the cumulants of its
impulse response, mean tau, variance v and third central moment w. The mean makes the reading old, the others change the
error's orders with the speed; a loop that overshoots has a negative variance.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from twin.angles import Array, wrap
from twin.drawing import delay
from twin.effect import Behind, Effect, Param, Parameters
from twin.motion import Motion

ORDERS = 4
"""Of the angle's error, that a filter changes: the factors' first and second, and what magnet and disk add."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    return signal - 1e-6 * np.asarray(values["delay_us"]) * motion.speed_rad_s


def filtered(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    """The angle behind a filter of mean delay 0: each order of its error over the turn as the filter passes it on."""
    variance, third = 1e-6 * np.asarray(values["variance_ms2"]), 1e-9 * np.asarray(values["third_moment_ms3"])
    turning = np.sign(np.sum(wrap(np.diff(signal)) * np.diff(motion.shaft_rad), axis=-1, keepdims=True))
    sense = np.where(turning < 0.0, -1.0, 1.0)
    error = wrap(signal - sense * motion.shaft_rad)
    out = np.array(signal + sense * (0.5 * variance * _acceleration(motion)))
    # An error near half a turn is read off a rounded one: the orders do not ask where its zero is.
    about = np.exp(1j * error).mean(axis=-1, keepdims=True)
    error = np.angle(np.exp(1j * error) * np.conj(about))
    waves, read = _series(motion)
    amplitudes = error @ read.T
    for order in range(1, ORDERS + 1):
        rate = order * motion.speed_rad_s
        wave = amplitudes[..., order : order + 1] * waves[order]
        out = out + 2.0 * np.real(wave * (-0.5 * variance * rate**2 + (1j / 6.0) * third * rate**3))
    return out


def _acceleration(motion: Motion) -> Array:
    """Acceleration (n,) [rad/s^2] of a shaft that goes on changing its speed; steps from one speed to the next: 0."""
    return motion.acceleration_rad_s2 if "varying speed" in motion.provides else np.zeros(len(motion))


@lru_cache(maxsize=4)
def _series(motion: Motion) -> tuple[Array, Array]:
    """Waves exp(i k theta) (orders, n) from k = 0, and what reads their amplitudes (orders, n) off a signal."""
    order = np.arange(ORDERS + 1)[:, None]
    waves = np.exp(1j * order * motion.shaft_rad)
    both = np.concatenate([waves, np.conj(waves[1:])])
    return waves, np.linalg.pinv(both.T, rcond=1e-3)[: ORDERS + 1]


def _cumulant(unit: str, bound: float, doc: str) -> Param:
    about: dict[str, Any] = {"role": "shape", "typical": 0.1, "aside": True, "detail": True, "by_itself": True}
    return Param(unit=unit, null=0.0, lower=-bound, upper=bound, doc=doc, **about)


LATENCY = Effect(
    name="latency",
    stage="link",
    # An old reading is a reading of where the shaft was: the delay acts on the shaft angle at the sampling instant.
    acts_on="shaft",
    params={
        "delay_us": Param(unit="us", null=0.0, lower=-1e6, upper=1e6, doc="age of the reading", typical=20.0),
        "variance_ms2": _cumulant("ms^2", 1e6, "of a filter's response about its delay; negative: it overshoots"),
        "third_moment_ms3": _cumulant("ms^3", 1e9, "third central moment of a filter's response"),
    },
    forward=forward,
    behind=Behind(acts_on="angle", forward=filtered, params=("variance_ms2", "third_moment_ms3"), record_wide=True),
    # Of a sensor alone a delay only moves the time's zero: where the shaft was told late, it was late.
    needs=frozenset({"a reference", "two speeds|both directions", "moving shaft"}),
    drawing=delay,
    source="kinematics: e = -w tau; cumulants of an impulse response: Papoulis, The Fourier Integral (1962)",
    signature="order 0, minus speed times delay",
)
