"""The magnet's field at the sensor over a turn: a short Fourier series in the shaft angle, with its error bounded.

In the sensor's axes every component is periodic and analytic in theta, so a few evaluations give the whole turn:

- the sensor on the shaft's axis: the field is a fixed vector that turns with the shaft. One evaluation, exact.
- a round magnet centred and untilted: the field is linear in the magnetisation. One evaluation a radius, exact.
- a round magnet untilted, both off the axis: its series about the axis (axis_series.py), bounded a priori.
- otherwise: equispaced nodes on the circle that the sensor describes in the magnet's frame; their discrete Fourier
  transform interpolates the turn, and the decay of its coefficients bounds what is left out. Nodes are doubled
  until the bound is below the tolerance.

All functions are vectorised over designs: the numbers of Magnet and Placement may have the shape (designs,).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from twin.angles import TAU, Array
from twin.effect import BoolArray
from twin.limits import OutOfRangeError
from twin.magnet import axis_series
from twin.magnet.body_field import body_field, inside, round_components
from twin.magnet.magnet import Magnet
from twin.magnet.placement import LARGEST_GAP_MM, Placement, designs_of, turned

Part = TypeVar("Part", Magnet, Placement)

MT_PER_T = 1e3
TOLERANCE = 3e-10
"""Relative to the smallest |B| of the turn."""
ORDERS = (5, 6, 7, 8, 10, 13)
"""Designs are computed in groups, by the highest order that they need: up to each of these."""
FEWEST_NODES = 16
CACHED = 1 << 16
"""Numbers computed at a time, so that they stay in the processor's cache: 512 KiB."""
NODE_TOLERANCE = 1e-13
"""Of the field at one node, relative to that on the axis."""
MOST_NODES = 64
"""Beside a narrow bore, where the series does not reach, the field is magpylib's. Where that passes to its own short
series about the axis (rho < 0.05 radii) it steps by up to some 1e-9 of |B|: what is left beyond so many nodes is that
step, which stays in the bound."""


@dataclass(frozen=True, eq=False)
class Series:
    """B(theta) [mT] = coefficients @ (1, cos, sin, cos 2, sin 2, ...): ``(..., 3, 2 orders + 1)``.

    ``bound`` [mT] (...): the most that the interpolation leaves out of any component.
    """

    coefficients: Array
    bound: Array

    @property
    def orders(self) -> int:
        """The highest order held."""
        return int(self.coefficients.shape[-1] - 1) // 2

    def component(self, axis: int, angle_rad: Array) -> Array:
        """One component [mT] of a single design's series at angles of any shape."""
        if self.coefficients.ndim != 2:
            raise ValueError("a component is taken of one design")
        terms = self.coefficients[axis]
        # Horner's rule in exp(i theta): Re(c0 + z (c1 + z (c2 + ...))).
        z = np.exp(1j * angle_rad)
        total = np.zeros(np.shape(angle_rad), dtype=np.complex128)
        for cosine, sine in zip(terms[-2:0:-2], terms[:0:-2], strict=True):
            total = (total + (cosine - 1j * sine)) * z
        return np.asarray(terms[0] + total.real)


def basis(angle_rad: Array, orders: int) -> Array:
    """1, cos, sin, cos 2, ... at the angles (n,): ``(2 orders + 1, n)``."""
    turns = np.arange(1, orders + 1)[:, None] * angle_rad
    out = np.ones((2 * orders + 1, angle_rad.size))
    out[1::2], out[2::2] = np.cos(turns), np.sin(turns)
    return out


def field_mT(
    magnet: Magnet,
    placement: Placement,
    angle_rad: Array,
    *,
    temperature_c: float = 20.0,
    tolerance: float = TOLERANCE,
    out: Array | None = None,
) -> Array:
    """Field in the sensor's axes (designs..., 3, n) [mT] at the shaft angles (n,) [rad].

    ``out`` takes the answer where it is given, which spares a large allocation. Raises OutOfRangeError where the
    sensor would lie inside the magnet.
    """
    angle = np.asarray(angle_rad, dtype=np.float64)
    shape = (*designs_of(magnet, placement), 3, angle.size)
    answer = np.empty(shape) if out is None else out
    if len(shape) == 2:
        (_, series), *_ = series_by_group(magnet, placement, temperature_c=temperature_c, tolerance=tolerance)
        return np.matmul(series.coefficients[0], basis(angle, series.orders), out=answer)
    for rows, series in series_by_group(magnet, placement, temperature_c=temperature_c, tolerance=tolerance):
        terms, table = series.coefficients, basis(angle, series.orders)
        flat = terms.reshape(-1, terms.shape[-1])
        if rows.all():
            # One long product is several times faster than a stack of small ones.
            np.matmul(flat, table, out=answer.reshape(-1, angle.size))
        else:
            _scatter(flat, table, np.flatnonzero(rows), answer)
    return answer


