"""A round magnet's field near its axis, as the series of its potential: many designs at once, cheaply.

Off its axis the field of a diametral cylinder follows from that on it. With p = x + iy, u = |p|^2, a(z) the transverse
field on the axis, and S(u) = sum_k (-1/4)^k a^(2k)(z) u^k / (k! (k+1)!), Laplace's equation gives

    Hx + i Hy = S + u S' + p^2 S',    Hz = x dS/dz.

On the axis a(z) = (F(t-) - F(t+)) / 4 with F(t) = t / sqrt(1 + t^2), t the heights above the two faces in radii; the
Taylor coefficients of F are Gegenbauer polynomials. magpylib holds the first three terms of S below 0.05 radii; here
there are as many as the tolerance asks. The series converges where rho is less than the way from the point's foot on
the axis to the nearest rim.

Within that reach S is a sum of solid harmonics about a point of the axis; a tilted magnet's turn is summed from them
node by node. Untilted, z stays the same over a turn and u = c0 - c1 cos(psi), with psi the shaft angle from where
sensor and magnet are closest: S + u S', S' and dS/dz are cosine series in psi, known from a few nodes of half a turn.
Source: the series is the regular solution of Laplace's equation for cos(phi), Jackson, Classical Electrodynamics,
3rd ed., section 3.7; the field on the axis: Caciagli et al., J. Magn. Magn. Mater. 456 (2018) 423.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from twin.angles import Array
from twin.effect import BoolArray
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement

FARTHEST = 0.65
"""Largest distance from the axis, as a share of that to the rim, for which the series is taken."""
CACHED = 1 << 13
"""Points that are summed together, so that their arrays stay in the cache."""
INNER = 0.75
"""Share of the squared radius of convergence up to which the bound on the cosine series looks."""


@dataclass(frozen=True, eq=False)
class Path:
    """The sensor's circles in the frames of untilted round magnets, lengths in outer radii; all arrays (designs,).

    p = sensor exp(-i theta) - magnet, and psi = theta - start. ``height`` is that of the sensor over the magnet's
    centre, ``half`` half the magnet's, ``bore`` the bore's radius (0: none), ``edge`` the way from the foot on the axis
    to the nearest rim.
    """

    sensor: NDArray[np.complex128]
    magnet: NDArray[np.complex128]
    start: Array
    height: Array
    half: Array
    bore: Array
    edge: Array

    @property
    def share(self) -> Array:
        """The largest distance from the axis as a share of the radius of convergence (designs,)."""
        return np.asarray((np.abs(self.sensor) + np.abs(self.magnet)) / self.edge)

    def axis_taylor(self, count: int) -> Array:
        """Taylor coefficients (count, designs) of the field on the axis at the sensor's height."""
        return axis_taylor(self.half, self.height, self.bore, count)

    def rows(self, chosen: BoolArray) -> Path:
        """The path of these designs alone."""
        return Path(*(getattr(self, item.name)[chosen] for item in fields(self)))


def path_of(magnet: Magnet, placement: Placement, designs: int) -> Path:
    """The path of each design; numbers of magnet and placement are scalars or (designs,)."""
    radius = 0.5 * np.asarray(magnet.diameter_mm, dtype=np.float64)
    sensor = (placement.sensor_x_mm + 1j * np.asarray(placement.sensor_y_mm)) / radius
    centre = (placement.magnet_x_mm + 1j * np.asarray(placement.magnet_y_mm)) / radius
    gap, half = np.asarray(placement.air_gap_mm) / radius, 0.5 * np.asarray(magnet.height_mm) / radius
    bore = _bore(magnet, radius)
    edge = np.hypot(np.where(bore > 0.0, bore, 1.0), gap)
    values = (sensor, centre, np.angle(sensor) - np.angle(centre), gap + half, half, bore, edge)
    return Path(*(np.broadcast_to(value, (designs,)) for value in values))


