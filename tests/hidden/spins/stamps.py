"""When readings are taken, which of them arrive, and what time the log writes beside them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .rotor import Array

MOST_ROWS, LEAST_ROWS = 20_000, 2_000
FRAME_S = 1e-3
"""Of USB at full speed: what arrived within one frame is stamped as one."""


@dataclass(frozen=True)
class Clock:
    """How a logger samples."""

    period_s: float
    jitter_s: float
    """Standard deviation of a stamp about the instant of the reading."""
    resolution_s: float
    """Of the stamps as written; a stamp is rounded down to it."""
    dropped: float
    """Share of the rows that never arrived."""
    gap_s: float
    """Length of one longer gap; 0 for none."""
    start_s: float

    def instants(self, duration_s: float, rng: np.random.Generator) -> Array:
        """True times of the readings that arrived, shape (n,), ascending."""
        count = int(duration_s / self.period_s)
        arrived = rng.random(count) >= self.dropped
        times = self.period_s * np.arange(count)
        if self.gap_s:
            begin = float(rng.uniform(0.2, 0.8)) * duration_s
            arrived &= (times < begin) | (times > begin + self.gap_s)
        return np.asarray(times[arrived])

    def stamps(self, times: Array, rng: np.random.Generator) -> Array:
        """What the log says of them, in its own count of time, shape (n,)."""
        noisy = self.start_s + times + self.jitter_s * rng.standard_normal(times.size)
        return np.asarray(np.maximum.accumulate(np.floor(noisy / self.resolution_s + 1e-6) * self.resolution_s))


def clock_of(
    rng: np.random.Generator,
    *,
    duration_s: float,
    fastest_Hz: float,
    least_rate_Hz: float,
    noise_deg: float,
    hard: bool,
) -> Clock:
    """A sampling rate of 1 to 10 kHz, thinned to 2,000 to 20,000 rows; stamps as good as the readings deserve.

    ``fastest_Hz`` is the highest speed in turns a second: there, a stamp is uncertain by less than half of the noise.
    """
    rows = float(np.exp(rng.uniform(np.log(LEAST_ROWS), np.log(MOST_ROWS))))
    rate = min(max(rows / duration_s, least_rate_Hz), MOST_ROWS / duration_s, 10_000.0)
    worth_s = noise_deg / (360.0 * fastest_Hz)
    return Clock(
        period_s=1.0 / rate,
        jitter_s=worth_s * float(rng.uniform(0.05, 0.5 if hard else 0.1)),
        resolution_s=1e-6 if worth_s > 3e-6 else 1e-7,
        dropped=float(rng.uniform(0.0, 0.02)) if hard else 0.0,
        gap_s=float(rng.uniform(5.0, 50.0)) / rate if hard and rng.random() < 0.5 else 0.0,
        start_s=float(np.round(rng.uniform(0.0, 100.0), 3)) if rng.random() < 0.5 else 0.0,
    )


def through_frames(clock: Clock) -> Clock:
    """The same logger behind USB: all stamps are those of its frames."""
    return replace(clock, jitter_s=0.05 * FRAME_S, resolution_s=FRAME_S)
