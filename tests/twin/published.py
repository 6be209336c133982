"""What vendors publish of sensors like the twin's, with document, revision and page; angles in deg, fields in mT."""

from __future__ import annotations

from typing import Literal

import numpy as np

from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.hall.noise import NOISE
from twin.magnet.field import field_mT
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.magnet.ring_sensor import RingSensor, ring_channels_mT
from twin.motion import Motion

AM4096 = "RLS AM4096 data sheet D02_05"
AM4096_MAGNET = Magnet(diameter_mm=4.0, height_mm=4.0, remanence_T=1.05)
"""Page 17: Sm2Co17, Br 1.05 T."""
AM4096_ERROR_DEG = {0.25: 0.32, 0.4: 0.84, 0.5: 1.34}
"""Fig. 28, page 18, "ideal magnet": largest error by displacement [mm]; ring of 1 mm radius, 1.6 mm from the magnet."""
AM4096_FIELD_MT = 50.0
"""Page 17, typical. The distance is 1.6 mm in the text, 0.75 + 1.00 mm in the table."""
AM4096_GAPS_MM = (1.6, 1.75)
AM4096_DELAY_US = (0.7, 10.0, 20.0)
"""Pages 4 and 15: conversion, interpolation, filter of 10 nF; 12 bit."""
AM4096_HYSTERESIS_DEG = (0.14, 0.17, 0.21)
"""Page 4, electrical: lowest, typical, highest; the difference between both directions."""
AM4096_LSB_DEG = 360.0 / 2**12
AM4096_INL_DEG = 0.2
"""Page 4: integral non-linearity of an aligned, ideal magnet; better than."""

A1335 = "Allegro A1335-DS Rev. 5"
A1335_ERROR_DEG = {0.5: 0.12, 1.0: 0.51, 1.5: 1.23, 2.0: 2.45, 2.5: 4.46, 3.0: 7.57, 3.5: 12.79}
"""Fig. 11, page 17, a simulation: error by displacement [mm]; ideal magnet of "10 x 4 mm", air gap 2.7 mm."""
A1335_NOISE_DEG = {10: 0.515, 15: 0.35, 20: 0.275, 25: 0.20, 30: 0.17, 35: 0.14, 60: 0.09, 100: 0.05}
"""Fig. 10, page 17, read by eye: standard deviation at 25 C by field [mT]."""

MA702 = "MPS MA702 Rev. 1.0"
MA702_SIDE_SHAFT = {
    1.5: (11.5, 86),
    2.0: (19.5, 129),
    2.5: (25.4, 155),
    3.0: (30.0, 172),
    3.5: (33.7, 184),
    4.0: (36.9, 194),
    4.5: (39.5, 201),
    5.0: (41.8, 207),
}
"""Table 13, page 20: error [deg] and trim (a byte) by k = B_rad / B_tan."""

AS5048 = "ams AS5048 v1-11"
AS5048_MAGNET = Magnet(diameter_mm=8.0, height_mm=3.0, grade="N35H")
AS5048_ALIGNED_DEG, AS5048_DISPLACED_DEG = 1.0, 1.2
"""Fig. 10: integral non-linearity, aligned and displaced by 0.5 mm in x and y, 2 mm from the magnet, ring of 1.1 mm."""
AS5048_NOISE_LSB, AS5048_NOISE_DEG = 2.73, 0.06
AS5048_LSB_DEG = 360.0 / 2**14
AS5048_DELAY_US = (90.7, 100.0, 110.2)

AS5600 = "ams AS5600 v1-06"
AS5600_FILTER = {2.2: 0.015, 1.1: 0.021, 0.55: 0.030, 0.286: 0.043}
"""Fig. 32: RMS noise [deg] by the slow filter's delay [ms]."""

MLX90363 = "Melexis MLX90363 getting-started guide Rev. 002"
MLX90363_RULE = (10.0, 1.0)
"""Page 27: a diameter of so many displacements keeps the error below so many deg."""