def _bore(magnet: Magnet, radius: Array) -> Array:
    return 0.5 * np.asarray(magnet.bore_mm) / radius if magnet.shape == "ring" else np.zeros(1)


def axis_taylor(half: Array, height: Array, bore: Array, count: int) -> Array:
    """Taylor coefficients (count, designs) of the field on the axis, a(z), at these heights; lengths in outer radii."""
    out = _cylinder_taylor(half, height, count)
    if not np.any(bore > 0.0):
        return out
    # A vanishing bore takes nothing away; the closed form wants a radius, so it gets a harmless one.
    ratio = 1.0 / np.where(bore > 0.0, bore, 1.0)
    inner = _cylinder_taylor(half * ratio, height * ratio, count)
    inner *= ratio ** np.arange(count)[:, None]
    return out - np.where(bore > 0.0, inner, 0.0)


def _cylinder_taylor(half: Array, height: Array, count: int) -> Array:
    """The same for a cylinder of radius 1: F_0 = t / E, n F_n = E^(-2-n) C_(n-1)^(3/2)(-t / E), E^2 = 1 + t^2."""
    t = np.stack([height - half, height + half])
    square = 1.0 / (1.0 + t * t)
    slope = -t * square
    terms = np.zeros((count + 2, *t.shape))
    # terms[n + 1] = E^(-3-n) C_n^(3/2)(-t / E), by the three-term recurrence.
    terms[1] = square * np.sqrt(square)
    for n in range(1, count - 1):
        np.multiply(slope * (2 + 1 / n), terms[n], out=terms[n + 1])
        terms[n + 1] -= square * (1 + 1 / n) * terms[n - 1]
    terms[0] = t * np.sqrt(square)
    scale = 0.25 / np.maximum(np.arange(count), 1)[:, None]
    return np.asarray((terms[:count, 0] - terms[:count, 1]) * scale)


def terms_needed(path: Path, limit: Array) -> Array:
    """How many terms of the series in u leave out less than ``limit`` (designs,) of any component.

    |C_n^(3/2)| <= (n+1)(n+2)/2 bounds term k by 2 sqrt(k+1) share^2k / edge^2, for a bore too.
    """
    rate = -2.0 * np.log(path.share)
    need = -np.log(0.5 * limit * path.edge**2 * (1.0 - path.share**2) ** 1.5)
    # The number wanted stands under the root too; ln 2 covers a number four times the first guess.
    return np.asarray(np.ceil((need + 0.5 * np.log1p(need / rate) + np.log(2.0)) / rate))


def orders_needed(path: Path, limit: Array) -> Array:
    """Up to which order cosine series, from one node more, are off by less than ``limit`` (designs,).

    At complex psi |u| is at most c0 + c1 cosh(Im psi). Where that is INNER of the squared radius of convergence, the
    terms' bounds above sum to 2 (1 - INNER)^(-3/2) / edge^2 at most, so coefficient j is below twice that times
    exp(-j |Im psi|); those beyond the last count twice, where they are left out and where they are folded back.
    """
    sensor, magnet = np.abs(path.sensor), np.abs(path.magnet)
    room = INNER * path.edge**2 - sensor**2 - magnet**2
    rate = np.arccosh(0.5 * room / np.maximum(sensor * magnet, 1e-300))
    ceiling = 8.0 * (1.0 - INNER) ** -1.5 / path.edge**2 / -np.expm1(-rate)
    return np.asarray(np.maximum(np.ceil(np.log(ceiling / limit) / rate) - 1.0, 0.0))


