"""How far physics stands clear of the noise, once the paper's error model has taken what it can."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..motion import Array, Motion
from .device import Device, electrical, sent_deg

FREED = ("amplitude_x", "amplitude_y", "offset_x", "offset_y", "phase_deg", "quadratic")


def observed(device: Device, motion: Motion) -> Array:
    """Angle error and, where channels are recorded, size of the channels; both in degrees, shape (n,) or (2 n,)."""
    added = device.mechanism.reference
    read = motion.shaft_deg + (0.0 if added is None else added(motion, np.random.default_rng(0)))
    own = device.baseline
    off = own.channel_sense * sent_deg(device, motion) - own.sense * read - own.zero_deg
    error = np.degrees(np.angle(np.exp(1j * np.radians(off))))
    if not device.channels:
        return np.asarray(error)
    return np.concatenate([error, np.degrees(np.log(np.hypot(*electrical(device, motion))))])


def left_deg(device: Device, motion: Motion) -> Array:
    """What of the physics a fit of the error model leaves of `observed`."""
    plain = device.without()
    base, nudge = observed(plain, motion), 1e-4
    zero = np.zeros_like(base)
    zero[: len(motion.time_s)] = 1.0
    columns = [zero]
    # in an angle the common scale does not show
    for name in FREED if device.channels else FREED[1:]:
        moved = replace(plain, baseline=replace(plain.baseline, **{name: getattr(plain.baseline, name) + nudge}))
        columns.append((observed(moved, motion) - base) / nudge)
    basis, extra = np.stack(columns, axis=1), observed(device, motion) - base
    fitted, *_ = np.linalg.lstsq(basis, extra, rcond=1e-9)
    return np.asarray(extra - basis @ fitted)


def clearance_sigma(device: Device, motion: Motion, noise_deg: float) -> float:
    """Root of the signal's energy over the noise's, the error model fitted beside it."""
    return float(np.linalg.norm(left_deg(device, motion)) / noise_deg)