TMAG5170 = "TI forum, thread 1262445 on TMAG5170"
TMAG5170_LAG_DEG, TMAG5170_HZ, TMAG5170_US = 0.37485, 0.85, 6 * 8 * 25 + 25

TURN_RAD: Array = np.asarray(np.arange(720) * (TAU / 720), dtype=np.float64)


def error_deg(channels: Array) -> float:
    """Largest angle error [deg] of channels (2, n) over the turn, its mean taken off."""
    error = wrap(np.arctan2(channels[1], channels[0]) - TURN_RAD)
    return float(np.degrees(np.max(np.abs(error - error.mean()))))


def ring_error_deg(sensor: RingSensor, magnet: Magnet, placement: Placement) -> float:
    """The same of a ring of plates."""
    return error_deg(ring_channels_mT(sensor, magnet, placement, TURN_RAD))


def plane_error_deg(magnet: Magnet, placement: Placement) -> float:
    """The same of a sensor that takes the field in its plane at a point."""
    return error_deg(field_mT(magnet, placement, TURN_RAD)[:2])


def turning(chain: Chain, rpm: float, *, turns: int = 4, points: int = 3600, way: Literal[1, -1] = 1) -> Array:
    """Errors (n,) [deg] of the chain's readings while the shaft turns steadily; ``rpm`` 0: it stops at every angle."""
    shaft = way * np.arange(turns * points) * (TAU / points)
    speed = way * rpm * TAU / 60.0
    time = np.arange(shaft.size) * (1.0 if rpm == 0.0 else TAU / points / abs(speed))
    motion = Motion.from_angle(
        shaft, time_s=time, direction=np.full(shaft.size, float(way)), speed_rad_s=np.full(shaft.size, speed)
    )
    sweep = chain.simulate(motion, seed=1)
    return np.degrees(wrap(np.radians(sweep.measured_deg) - shaft))


def noise_at(field: float, *, stated_mT: float, stated_deg: float) -> Chain:
    """A chain whose noise, stated at one field, follows to another as its declaration says."""
    values = {**NOISE.null(), "rms_deg": stated_deg}
    factor = NOISE.field_factor("rms_deg", values, field_ratio=field / stated_mT)
    return Chain().with_effect(NOISE.name, rms_deg=stated_deg * factor)


def hysteresis_of(difference_deg: float) -> Chain:
    """A chain whose readings of both directions are so far apart, behind a word of 12 bits."""
    chain = Chain().with_effect("hysteresis", lag_deg=0.5 * difference_deg, memory_deg=1.0)
    return chain.with_effect("output_quantisation", bits=12)


FILTER_STEP_MS = 0.02
"""Time from one raw reading to the next."""


def filtered_deg(delay_ms: float) -> tuple[float, float]:
    """RMS noise [deg] and delay [ms] of means over a window twice the delay, of readings while the shaft turns.

    The raw noise is that which the fastest filter makes its published one of.
    """
    fastest = min(AS5600_FILTER)
    rows, rows_fastest = (round(2.0 * delay / FILTER_STEP_MS) for delay in (delay_ms, fastest))
    raw = Chain().with_effect(NOISE.name, rms_deg=AS5600_FILTER[fastest] * float(np.sqrt(rows_fastest)))
    rpm = 100.0
    points = round(60e3 / rpm / FILTER_STEP_MS)
    seen = _windows(turning(raw, rpm, turns=-(-3000 * rows // points), points=points), rows)
    # The mean over a window is that of its middle: half a window before its last reading, within half a reading.
    shaft = _windows(6.0 * rpm * 1e-3 * FILTER_STEP_MS * np.arange(2 * rows), rows)
    return float(np.std(seen)), float((2 * rows - 1) * FILTER_STEP_MS - shaft[-1] / (6.0 * rpm * 1e-3))


def _windows(values: Array, rows: int) -> Array:
    """Means of so many consecutive readings."""
    whole = values.size // rows * rows
    return np.asarray(values[:whole].reshape(-1, rows).mean(axis=1))