def turn(path: Path, *, terms: int, orders: int) -> tuple[Array, Array]:
    """Coefficients (designs, 3, 2 orders + 3) of a turn for a unit remanence, and a lower bound of |B| (designs,).

    ``terms`` of the series in u; ``orders`` of the cosine series, which the products with p^2 and x raise by one.
    """
    along = path.axis_taylor(2 * terms)
    k = np.arange(terms)
    weight = transverse_weights(terms)
    s, dz = along[0::2] * weight, along[1::2] * (weight * (2 * k[:, None] + 1))
    nodes = np.pi * (np.arange(orders + 1) + 0.5) / (orders + 1)
    sensor, magnet = np.abs(path.sensor), np.abs(path.magnet)
    u = sensor**2 + magnet**2 - 2.0 * sensor * magnet * np.cos(nodes)[:, None]
    inner, outer, vertical = _horner(s * (k[:, None] + 1), u), _horner(s[1:] * k[1:, None], u), _horner(dz, u)
    smallest = np.min(np.abs(np.abs(inner) - u * np.abs(outer)), axis=0)
    transform = np.cos(np.arange(orders + 1)[:, None] * nodes) * (2.0 / (orders + 1))
    transform[0] *= 0.5
    return _assembled(path, *(transform @ part for part in (inner, outer, vertical))), smallest


def transverse_weights(terms: int) -> Array:
    """(2k)! / (k! (k+1)! 4^k) with its sign (terms, 1): what the Taylor coefficients 2k on the axis are in S."""
    k = np.arange(1, terms)
    return np.cumprod(np.concatenate([[1.0], -(k - 0.5) / (k + 1.0)]))[:, None]


def _horner(terms: Array, u: Array) -> Array:
    total = np.broadcast_to(terms[-1], u.shape).copy() if len(terms) else np.zeros_like(u)
    for row in terms[-2::-1]:
        total *= u
        total += row
    return total


def _assembled(path: Path, inner: Array, outer: Array, vertical: Array) -> Array:
    """The turn from the cosine series (orders + 1, designs) in psi of S + u S', S' and dS/dz.

    In the stator's frame, with p = sensor exp(-i theta) - magnet in the shaft's,
    Hx + i Hy = exp(i theta) (inner + p^2 outer) and Hz = Re(p) vertical.
    """
    top = len(inner)
    turns = np.empty(inner.shape, dtype=np.complex128)
    # The sign: at theta = 0 the magnet is magnetised along -x.
    turns[0], start = -1.0, np.exp(-1j * path.start)
    for n in range(1, top):
        np.multiply(turns[n - 1], start, out=turns[n])
    q, o, v = (_two_sided(cosine * turns) for cosine in (inner, outer, vertical))
    a, b = path.sensor, path.magnet
    plane = a * a * o[2:] - 2.0 * a * b * o[1:-1] + b * b * o[:-2] + q[:-2]
    upright = a * v[2:] - b * v[1:-1]
    rows = np.empty((3, 2 * top + 1, path.height.size))
    for part, axes in ((plane, (0, 1)), (upright, (2,))):
        forth, back = part[top:], part[top::-1]
        both, apart = forth + back, back - forth
        # x and z are the real part of the two-sided series, y the imaginary one.
        for axis, cosine, sine in zip(axes, (both.real, both.imag), (apart.imag, -apart.real), strict=False):
            rows[axis, 0], rows[axis, 1::2], rows[axis, 2::2] = 0.5 * cosine[0], cosine[1:], sine[1:]
    return np.ascontiguousarray(np.moveaxis(rows, -1, 0))