def _scatter(terms: Array, table: Array, rows: NDArray[np.intp], out: Array) -> None:
    """The product (3 rows, n) into those rows of ``out`` (designs, 3, n), by pieces that stay in the cache."""
    piece = max(1, CACHED // (3 * table.shape[1]))
    held = np.empty((3 * piece, table.shape[1]))
    for start in range(0, len(rows), piece):
        to = rows[start : start + piece]
        part = np.matmul(terms[3 * start : 3 * (start + len(to))], table, out=held[: 3 * len(to)])
        out[to] = part.reshape(-1, 3, table.shape[1])


def series_of(magnet: Magnet, placement: Placement, *, temperature_c: float = 20.0) -> Series:
    """The series of a single design."""
    if designs_of(magnet, placement):
        raise ValueError("one design is expected")
    (_, series), *_ = series_by_group(magnet, placement, temperature_c=temperature_c)
    return Series(series.coefficients[0], series.bound[0])


def series_by_group(
    magnet: Magnet, placement: Placement, *, temperature_c: float = 20.0, tolerance: float = TOLERANCE
) -> Iterator[tuple[BoolArray, Series]]:
    """The designs in groups of equal cost: a mask (designs,) and the series of those rows."""
    count = int(np.prod(designs_of(magnet, placement)))
    everything = np.ones(count, dtype=bool)
    zero = np.zeros(count)
    on_axis = (placement.sensor_x_mm + zero == 0.0) & (placement.sensor_y_mm + zero == 0.0)
    shaft_side = ("magnet_x_mm", "magnet_y_mm", "magnet_tilt_x_deg", "magnet_tilt_y_deg")
    centred = np.all([getattr(placement, name) + zero == 0.0 for name in shaft_side], axis=0)
    linear = centred & ~on_axis & (magnet.shape != "block")
    sense = _Sense.of(magnet, placement, count, temperature_c)
    for rows, solve in ((on_axis, _turning_vector), (linear, _linear_in_magnetisation)):
        if rows.any():
            yield rows, sense(rows, solve(_rows(magnet, rows, everything), _rows(placement, rows, everything)))
    waiting = ~(on_axis | linear)
    for rows, series in _near_axis(magnet, placement, waiting, tolerance):
        yield rows, sense(rows, series)
        waiting &= ~rows
    nodes = FEWEST_NODES
    while waiting.any():
        part = _rows(magnet, waiting, everything), _rows(placement, waiting, everything)
        series, smallest = _interpolated(*part, nodes)
        done = series.bound <= tolerance * smallest
        if nodes >= MOST_NODES:
            done[:] = True
        if done.any():
            rows = np.zeros(count, dtype=bool)
            rows[np.flatnonzero(waiting)[done]] = True
            yield rows, sense(rows, Series(series.coefficients[done], series.bound[done]))
            waiting &= ~rows
        nodes *= 2


def _near_axis(
    magnet: Magnet, placement: Placement, rows: BoolArray, tolerance: float
) -> Iterator[tuple[BoolArray, Series]]:
    """Series of those ``rows`` that are untilted round magnets with the sensor near their axis, in groups of orders."""
    zero = np.zeros(rows.shape)
    tilted = (placement.magnet_tilt_x_deg + zero != 0.0) | (placement.magnet_tilt_y_deg + zero != 0.0)
    if magnet.shape == "block" or not np.any(rows & ~tilted):
        return
    path = axis_series.path_of(magnet, placement, rows.size)
    rows = rows & ~tilted & (path.share <= axis_series.FARTHEST)
    # Either of the two parts of the bound, and off the axis the field may be weaker by as much.
    limit = 0.1 * tolerance * np.abs(path.axis_taylor(1)[0])
    with np.errstate(invalid="ignore"):
        terms, orders = axis_series.terms_needed(path, limit), axis_series.orders_needed(path, limit)
    group = np.searchsorted(ORDERS, orders)
    for each in np.unique(group[rows]):
        chosen = rows & (group == each)
        most = int(np.max(terms[chosen])), int(np.max(orders[chosen]))
        coefficients, smallest = axis_series.turn(path.rows(chosen), terms=most[0], orders=most[1])
        bound = 2.0 * limit[chosen]
        # Where the field nearly vanishes on the way, the nodes of _interpolated take over.
        done = bound <= tolerance * smallest
        if not done.all():
            chosen[np.flatnonzero(chosen)[~done]] = False
            coefficients, bound = coefficients[done], bound[done]
        yield chosen, Series(coefficients, bound)


def _turning_vector(magnet: Magnet, placement: Placement) -> Series:
    """Sensor on the axis: B = Rz(theta) b0, with b0 the field at theta = 0."""
    b = _at_nodes(magnet, placement, np.zeros(1))[..., 0, :]
    terms = np.zeros((*b.shape[:-1], 3, 3))
    x, y, z = b[..., 0], b[..., 1], b[..., 2]
    terms[..., 0, 1], terms[..., 0, 2] = x, -y
    terms[..., 1, 1], terms[..., 1, 2] = y, x
    terms[..., 2, 0] = z
    return Series(terms, np.zeros(b.shape[:-1]))


def _linear_in_magnetisation(magnet: Magnet, placement: Placement) -> Series:
    """Round magnet, centred and untilted: B = -f (m e_rho) e_rho + g (m e_phi) e_phi - h (m e_rho) e_z.

    m = (cos theta, sin theta) is the direction of the field on the axis, opposite to the magnetisation.
    """
    at = placement.sensor_mm(magnet)
    rho = np.hypot(at[..., 0], at[..., 1])
    _refuse_inside(magnet, placement, at[..., None, :])
    f, g, h = (part[..., 0] for part in round_components(magnet, rho[..., None], at[..., 2, None]))
    c, s = at[..., 0] / rho, at[..., 1] / rho
    terms = np.zeros((*rho.shape, 3, 3))
    terms[..., 0, 1] = -f * c * c + g * s * s
    terms[..., 0, 2] = terms[..., 1, 1] = -(f + g) * s * c
    terms[..., 1, 2] = -f * s * s + g * c * c
    terms[..., 2, 1], terms[..., 2, 2] = -h * c, -h * s
    return Series(terms, np.zeros(rho.shape))


def _interpolated(magnet: Magnet, placement: Placement, nodes: int) -> tuple[Series, Array]:
    """The interpolant through ``nodes`` nodes, and the smallest |B| found (designs,)."""
    values = _at_nodes(magnet, placement, np.arange(nodes) * TAU / nodes)
    spectrum = np.fft.rfft(values, axis=-2)[..., : nodes // 2, :] / nodes
    terms = np.empty((*values.shape[:-2], 3, nodes - 1))
    terms[..., 0] = spectrum[..., 0, :].real
    terms[..., 1::2] = 2.0 * np.moveaxis(spectrum[..., 1:, :].real, -1, -2)
    terms[..., 2::2] = -2.0 * np.moveaxis(spectrum[..., 1:, :].imag, -1, -2)
    smallest = np.min(np.linalg.norm(values, axis=-1), axis=-1)
    return Series(terms, _left_out(np.max(np.abs(spectrum), axis=-1), nodes)), smallest


def _left_out(size: Array, nodes: int) -> Array:
    """Bound (designs,) of the interpolation error from the sizes of the coefficients (designs, nodes/2).

    The coefficients of a function analytic in a strip fall geometrically. Their largest in the last quarter, and the
    rate of the fall from the quarter before it, give the sum of all those above the last; aliasing doubles it and a
    factor of two is kept in hand. The rate is not trusted below 0.9.
    """
    quarter = nodes // 8
    last = np.max(size[..., 3 * quarter :], axis=-1)
    before = np.max(size[..., 2 * quarter : 3 * quarter], axis=-1)
    rate = np.clip((last / np.maximum(before, 1e-300)) ** (1.0 / quarter), 0.0, 0.9)
    return np.asarray(8.0 * last * rate / (1.0 - rate))


def _at_nodes(magnet: Magnet, placement: Placement, theta: Array) -> Array:
    """Field in the stator's frame (designs, nodes, 3), for a unit remanence, from the magnet's closed form."""
    points = _points_mm(magnet, placement, theta)
    _refuse_inside(magnet, placement, points)
    field = -_unit_field(magnet, points) @ np.swapaxes(placement.magnet_axes, -1, -2)
    return turned(field, theta)


def _unit_field(magnet: Magnet, points_mm: Array) -> Array:
    """Field (designs, nodes, 3) for a unit remanence: by the series where it reaches, else by the closed form."""
    if magnet.shape == "block":
        return body_field(magnet, points_mm)
    cloud = axis_series.cloud_of(magnet, points_mm)
    near = cloud.share <= axis_series.FARTHEST
    if near.all():
        return axis_series.field_at(cloud, NODE_TOLERANCE)
    out = np.empty(points_mm.shape)
    out[near] = axis_series.field_at(cloud.rows(near), NODE_TOLERANCE)
    out[~near] = body_field(_rows(magnet, ~near, near), points_mm[~near])
    return out


def _points_mm(magnet: Magnet, placement: Placement, theta: Array) -> Array:
    """The sensor in the magnet's frame (designs, nodes, 3) [mm]."""
    at = turned(placement.sensor_mm(magnet)[..., None, :], -theta)
    return np.asarray((at - placement.magnet_mm[..., None, :]) @ placement.magnet_axes)


@dataclass(frozen=True, eq=False)
class _Sense:
    """From the field of a unit remanence to the field in the sensor's axes: scale, stray field, axes of each design."""

    scale_mT: Array
    stray_mT: Array
    axes: Array | None

    @classmethod
    def of(cls, magnet: Magnet, placement: Placement, count: int, temperature_c: float) -> _Sense:
        tilted = np.any(np.asarray(placement.sensor_tilt_x_deg)) or np.any(np.asarray(placement.sensor_tilt_y_deg))
        return cls(
            scale_mT=np.broadcast_to(MT_PER_T * magnet.remanence_at(temperature_c), (count,)),
            stray_mT=np.broadcast_to(placement.stray_mT, (count, 3)),
            axes=np.broadcast_to(placement.sensor_axes, (count, 3, 3)) if tilted else None,
        )

    def __call__(self, rows: BoolArray, series: Series) -> Series:
        """Scaled by the remanence, with the stray field, in the sensor's axes."""
        scale = self.scale_mT[rows]
        terms = series.coefficients * scale[:, None, None]
        terms[..., 0] += self.stray_mT[rows]
        if self.axes is not None:
            terms = np.swapaxes(self.axes[rows], -1, -2) @ terms
        return Series(terms, series.bound * scale)


def _refuse_inside(magnet: Magnet, placement: Placement, points_mm: Array) -> None:
    hit = np.any(inside(magnet, points_mm), axis=-1)
    if not np.any(hit):
        return
    first = np.zeros(hit.size, dtype=bool)
    first[np.flatnonzero(hit)[0]] = True
    design = _rows(magnet, first, first), _rows(placement, first, first)
    gap = float(np.ravel(design[1].air_gap_mm)[0])
    # Rounded up, so that the figure named is itself allowed.
    clear = np.ceil(1e3 * _clear_gap_mm(*design)) / 1e3
    raise OutOfRangeError(
        f"air_gap_mm is {gap:g} mm, where these tilts and displacements turn the magnet into the sensor; "
        f"expected from {clear:g} to {LARGEST_GAP_MM:g} mm"
    )


def _clear_gap_mm(magnet: Magnet, placement: Placement) -> float:
    """The smallest air gap [mm] at which one design's magnet keeps clear of the sensor over the whole turn.

    By bisection at every half degree. A bore counts as filled, which makes the body convex: further up is clear too.
    """
    body = replace(magnet, shape="cylinder") if magnet.shape == "ring" else magnet
    theta = np.arange(720) * TAU / 720
    # A body that reaches up to ``reach`` above its centre cannot reach the plane above that.
    reach = np.max(np.hypot(magnet.reach_mm, 0.5 * np.asarray(magnet.height_mm)))
    low, high = 0.0, float(reach)
    for _ in range(40):
        middle = 0.5 * (low + high)
        points = _points_mm(magnet, replace(placement, air_gap_mm=middle), theta)
        low, high = (middle, high) if np.any(inside(body, points)) else (low, middle)
    return high


def _rows(part: Part, rows: BoolArray, of: BoolArray) -> Part:
    """The designs of ``rows`` alone; scalars become arrays of their number."""
    count = int(np.count_nonzero(rows))
    changes: dict[str, Any] = {}
    for item in fields(part):
        value = getattr(part, item.name)
        if value is None or isinstance(value, str):
            continue
        array = np.asarray(value, dtype=np.float64)
        changes[item.name] = np.full(count, array) if array.ndim == 0 else np.broadcast_to(array, of.shape)[rows]
    return replace(part, **changes)
