"""A magnet's field where it turns, reading by reading: cheap enough for a fit to move magnet and sensor.

With z' along the axis of a round magnet, p' = x' + iy' off it and u = |p'|^2 its field is the gradient of x' S(u, z')
(:mod:`twin.magnet.axis_series`). S is a polynomial in u and in the change of height that a tilt brings, so a
displacement costs no field of a new design. A block's field is its closed form at each reading's point.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from twin.angles import TAU, Array
from twin.magnet.assembly import Assembly
from twin.magnet.axis_series import axis_taylor, transverse_weights
from twin.magnet.body_field import body_field

TERMS = 6
"""In the squared distance from the axis, in radii."""
HEIGHTS = 3
"""In the change of height, which tilts bring. Both as few as a fit needs: with the usual magnet 0.4 mm and its sensor
0.8 mm off the axis and 3 deg tilted, they leave out 3e-6 of the field."""

_SMALL = 1e-3
"""Displacement in radii, tilt in radians, for a derivative: the next order is that much smaller."""

Vector = tuple[Any, Any, Any]


@dataclass(frozen=True)
class Pose:
    """Where sensor and magnet sit: displacements [mm] as complex numbers, tilts [rad] about x, then y.

    The sensor's count in the stator, the magnet's in the shaft; see :mod:`twin.magnet.placement`. ``lean`` is one tilt
    more of the sensor [rad], as a complex number: its normal leans by so much towards there. Numbers, or arrays that
    broadcast against signals.
    """

    sensor: Any = 0.0
    magnet: Any = 0.0
    sensor_tilt: tuple[Any, Any] = (0.0, 0.0)
    magnet_tilt: tuple[Any, Any] = (0.0, 0.0)
    lean: Any = 0.0

    @property
    def centred(self) -> bool:
        """Whether nothing is displaced or tilted."""
        return not any(map(np.any, (self.sensor, self.magnet, self.lean, *self.sensor_tilt, *self.magnet_tilt)))

    def __add__(self, other: Pose) -> Pose:
        """Both displacements and tilts together; tilts are small, so their order does not count."""
        return Pose(
            self.sensor + other.sensor,
            self.magnet + other.magnet,
            (self.sensor_tilt[0] + other.sensor_tilt[0], self.sensor_tilt[1] + other.sensor_tilt[1]),
            (self.magnet_tilt[0] + other.magnet_tilt[0], self.magnet_tilt[1] + other.magnet_tilt[1]),
            self.lean + other.lean,
        )


@dataclass(frozen=True, eq=False)
class UnevenField:
    """The field of one magnet about its place over the sensor, relative to that on the axis."""

    assembly: Assembly

    @property
    def radius_mm(self) -> float:
        """Of the circle about the axis that holds the magnet."""
        return float(self.assembly.magnet.reach_mm)

    @cached_property
    def height(self) -> float:
        """Of the sensor over the magnet's centre, in radii."""
        return float(self.assembly.distance_mm) / self.radius_mm

    @cached_property
    def terms(self) -> Array:
        """S of a round magnet over its value on the axis, as coefficients (TERMS, HEIGHTS).

        Of powers of u and of the change of height.
        """
        magnet = self.assembly.magnet
        half = 0.5 * float(magnet.height_mm) / self.radius_mm
        bore = 0.5 * float(magnet.bore_mm) / self.radius_mm if magnet.shape == "ring" else 0.0
        along = axis_taylor(np.array([half]), np.array([self.height]), np.array([bore]), 2 * TERMS + HEIGHTS)[:, 0]
        # The Taylor coefficient n of the field on the axis, some way up, is a binomial sum of those here.
        order, up = 2 * np.arange(TERMS)[:, None], np.arange(HEIGHTS)
        binomial = np.cumprod(np.concatenate([np.ones((TERMS, 1)), (order + up[1:]) / up[1:]], axis=1), axis=1)
        found = transverse_weights(TERMS) * binomial * along[order + up]
        return np.asarray(found / found[0, 0])

    @property
    def turn_per_mm2(self) -> float:
        """What a product of both displacements turns the angle by [rad/mm2], to the leading order."""
        return abs(self.second_per_mm2)

    @property
    def second_per_mm2(self) -> float:
        """The part of the field that turns twice as fast as the magnet, of a product of both displacements [1/mm2]."""
        return float(-2.0 * self.terms[1, 0] / self.radius_mm**2)

    @cached_property
    def shift_of_tilt_mm(self) -> tuple[complex, complex]:
        """Which displacements of the magnet [mm] show as its tilts about x and y [1/rad] do, to first order.

        Off the axis by s, a displacement m of the magnet adds to the field what a constant would, and beside it
        something to its size alone, with s times the conjugate of m in the field of a round magnet, with another
        linear function of m in that of a block: that is what an offset cannot do. A tilt adds the like.
        """
        turn = np.exp(1j * TAU * np.arange(8) / 8.0)
        away, small = _SMALL * self.radius_mm, _SMALL

        def beside_an_offset(**magnet: Any) -> complex:
            """Order 1 of the size less that of the angle; in a constant's field they are the same."""
            fields = (np.log(self.of(turn, Pose(sign * away, **magnet)) / turn) for sign in (1.0, -1.0))
            odd = 0.5 * np.subtract(*fields)
            return complex(2.0 * np.mean((odd.real - 1j * odd.imag) * turn))

        still = beside_an_offset()
        x, y = (beside_an_offset(magnet=away * way) - still for way in (1.0, 1j))
        by_shift = np.array([[x.real, y.real], [x.imag, y.imag]]) / away
        shifts = []
        for tilt in ((small, 0.0), (0.0, small)):
            shown = (beside_an_offset(magnet_tilt=tilt) - still) / small
            shifts.append(complex(*np.linalg.solve(by_shift, [shown.real, shown.imag])))
        return shifts[0], shifts[1]

    def of(self, turn: Any, pose: Pose) -> Array:
        """Bx + i By in the sensor's axes at the field angles whose unit vectors are ``turn``, over B on the axis."""
        if pose.centred:
            return np.asarray(turn)
        turn = np.asarray(turn)
        cosine, sine = np.array(turn.real), np.array(turn.imag)
        # Real parts throughout: complex products and quotients of whole records take twice as long.
        x, y = -np.real(pose.magnet) / self.radius_mm, -np.imag(pose.magnet) / self.radius_mm
        # A sensor on the axis sees the magnet turn rigidly: one point for the whole turn.
        if np.any(pose.sensor):
            along, across = np.real(pose.sensor) / self.radius_mm, np.imag(pose.sensor) / self.radius_mm
            x, y = along * cosine + across * sine + x, across * cosine - along * sine + y
        inside = _back((x, y, self.height), pose.magnet_tilt)
        x, y, z = _tilted(self._field(inside), pose.magnet_tilt)
        x, y = cosine * x - sine * y, sine * x + cosine * y
        if np.any(pose.lean):
            lean = np.abs(pose.lean)
            towards = np.where(lean > 0.0, pose.lean, 1.0) / np.where(lean > 0.0, lean, 1.0)
            along, across = towards.real, towards.imag
            x, y, z = _back((along * x + across * y, along * y - across * x, z), (0.0, lean))
            x, y = along * x - across * y, along * y + across * x
        x, y, _ = _back((x, y, z), pose.sensor_tilt)
        found: Any = np.empty(np.broadcast(x, y).shape, dtype=np.complex128)
        found.real, found.imag = x, y
        return np.asarray(found)

    def _field(self, point: Vector) -> Vector:
        """In the magnet's frame over that on the axis, at a point in radii: of a round magnet the gradient of x S."""
        x, y, z = point
        if self.assembly.magnet.shape == "block":
            field = self._block(np.stack(np.broadcast_arrays(x, y, z), axis=-1))
            return field[..., 0], field[..., 1], field[..., 2]
        value, slope, rise = _sums(self.terms, x * x + y * y, z - self.height)
        return value + 2.0 * x * x * slope, 2.0 * x * y * slope, x * rise

    def _block(self, points: Array) -> Array:
        """Of a block over that on the axis at points (..., 3) in radii."""
        axis = body_field(self.assembly.magnet, self.radius_mm * np.array([[0.0, 0.0, self.height]]))[0, 0]
        flat = body_field(self.assembly.magnet, self.radius_mm * points.reshape(-1, 3))
        return np.asarray(flat.reshape(points.shape) / axis)