def _two_sided(terms: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Coefficients (top, n) of Re sum_j c_j exp(i j theta) as two-sided ones, with two zeros more at either end."""
    top = len(terms)
    out = np.zeros((2 * top + 3, terms.shape[1]), dtype=np.complex128)
    out[top + 1 : -2] = 0.5 * terms
    out[top + 1] += out[top + 1]
    np.conjugate(out[top + 2 : -2], out=out[top:1:-1])
    return out


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points (designs, 3, nodes) in the frames of round magnets, in outer radii, counted from their middle height.

    ``height``, ``half``, ``bore``, ``edge`` (designs,) as for :class:`Path`, at that height.
    """

    points: Array
    height: Array
    half: Array
    bore: Array
    edge: Array

    @property
    def share(self) -> Array:
        """The largest distance from the middle as a share of the radius of convergence; infinite beside the magnet."""
        reach = np.sqrt(np.max(np.einsum("dkn,dkn->dn", self.points, self.points), axis=1)) / self.edge
        return np.where(np.abs(self.height) > self.half, reach, np.inf)

    def rows(self, chosen: BoolArray | NDArray[np.intp]) -> Cloud:
        """The points of these designs alone."""
        return Cloud(*(getattr(self, item.name)[chosen] for item in fields(self)))


def cloud_of(magnet: Magnet, points_mm: Array) -> Cloud:
    """The points (designs, nodes, 3) [mm] of each design's magnet, whose numbers are (designs,)."""
    radius = 0.5 * np.asarray(magnet.diameter_mm)
    points = np.moveaxis(points_mm / radius[:, None, None], -1, -2).copy()
    height = points[:, 2].mean(axis=-1)
    points[:, 2] -= height[:, None]
    half, bore = 0.5 * np.asarray(magnet.height_mm) / radius, np.broadcast_to(_bore(magnet, radius), radius.shape)
    edge = np.hypot(np.where(bore > 0.0, bore, 1.0), np.abs(height) - half)
    return Cloud(points, height, half, bore, edge)


def field_at(cloud: Cloud, tolerance: float) -> Array:
    """Field (designs, nodes, 3) for a unit remanence along +x, to this share of that on the axis.

    With W_n = r^n C_n^(3/2)(w / r), S = sum_n 2 a_n W_n / ((n+1)(n+2)) over the Taylor coefficients a_n; its derivative
    in w lowers n by one, and the one in u follows as S is made of homogeneous polynomials. Term n of a component is
    bounded by (n+1)^2 share^n / edge^2.
    """
    nominal = np.abs(axis_taylor(cloud.half, cloud.height, cloud.bore, 1)[0])
    share = np.maximum(cloud.share, 1e-9)
    rate = -np.log(share)
    need = -np.log(tolerance * nominal * cloud.edge**2 * (1.0 - share) ** 3)
    # (n+1)^2 stands under the logarithm too; ln 16 covers a number four times the first guess.
    degrees = np.ceil((need + 2.0 * np.log1p(need / rate) + np.log(16.0)) / rate).astype(int)
    out = np.empty((*cloud.points.shape[::2], 3))
    order = np.argsort(degrees)
    piece = max(1, CACHED // cloud.points.shape[2])
    for start in range(0, order.size, piece):
        part = order[start : start + piece]
        out[part] = _summed(cloud.rows(part), int(degrees[part[-1]]) + 1)
    return out


def _summed(cloud: Cloud, count: int) -> Array:
    """The sum of the first ``count`` harmonics (designs, nodes, 3)."""
    x, y, w = np.ascontiguousarray(cloud.points.transpose(1, 2, 0))
    square = x * x + y * y + w * w
    n = np.arange(count + 1)[:, None]
    terms = axis_taylor(cloud.half, cloud.height, cloud.bore, count + 1) * (2.0 / ((n + 1) * (n + 2)))
    older, last = np.zeros_like(w), np.ones_like(w)
    value, scaled, slope = np.zeros_like(w), np.zeros_like(w), np.zeros_like(w)
    for k in range(count):
        value += terms[k] * last
        scaled += (k * terms[k]) * last
        slope += ((k + 3) * terms[k + 1]) * last
        older, last = last, ((2 * k + 3) * w * last - (k + 2) * square * older) / (k + 1)
    # 2 u dS/du: what homogeneity leaves to u.
    scaled -= w * slope
    u = x * x + y * y
    over = np.divide(scaled, u, out=np.zeros_like(u), where=u > 0.0)
    return np.stack([value + x * x * over, x * y * over, x * slope], axis=-1).swapaxes(0, 1)
