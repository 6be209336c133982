"""How far a cause stands clear of the noise, once the paper's error model has taken what it can."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .baseline import Injected
from .chain import Bench, convert, field_channels, reference
from .motion import Array

NOT_A_MEAN = frozenset({"cordic_truncation", "output_quantisation", "stale_frames", "bus_glitch", "adc_stuck_bit"})
"""Seen in values and their sequence: no clearance is given for them."""
FREED = ("amplitude_x", "amplitude_y", "offset_x", "offset_y", "phase_deg", "quadratic")


def observed(bench: Bench, causes: Sequence[Injected]) -> Array:
    """Noise-free readings turned back by the reference, degrees: (n,) of angle, or (2 n,) with channels."""
    x, y = convert(bench, field_channels(bench, causes), causes)
    back = np.exp(-1j * np.radians(bench.baseline.sense * reference(bench, causes) + bench.baseline.zero_deg))
    turned = (x + 1j * y) * back
    seen: Array = np.concatenate([turned.imag, turned.real]) if bench.channels else np.angle(turned)
    return np.rad2deg(seen)


def _whiten(bench: Bench, columns: Array) -> Array:
    rows = len(bench.motion.time_s)
    if not bench.channels:
        return bench.noise.whiten(columns)
    return np.concatenate([bench.noise.whiten(columns[:rows]), bench.noise.whiten(columns[rows:])])


def angle_change(bench: Bench, causes: Sequence[Injected], name: str) -> Array:
    """What one cause adds to the angle error of the others together, degrees, shape (n,)."""
    angle_only = replace(bench, channels=False)
    others = [injected for injected in causes if injected.name != name]
    return observed(angle_only, causes) - observed(angle_only, others)


def clearance_sigma(bench: Bench, causes: Sequence[Injected], name: str) -> float | None:
    """Signal-to-noise ratio of a matched test for the cause, the baseline fitted beside it."""
    if name in NOT_A_MEAN:
        return None
    if name == "noise_burst":
        (burst,) = (injected for injected in causes if injected.name == name)
        excess = burst.parameters["factor"] ** 2 - 1
        return float(excess * np.sqrt(burst.parameters["rows"] / 2))
    if name in ("reference_jitter", "time_jitter"):
        # noise that adds a variance v to s^2 changes the log likelihood by v^2 / 4 s^4 a reading
        added = np.var(angle_change(bench, causes, name)) / bench.noise.sigma_deg**2
        return float(added / (1 + added) * np.sqrt(len(bench.motion.time_s) / 2))
    others = [injected for injected in causes if injected.name != name]
    bare = observed(bench, others)
    # `observed` turns back by the zero, so its derivative has to be written down
    columns = [observed(bench, causes) - bare, _turned(bench, bare)]
    # the common scale does not show in an angle
    freed = FREED if bench.channels else FREED[1:]
    columns += [_derivative(bench, others, parameter) for parameter in freed]
    white = _whiten(bench, np.stack(columns, axis=1))
    signal, nuisance = white[:, 0], white[:, 1:]
    fitted, *_ = np.linalg.lstsq(nuisance, signal, rcond=1e-9)
    return float(np.linalg.norm(signal - nuisance @ fitted))


def _derivative(bench: Bench, causes: Sequence[Injected], parameter: str) -> Array:
    """Central difference of the readings in one parameter of the baseline."""
    at, nudge = getattr(bench.baseline, parameter), 1e-4
    ahead, behind = (
        observed(replace(bench, baseline=replace(bench.baseline, **{parameter: at + way})), causes)
        for way in (nudge, -nudge)
    )
    return (ahead - behind) / (2 * nudge)


def _turned(bench: Bench, bare: Array) -> Array:
    """Derivative of the readings with respect to the zero, per degree."""
    rows = len(bench.motion.time_s)
    if not bench.channels:
        return np.ones(rows)
    imaginary, real = np.radians(bare[:rows]), np.radians(bare[rows:])
    return np.concatenate([real, -imaginary])
