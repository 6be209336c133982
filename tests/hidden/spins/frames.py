"""What the link does that the tests' chain does not, or not by as much: words that are no angle, and late ones."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..baseline import Injected, Setting
from .rotor import Array


def plan_error_code(rng: np.random.Generator, setting: Setting) -> Injected:
    """Zero, all ones or a status word in place of some readings, alone or in runs; strength: the share."""
    words = 2**setting.output_bits
    code = float(rng.choice((0, words - 1, int(rng.integers(1, words - 1)))))
    return Injected(
        "error_code",
        0.0,
        {},
        {
            "code": np.array([code]),
            "share": np.array([rng.uniform(0.002, 0.02)]),
            "run": np.array([rng.choice((1, 1, 5))]),
        },
    )


def plan_latency(rng: np.random.Generator, setting: Setting) -> Injected:
    """A delay worth 2 to 6 degrees at the highest speed."""
    lag = float(rng.uniform(2.0, 6.0))
    return Injected("latency", lag, {"delay_us": 1e6 * lag / float(np.max(np.abs(setting.motion.speed_deg_s)))})


UNSEEN = ("latency",)
"""Causes that no log of the sensor alone shows: a shaft that is always read late is one that turned late."""
PLANS: dict[str, Callable[[np.random.Generator, Setting], Injected]] = {
    "error_code": plan_error_code,
    "latency": plan_latency,
}


def send(word_deg: Array, bits: int, injected: list[Injected], rng: np.random.Generator) -> Array:
    """The readings as they arrive."""
    sent = word_deg.copy()
    for one in injected:
        if one.name == "error_code":
            run = int(one.hidden["run"][0])
            starts = np.flatnonzero(rng.random(sent.size) < one.hidden["share"][0] / run)
            for start in starts.tolist():
                sent[start : start + run] = one.hidden["code"][0] * 360.0 / 2**bits
    return sent
