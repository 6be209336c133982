"""Magnets of real shapes, placed as well as assembly allows and worse."""

from __future__ import annotations

import numpy as np

from ..baseline import Setting
from ..motion import Array
from .device import Mechanism
from .kind import Planned
from .magnets import Assembly, Charges, chipped, circle, field_of, prism, rectangle, together


def towards(rng: np.random.Generator, length: float) -> tuple[float, float]:
    """A displacement of this length, anywhere."""
    angle = rng.uniform(0.0, 2 * np.pi)
    return float(length * np.cos(angle)), float(length * np.sin(angle))


def disc(rng: np.random.Generator) -> Charges:
    """A disc magnet of the usual sizes."""
    return prism(circle(float(rng.uniform(2.5, 5.0))), float(rng.uniform(2.0, 3.0)))


def _planned(charges: Charges, stands: Assembly) -> Planned:
    return Planned(Mechanism(field=field_of(charges, stands)))


def _within_tolerance(rng: np.random.Generator) -> Assembly:
    return Assembly(
        gap_mm=float(rng.uniform(1.0, 2.5)),
        magnet_mm=towards(rng, rng.uniform(0.05, 0.2)),
        sensor_mm=towards(rng, rng.uniform(0.1, 0.35)),
    )


def disc_misplaced(rng: np.random.Generator, setting: Setting) -> Planned:
    """A disc off the shaft and a sensor off the axis, both inside the tolerance."""
    return _planned(disc(rng), _within_tolerance(rng))


def block_misplaced(rng: np.random.Generator, setting: Setting) -> Planned:
    """A block instead: its field is flatter one way than the other."""
    block = prism(rectangle(float(rng.uniform(5.0, 8.0)), float(rng.uniform(5.0, 8.0))), float(rng.uniform(2.0, 3.0)))
    return _planned(block, _within_tolerance(rng))


def ring_on_axis(rng: np.random.Generator, setting: Setting) -> Planned:
    """A ring before the sensor, on the axis.

    Close before its hole the field passes through zero: a sensor there sees it swing and no angle, which the program
    refuses. Such a ring is no bench's.
    """
    while True:
        outer = float(rng.uniform(4.0, 7.0))
        thick = float(rng.uniform(2.0, 3.0))
        hole = prism(circle(outer * float(rng.uniform(0.3, 0.5))), thick, magnetisation=-1.0)
        planned = _planned(together(prism(circle(outer), thick), hole), _within_tolerance(rng))
        if _goes_round(planned):
            return planned


def _goes_round(planned: Planned) -> bool:
    """Whether the field turns once as the magnet does."""
    field = planned.mechanism.field
    assert field is not None
    x, y = field(np.linspace(0.0, 2 * np.pi, 73))
    return bool(abs(np.ptp(np.unwrap(np.arctan2(y, x))) - 2 * np.pi) < 0.5)


def tilted(rng: np.random.Generator, setting: Setting) -> Planned:
    """Magnet and sensor a few degrees out of square, and off the axis."""
    stands = Assembly(
        gap_mm=float(rng.uniform(1.0, 2.5)),
        magnet_mm=towards(rng, rng.uniform(0.0, 0.1)),
        sensor_mm=towards(rng, rng.uniform(0.0, 0.2)),
        magnet_tilt=(np.radians(rng.uniform(1.0, 4.0)), rng.uniform(0.0, 2 * np.pi)),
        sensor_tilt=(np.radians(rng.uniform(1.0, 4.0)), rng.uniform(0.0, 2 * np.pi)),
    )
    return _planned(disc(rng), stands)


def chipped_disc(rng: np.random.Generator, setting: Setting) -> Planned:
    """A disc with a piece broken off its rim."""
    radius = float(rng.uniform(2.5, 5.0))
    outline = chipped(circle(radius), radius * float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.0, 2 * np.pi)))
    return _planned(prism(outline, float(rng.uniform(2.0, 3.0))), _within_tolerance(rng))


def unevenly_magnetised(rng: np.random.Generator, setting: Setting) -> Planned:
    """A disc whose one half is magnetised more strongly than the other: its magnetic centre is off the shaft."""
    radius, thick = float(rng.uniform(2.5, 5.0)), float(rng.uniform(2.0, 3.0))
    outline, more = circle(radius), float(rng.uniform(1.03, 1.12))
    upper = np.column_stack([outline[:, 0], np.maximum(outline[:, 1], 0.0)])
    lower = np.column_stack([outline[:, 0], np.minimum(outline[:, 1], 0.0)])
    halves = together(prism(upper, thick, magnetisation=more), prism(lower, thick))
    return _planned(halves, _within_tolerance(rng))


def far_off_axis(rng: np.random.Generator, setting: Setting) -> Planned:
    """A sensor so far off the axis that the field's bending shows in orders of its own."""
    stands = Assembly(gap_mm=float(rng.uniform(0.8, 1.4)), sensor_mm=towards(rng, rng.uniform(0.8, 1.3)))
    block = prism(rectangle(float(rng.uniform(4.0, 5.0)), float(rng.uniform(4.0, 5.0))), 2.5)
    return _planned(block, stands)


def ring_beside_shaft(rng: np.random.Generator, setting: Setting) -> Planned:
    """A sensor beside a thin ring of two poles whose magnetisation has a third and a fifth harmonic."""
    radius, third, fifth = rng.uniform(6.0, 10.0), rng.uniform(0.005, 0.02), rng.uniform(0.001, 0.004)
    gap, phase = rng.uniform(2.0, 4.0), rng.uniform(0.0, 2 * np.pi)
    decay = radius / (radius + gap)

    def field(at: Array) -> tuple[Array, Array]:
        # outside a thin cylinder the potential of order n falls as r^-n: radial and tangential parts are alike
        third_at, fifth_at = 3 * at + phase, 5 * at + 2 * phase
        share3, share5 = third * decay**2, fifth * decay**4
        radial = np.cos(at) + share3 * np.cos(third_at) + share5 * np.cos(fifth_at)
        tangential = np.sin(at) + share3 * np.sin(third_at) + share5 * np.sin(fifth_at)
        return radial, tangential

    return Planned(Mechanism(field=field), size_deg=float(np.degrees(third * decay**2)))
