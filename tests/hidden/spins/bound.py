"""How well the logs of a draw can tell the sensor's orders at all, whoever asks.

Cramer and Rao's bound of orders 1 to 16 beside as many of the torque, whose response falls as the speed squared, and a
cubic in time for every four turns; for white noise of the readings and of their stamps, at the true shaft. What belts,
loads and mains do, and what a tool holds against small torques beforehand, is not in it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .generator import Drawn, Log
from .rotor import Array

ORDERS = np.arange(1, 17)
TURNS = 4.0


def information(log: Log, *, noise_deg: float, jitter_s: float, at_deg_s: float) -> Array:
    """Of a log for the orders of the sensor and those of the torque, in that order; shape (64, 64), 1/deg^2.

    Those of the torque are counted at the speed ``at_deg_s``.
    """
    shaft, time = log.shaft_deg, log.time_s
    speed = np.gradient(shaft, time)
    window = np.floor(np.abs(shaft - shaft[0]) / (360.0 * TURNS)).astype(np.int64)
    found = np.zeros((64, 64))
    for number in range(int(window.max()) + 1):
        rows = np.flatnonzero(window == number)
        if rows.size < 8:
            continue
        share = (time[rows] - time[rows].mean()) / max(float(np.ptp(time[rows])), 1e-12)
        angle = np.radians(shaft[rows])[:, None] * ORDERS
        waves = np.hstack([np.cos(angle), np.sin(angle)])
        # the mean speed of the turns: within them, the torques' own doing is no part of it
        slowed = (at_deg_s / np.polyval(np.polyfit(share, speed[rows], 1), share))[:, None] ** 2
        basis = np.linalg.qr(np.vander(share, 4))[0]
        both = np.hstack([waves, waves * slowed])
        both = both - basis @ (basis.T @ both)
        sigma = np.hypot(noise_deg, jitter_s * float(np.mean(np.abs(speed[rows]))))
        found += both.T @ both / sigma**2
    return found


def least_rms_deg(drawn: Drawn) -> float:
    """RMS over orders 1 to 16 that no unbiased correction stays below on average; infinite at one speed."""
    rounding = 360.0 / 2 ** int(str(drawn.truth["output_bits"])) / math.sqrt(12.0)
    noise = math.hypot(float(str(drawn.truth["noise_deg"])), rounding)
    return least_rms_of(drawn.logs, noise_deg=noise, jitter_s=float(str(drawn.truth["jitter_s"])))


def least_rms_of(logs: Sequence[Log], *, noise_deg: float, jitter_s: float) -> float:
    """The same of logs with this noise."""
    at_deg_s = float(np.median(np.abs(np.gradient(logs[0].shaft_deg, logs[0].time_s))))
    total = sum(
        (information(log, noise_deg=noise_deg, jitter_s=jitter_s, at_deg_s=at_deg_s) for log in logs),
        np.zeros((64, 64)),
    )
    scale = np.sqrt(np.diag(total))
    even = total / np.outer(scale, scale)
    if float(np.linalg.eigvalsh(even)[0]) < 1e-10:
        return math.inf
    variance = np.diag(np.linalg.inv(even)) / scale**2
    return math.sqrt(float(np.sum(variance[:32])) / 2.0)
