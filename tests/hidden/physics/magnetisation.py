"""Magnetisation curves of the concentrator, each axis by itself or the vector as a whole."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..baseline import Setting
from ..channel_causes import Channels
from ..motion import Array
from .device import Mechanism
from .kind import Planned
from .magnets import Assembly, field_of
from .placed import disc, towards

Curve = Callable[[Array], Array]


def froehlich(knee: float) -> Curve:
    """Froehlich's curve h / (1 + |h| / knee)."""
    return lambda h: h / (1.0 + np.abs(h) / knee)


def hyperbolic(knee: float) -> Curve:
    """knee tanh(h / knee)."""
    return lambda h: knee * np.tanh(h / knee)


def langevin(knee: float) -> Curve:
    """Langevin's coth x - 1 / x, slope 1 at the origin, by its series where that is better conditioned."""

    def curve(h: Array) -> Array:
        x = 3.0 * h / knee
        near = np.abs(x) < 0.05
        safe = np.where(near, 1.0, x)
        return knee * np.where(near, x / 3.0 - x**3 / 45.0, 1.0 / np.tanh(safe) - 1.0 / safe)

    return curve


def cubic(k: float) -> Curve:
    """h - k h^3."""
    return lambda h: h - k * h**3


def order_4_deg(curve: Curve) -> float:
    """Amplitude of order 4 that the curve leaves in the angle, degrees."""
    angle = 2 * np.pi * np.arange(720) / 720
    error = np.arctan2(curve(np.sin(angle)), curve(np.cos(angle))) - angle
    error = np.angle(np.exp(1j * error))
    return float(np.degrees(2 * np.abs(np.mean(error * np.exp(-4j * angle)))))


def _knee(make: Callable[[float], Curve], wanted_deg: float) -> float:
    """Knee at which the curve leaves so much of order 4."""
    low, high = 0.3, 200.0
    for _ in range(60):
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if order_4_deg(make(middle)) > wanted_deg else (low, middle)
    return high


def _per_axis(make: Callable[[float], Curve], rng: np.random.Generator) -> Planned:
    size = float(rng.uniform(0.08, 0.3))
    curve = make(_knee(make, size))
    return Planned(Mechanism(plates=lambda field: (curve(field[0]), curve(field[1]))), size)


def froehlich_axes(rng: np.random.Generator, setting: Setting) -> Planned:
    """Froehlich's curve on each axis."""
    return _per_axis(froehlich, rng)


def tanh_axes(rng: np.random.Generator, setting: Setting) -> Planned:
    """A hyperbolic tangent on each axis."""
    return _per_axis(hyperbolic, rng)


def langevin_axes(rng: np.random.Generator, setting: Setting) -> Planned:
    """Langevin's function on each axis."""
    return _per_axis(langevin, rng)


def cubic_axes(percent: float) -> Callable[[np.random.Generator, Setting], Planned]:
    """The catalogue's own cubic."""

    def plan(rng: np.random.Generator, setting: Setting) -> Planned:
        curve = cubic(0.01 * percent)
        acts = Mechanism(plates=lambda field: (curve(field[0]), curve(field[1])))
        return Planned(acts, order_4_deg(curve), {"saturation": {"k_percent": percent}})

    return plan


def vector_saturation(rng: np.random.Generator, setting: Setting) -> Planned:
    """An isotropic disk before a misplaced magnet: the size of the field saturates, its direction stays."""
    curve = froehlich(float(rng.uniform(3.0, 12.0)))
    stands = Assembly(float(rng.uniform(1.0, 2.0)), sensor_mm=towards(rng, rng.uniform(0.2, 0.5)))

    def saturated(field: Channels) -> Channels:
        size = np.hypot(*field)
        share = curve(size) / size
        return field[0] * share, field[1] * share

    return Planned(Mechanism(field=field_of(disc(rng), stands), disk=saturated))