def _sums(terms: Array, square: Any, up: Any) -> tuple[Any, Any, Any]:
    """The polynomial with coefficients (powers of square, HEIGHTS powers of up), and its derivatives by both."""
    value, slope, rise = 0.0, 0.0, 0.0
    for still, first, second in terms[::-1]:
        # Horner's rule, and its derivative.
        slope = slope * square + value
        value = value * square + (still + up * (first + up * second))
        rise = rise * square + (first + 2.0 * second * up)
    return value, slope, rise


def _tilted(vector: Vector, tilt: tuple[Any, Any]) -> Vector:
    """Turned about x, then about the fixed y axis."""
    x, y, z = vector
    y, z = _turned(y, z, tilt[0])
    z, x = _turned(z, x, tilt[1])
    return x, y, z


def _back(vector: Vector, tilt: tuple[Any, Any]) -> Vector:
    """The same the other way."""
    x, y, z = vector
    z, x = _turned(z, x, -tilt[1])
    y, z = _turned(y, z, -tilt[0])
    return x, y, z


def _turned(first: Any, second: Any, angle: Any) -> tuple[Any, Any]:
    """Two components turned from the first towards the second."""
    if not np.any(angle):
        return first, second
    c, s = np.cos(angle), np.sin(angle)
    return c * first - s * second, s * first + c * second
