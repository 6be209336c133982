"""The magnet's field at the sensor over a turn: a short Fourier series in the shaft angle, with its error bounded.

In the sensor's axes every component is periodic and analytic in theta, so a few evaluations give the whole turn:

- the sensor on the shaft's axis: the field is a fixed vector that turns with the shaft. One evaluation, exact.
- a round magnet centred and untilted: the field is linear in the magnetisation. One evaluation a radius, exact.
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

from twin.angles import TAU, Array
from twin.effect import BoolArray
from twin.limits import OutOfRangeError
from twin.magnet.body_field import body_field, inside, round_components
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement, designs_of, turned

Part = TypeVar("Part", Magnet, Placement)

MT_PER_T = 1e3
TOLERANCE = 3e-10
"""Relative to the smallest |B| of the turn."""
FEWEST_NODES = 16
MOST_NODES = 64
"""Where magpylib passes to its series about the axis (rho < 0.05 radii) its field steps by some 1e-9 of |B|: what is
left beyond so many nodes is that step, which stays in the bound."""


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
            answer[rows] = (flat @ table).reshape(-1, 3, angle.size)
    return answer


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
    for rows, solve in ((on_axis, _turning_vector), (linear, _linear_in_magnetisation)):
        if rows.any():
            part = _rows(magnet, rows, everything), _rows(placement, rows, everything)
            series = solve(*part)
            yield rows, _in_sensor(series, *part, temperature_c=temperature_c)
    waiting = ~(on_axis | linear)
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
            kept = _rows(part[0], done, done), _rows(part[1], done, done)
            solved = Series(series.coefficients[done], series.bound[done])
            yield rows, _in_sensor(solved, *kept, temperature_c=temperature_c)
            waiting &= ~rows
        nodes *= 2


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
    at = turned(placement.sensor_mm(magnet)[..., None, :], -theta)
    axes = placement.magnet_axes
    points = (at - placement.magnet_mm[..., None, :]) @ axes
    _refuse_inside(magnet, placement, points)
    field = -body_field(magnet, points) @ np.swapaxes(axes, -1, -2)
    return turned(field, theta)


def _in_sensor(series: Series, magnet: Magnet, placement: Placement, *, temperature_c: float) -> Series:
    """Scaled by the remanence, with the stray field, in the sensor's axes."""
    scale = MT_PER_T * np.broadcast_to(magnet.remanence_at(temperature_c), series.bound.shape)
    terms = series.coefficients * scale[..., None, None]
    terms[..., 0] += placement.stray_mT
    tilted = np.any(np.asarray(placement.sensor_tilt_x_deg)) or np.any(np.asarray(placement.sensor_tilt_y_deg))
    if tilted:
        terms = np.swapaxes(placement.sensor_axes, -1, -2) @ terms
    return Series(terms, series.bound * scale)


def _refuse_inside(magnet: Magnet, placement: Placement, points_mm: Array) -> None:
    hit = np.any(inside(magnet, points_mm), axis=-1)
    if np.any(hit):
        gap = np.broadcast_to(placement.air_gap_mm, hit.shape)[hit]
        raise OutOfRangeError(
            f"air_gap_mm is {gap.ravel()[0]:g} mm, which with these tilts and displacements puts the sensor inside the "
            "magnet; expected a sensing plane clear of the body over the whole turn"
        )


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
