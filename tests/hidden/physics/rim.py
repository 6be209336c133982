"""A magnet of uneven magnetisation, seen by a sensor beside its rim."""

from __future__ import annotations

import numpy as np

from ..baseline import Setting
from ..channel_causes import Channels
from ..motion import Array
from .device import Mechanism
from .kind import Planned

ORDERS = np.arange(3, 7)


def falling_harmonics(rng: np.random.Generator, setting: Setting) -> Planned:
    """Orders 3 to 6, as the potential of a magnetisation in four, five, six and seven periods has them.

    Outside a cylinder a component of m periods falls with the power m + 1 of radius over distance: against the dipole's
    its field, and the angle by which that is turned, falls with the power m - 1, which is the order of the angle.
    """
    radius = float(rng.uniform(0.65, 0.85))
    sizes = radius**ORDERS * rng.uniform(0.6, 1.4, ORDERS.size)
    sizes *= np.radians(rng.uniform(0.05, 0.15)) / sizes[0]
    parts = sizes * np.exp(1j * rng.uniform(0.0, 2.0 * np.pi, ORDERS.size))

    def field(at: Array) -> Channels:
        total = np.exp(1j * at) * (1.0 + np.exp(1j * np.outer(at, ORDERS)) @ parts)
        return total.real, total.imag

    return Planned(Mechanism(field=field), float(np.degrees(np.linalg.norm(sizes))))
