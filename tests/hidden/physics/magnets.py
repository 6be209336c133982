"""Fields of uniformly magnetised prisms, summed over the magnetic charge of their sides.

A prism stands along z; its side of outward normal n carries the charge M . n per area. Top and bottom carry none, as
the magnetisation lies across. Lengths in millimetres; the scale of the field does not matter, for it is normalised.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..channel_causes import Channels
from ..motion import Array

FLOORS = 10
"""Layers of charge over a magnet's thickness."""
ANGLES = 256
"""Positions of a turn at which a field is summed; the series through them is exact far beyond what a magnet has."""


@dataclass(frozen=True)
class Charges:
    """Point charges of a magnet, in its own axes."""

    place_mm: Array
    """Shape (k, 3)."""
    charge: Array


def circle(radius_mm: float, sides: int = 180) -> Array:
    """Corners of a polygon that stands for a circle, counter-clockwise, shape (sides, 2)."""
    angle = 2 * np.pi * np.arange(sides) / sides
    return radius_mm * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def rectangle(length_mm: float, width_mm: float) -> Array:
    """Corners of a block's cross-section, counter-clockwise, its sides divided for the sum; shape (k, 2)."""
    corners = 0.5 * np.array([[1, -1], [1, 1], [-1, 1], [-1, -1]]) * np.array([length_mm, width_mm])
    share = np.arange(40)[:, None] / 40
    sides = [a + share * (b - a) for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    return np.concatenate(sides)


def chipped(outline: Array, depth_mm: float, towards_rad: float) -> Array:
    """An outline with a piece broken off, straight across, where it reaches farthest in a direction."""
    way = np.array([np.cos(towards_rad), np.sin(towards_rad)])
    over = outline @ way - ((outline @ way).max() - depth_mm)
    return outline - np.maximum(over, 0.0)[:, None] * way


def prism(
    outline: Array, thickness_mm: float, *, magnetisation: float = 1.0, centre_mm: Sequence[float] = (0, 0)
) -> Charges:
    """Charges of a prism magnetised along x, its top at z = 0."""
    along = np.roll(outline, -1, axis=0) - outline
    middle = outline + 0.5 * along + np.asarray(centre_mm)
    # normal times length of a side, of which M takes the x component
    flux = magnetisation * along[:, 1] * thickness_mm / FLOORS
    depth = -thickness_mm * (np.arange(FLOORS) + 0.5) / FLOORS
    place = np.concatenate([np.column_stack([middle, np.full(len(middle), z)]) for z in depth])
    return Charges(place, np.tile(flux, FLOORS))


def together(*parts: Charges) -> Charges:
    """Magnets beside or within one another; a hole is a magnet of the opposite magnetisation."""
    return Charges(np.concatenate([one.place_mm for one in parts]), np.concatenate([one.charge for one in parts]))


def tilt(angle_rad: float, towards_rad: float) -> Array:
    """Rotation by an angle about an axis in the x-y plane, shape (3, 3)."""
    x, y = np.cos(towards_rad), np.sin(towards_rad)
    cross = np.array([[0.0, 0.0, y], [0.0, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle_rad) * cross + (1 - np.cos(angle_rad)) * cross @ cross


@dataclass(frozen=True)
class Assembly:
    """How magnet and sensor stand to the shaft."""

    gap_mm: float
    magnet_mm: tuple[float, float] = (0.0, 0.0)
    """Off the shaft, in the magnet's axes: turns with it."""
    sensor_mm: tuple[float, float] = (0.0, 0.0)
    """Off the axis, in the sensor's axes."""
    magnet_tilt: tuple[float, float] = (0.0, 0.0)
    """Angle and direction, radians."""
    sensor_tilt: tuple[float, float] = (0.0, 0.0)


def field_of(charges: Charges, stands: Assembly) -> Callable[[Array], Channels]:
    """Field in the sensor's plane against the angle of the magnet in radians, mean amplitude 1."""
    angle = 2 * np.pi * np.arange(ANGLES) / ANGLES
    cosine, sine, flat = np.cos(angle), np.sin(angle), np.zeros(ANGLES)
    turn = np.stack([cosine, -sine, flat, sine, cosine, flat, flat, flat, flat + 1], axis=1).reshape(-1, 3, 3)
    body = charges.place_mm @ tilt(*stands.magnet_tilt).T + np.array([*stands.magnet_mm, 0.0])
    sensor = np.array([*stands.sensor_mm, stands.gap_mm])
    # in the magnet's axes the sensor goes round
    away = (sensor @ turn)[:, None, :] - body
    own = np.einsum("k,ak,akc->ac", charges.charge, (away**2).sum(axis=2) ** -1.5, away)
    plane = np.einsum("abc,ac->ab", turn, own) @ tilt(*stands.sensor_tilt)
    series = np.fft.fft(plane[:, 0] + 1j * plane[:, 1]) / ANGLES
    order = np.fft.fftfreq(ANGLES, 1.0 / ANGLES)
    kept = np.abs(series) > 1e-8 * np.abs(series).max()
    series, order = series[kept], order[kept]
    # the largest part goes round with the magnet: its size is the nominal amplitude, its phase a zero
    largest = series[np.argmax(np.abs(series))]
    series = series / largest

    def field(at: Array) -> Channels:
        total = np.exp(1j * np.outer(at, order)) @ series
        return total.real, total.imag

    return field
