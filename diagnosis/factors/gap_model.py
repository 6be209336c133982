"""What offset, gain ratio and phase of sweeps at several air gaps should be, by the magnet's field and a few causes.

The field at the sensor is that of the magnet itself, misplaced or not (:mod:`twin.magnet.field`). Each cause has a law
over the gap of its own:

- ``voltage``: a constant voltage, or a stray field, weighs less the stronger the field is: an offset in mT;
- ``reference``: an eccentric reference makes the same order 1 at every gap;
- ``electronics``: gain mismatch and phase keep their share, as a tilt of the sensor does;
- ``sensor``: the sensor off the shaft's axis. With p the point from the magnet's axis, u its squared length and S the
  series of the potential, the field is exp(i a) (S + u S' + p^2 S') (:mod:`twin.magnet.axis_series`): its
  counter-rotating share, order 2 in the angle, is s^2 S'/S to leading order for a displacement s = x + iy;
- ``magnet``: the magnet off the shaft's axis too, by m at a = 0, makes an order 1 of -2 s m S'/S. Alone it makes no
  error of the angle at any gap: the field turns as a whole.

- ``tilt``: a sensor off the axis and tilted by t senses a share of the upright field too, which makes an order 2 of
  s t a'/(2 a), with a the field on the axis over the height; and t^2/4 at every gap, which a tilt alone makes.
- ``magnet_tilt``: the magnet leaning by w at a = 0 is off the shaft by w z at the height z of the sensor over its
  centre, and its upright field leans too: beside a sensor off the axis an order 1 of -2 s w z S'/S and of
  s Im(w) a'/a. Alone it makes no error of the angle, as the magnet's displacement does not.
- ``tilt_and_magnet``, ``both_tilts``: the upright field of a magnet off the shaft is -m_x a' on the axis, that of a
  leaning one -w_x (a + z a'), the same over the turn: a tilted sensor has offsets of t m_x a'/a and t w_x (1 + z a'/a)
  by them, with m_x and w_x along the magnetisation. With a sensor off the axis they are part of the field.

So s^2, s m, s t and s w are the coordinates of displacements and tilts: of s, m, t and w all signs, or none, are known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model.model import BETA, GAIN, QUAD, VX, VY, Readings
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.mounting import coefficients
from twin.angles import Array
from twin.magnet.field import basis
from twin.magnet.magnet import Magnet
from twin.magnet.placement import LARGEST_GAP_MM, SMALLEST_GAP_MM

ROWS = (VX, VY, GAIN, BETA)
"""The factors that are held against the field; zero and quadratic term are left free at each gap."""
CAUSES = (
    "voltage",
    "reference",
    "electronics",
    "sensor",
    "magnet",
    "tilt",
    "magnet_tilt",
    "tilt_and_magnet",
    "both_tilts",
)
"""Two numbers each: mT; rad; share and rad; mm^2; mm^2; mm rad; mm rad; mm rad; rad^2."""
_MOST_ANGLES = 240
_LARGEST_TILT_RAD = 0.175
"""Ten degrees: nothing is mounted more askew, and a larger tilt would make up for a magnet that is another one."""
_SLOPE_STEP_MM = 1e-3
"""Over which the slope of the field on the axis is taken: its relative error is of the square, some 1e-6."""
_ROUNDING = 1e-8
"""Standard error that a factor has at least: a simulated sweep without noise leaves none."""
_LARGEST_ERROR = 0.3
"""Of a factor that a sweep does not determine."""


@dataclass(frozen=True, eq=False)
class GapSweep:
    """One sweep as the joint fit takes it: its fitted factors, and what a change of its angles does to them."""

    point: Array
    covariance: Array
    """Of the factors ROWS (4, 4)."""
    angle_rad: Array
    """Field angles a (n,), at which expected angles are held against the fitted curve."""
    shaft_rad: Array
    """The same readings of the reference (n,)."""
    curve_rad: Array
    """atan2(y, x) of the fitted factors there (n,)."""
    to_factors: Array
    """Least squares from a change of the angles to one of the factors ROWS (4, n)."""
    to_quad: Array
    """The same to the quadratic term (n,)."""
    quad_error: float
    """Standard error of the quadratic term."""
    log_amplitude: float | None = None
    """Of the raw channels; None without."""
    log_amplitude_error: float = 0.0

    @property
    def usable(self) -> bool:
        """Whether these readings determine all four factors."""
        return bool(np.all(np.diagonal(self.covariance) < _LARGEST_ERROR**2) and np.isfinite(self.log_amplitude or 0.0))

    @classmethod
    def of(cls, fit: BaselineFit, reference_rad: Array, amplitude: tuple[float, float] | None = None) -> GapSweep:
        """From a sweep's fit; ``amplitude``: that of the raw channels and its relative error."""
        used = np.flatnonzero(~fit.outliers)
        shaft = reference_rad[used[np.unique(np.linspace(0, used.size - 1, _MOST_ANGLES).astype(int))]]
        readings = Readings.of(shaft, np.zeros_like(shaft), sensor_sense=float(fit.senses.sensor))
        residual, slopes = readings.linearised(fit.point)
        back = np.linalg.pinv(slopes @ slopes.T) @ slopes
        return cls(
            point=fit.point,
            covariance=fit.covariance[np.ix_(ROWS, ROWS)] + _ROUNDING**2 * np.eye(len(ROWS)),
            angle_rad=fit.senses.sensor * shaft + fit.point[-1],
            shaft_rad=shaft,
            curve_rad=-residual,
            to_factors=back[list(ROWS)],
            to_quad=back[QUAD],
            quad_error=float(fit.standard_errors[QUAD]),
            log_amplitude=None if amplitude is None else float(np.log(max(amplitude[0], 0.0) or np.nan)),
            log_amplitude_error=0.0 if amplitude is None else amplitude[1],
        )


def imagined(sweep: GapSweep, told: Expected) -> GapSweep:
    """A sweep like this one as the first of these expected ones would be, with the same errors."""
    point = sweep.point.copy()
    point[list(ROWS)] = told.factors[0, 0]
    turned = np.sin(sweep.angle_rad + point[BETA])
    x, y = (part + point[QUAD] * part**2 for part in (np.cos(sweep.angle_rad), turned))
    curve = np.arctan2(point[GAIN] * (y + point[VY]), x + point[VX])
    amplitude = None if sweep.log_amplitude is None else float(told.log_amplitude[0, 0])
    return replace(sweep, point=point, curve_rad=curve, log_amplitude=amplitude)


@dataclass(frozen=True, eq=False)
class Causes:
    """Values of the causes for a batch: each (batch, 2), zero where a cause is absent."""

    voltage: Array
    reference: Array
    electronics: Array
    sensor: Array
    magnet: Array
    tilt: Array
    magnet_tilt: Array
    tilt_and_magnet: Array
    both_tilts: Array


def causes_of(names: Sequence[str], numbers: Array) -> Causes:
    """The causes of a batch of numbers (batch, ...), two for each name in order; those without a name at zero."""
    none = np.zeros((len(numbers), 2))
    given = {name: numbers[:, 2 * k : 2 * k + 2] for k, name in enumerate(names)}
    return Causes(**{name: given.get(name, none) for name in CAUSES})


class Expected(NamedTuple):
    """What causes make of sweeps: the factors ROWS (batch, sweeps, 4) and two numbers (batch, sweeps)."""

    factors: Array
    log_amplitude: Array
    """Of the channels, up to a scale."""
    quad: Array
    """What the field's own order 3 adds to a fitted quadratic term."""


def expected(sweeps: Sequence[GapSweep], magnet: Magnet, causes: Causes, gap_mm: Array) -> Expected:
    """What these causes make of the sweeps.

    ``gap_mm`` (batch, sweeps) are the air gaps. One pass of the field's series over all gaps and the whole batch.
    """
    batch, count = gap_mm.shape
    gap_mm = np.clip(gap_mm, SMALLEST_GAP_MM, LARGEST_GAP_MM)
    sensor = np.sqrt(causes.sensor[:, 0] + 1j * causes.sensor[:, 1])
    # A trial step of the fit may ask for a magnet far off the shaft; none is off by more than its radius.
    centre = _beside(causes.magnet, sensor, most=float(magnet.reach_mm))
    tilt = _beside(causes.tilt, sensor, most=_LARGEST_TILT_RAD) * np.degrees(1.0)
    lean = _beside(causes.magnet_tilt, sensor, most=_LARGEST_TILT_RAD) * np.degrees(1.0)
    placed = {
        "sensor_x_mm": sensor.real,
        "sensor_y_mm": sensor.imag,
        "magnet_x_mm": centre.real,
        "magnet_y_mm": centre.imag,
        # Leaning towards x is a turn about y, leaning towards y one backwards about x.
        "sensor_tilt_x_deg": -tilt.imag,
        "sensor_tilt_y_deg": tilt.real,
        "magnet_tilt_x_deg": -lean.imag,
        "magnet_tilt_y_deg": lean.real,
    }
    flat = {name: np.repeat(value, count) for name, value in placed.items()}
    field = coefficients(magnet, gap_mm.ravel(), **flat).reshape(batch, count, 3, -1)
    nominal = coefficients(magnet, gap_mm.ravel()).reshape(batch, count, 3, -1)[:, :, 0, 1]
    upright = _upright(magnet, causes, gap_mm)
    factors, quad = (np.empty((batch, count, size)) for size in (len(ROWS), 1))
    for k, sweep in enumerate(sweeps):
        change = _change(sweep, field[:, k], causes, nominal_mT=nominal[:, k], upright=upright[:, k])
        factors[:, k] = sweep.point[list(ROWS)] + change @ sweep.to_factors.T
        quad[:, k, 0] = change @ sweep.to_quad
    forwards = 0.5 * np.hypot(field[:, :, 0, 1] + field[:, :, 1, 2], field[:, :, 1, 1] - field[:, :, 0, 2])
    return Expected(factors, np.log(forwards), quad[..., 0])


def _beside(pair: Array, sensor: NDArray[np.complex128], *, most: float) -> NDArray[np.complex128]:
    """What stands in a product (batch, 2) beside the sensor's displacement (batch,), no longer than ``most``."""
    product = pair[:, 0] + 1j * pair[:, 1]
    found = np.divide(product, sensor, out=np.zeros_like(product), where=(sensor != 0.0) & (product != 0.0))
    return np.asarray(found * np.minimum(1.0, most / np.maximum(np.abs(found), 1e-300)))


def _upright(magnet: Magnet, causes: Causes, gap_mm: Array) -> Array:
    """Offsets (batch, sweeps, 2) that a tilted sensor on the axis has by the upright field, in nominal amplitudes."""
    out = np.zeros((*gap_mm.shape, 2))
    if not (np.any(causes.tilt_and_magnet) or np.any(causes.both_tilts)):
        return out
    by_displacement, by_tilt = (per_product(cause, magnet, gap_mm) for cause in ("tilt_and_magnet", "both_tilts"))
    return np.asarray(
        causes.tilt_and_magnet[:, None] * by_displacement[..., None] + causes.both_tilts[:, None] * by_tilt[..., None]
    )


def per_product(cause: str, magnet: Magnet, gap_mm: Array) -> Array:
    """Offset in nominal amplitudes, of the shape of ``gap_mm``, for one of ``tilt_and_magnet`` or ``both_tilts``."""
    near, far = np.maximum(gap_mm - _SLOPE_STEP_MM, SMALLEST_GAP_MM), gap_mm + _SLOPE_STEP_MM
    before, here, behind = (
        coefficients(magnet, gap.ravel())[:, 0, 1].reshape(gap.shape) for gap in (near, gap_mm, far)
    )
    slope = (behind - before) / ((far - near) * here)
    return np.asarray(slope if cause == "tilt_and_magnet" else 1.0 + (gap_mm + 0.5 * float(magnet.height_mm)) * slope)


def _change(sweep: GapSweep, field_mT: Array, causes: Causes, *, nominal_mT: Array, upright: Array) -> Array:
    """What one sweep's angles (batch, n) are beyond its fitted curve in a field (batch, 3, terms).

    ``upright`` (batch, 2) are the offsets by the upright field.
    """
    orders = (field_mT.shape[-1] - 1) // 2
    table = basis(sweep.angle_rad, orders)
    scale = nominal_mT[:, None]
    along, across = field_mT[:, 0] @ table / scale, field_mT[:, 1] @ table / scale
    gain, phase = 1.0 + causes.electronics[:, :1], causes.electronics[:, 1:]
    turned = across * np.cos(phase) + along * np.sin(phase)
    quad = sweep.point[QUAD]
    offset = causes.voltage / scale + upright
    x = along + quad * along**2 + offset[:, :1]
    y = gain * (turned + quad * turned**2 + offset[:, 1:])
    angle = np.arctan2(y, x)
    angle += causes.reference[:, :1] * np.cos(sweep.shaft_rad) + causes.reference[:, 1:] * np.sin(sweep.shaft_rad)
    return np.asarray(np.angle(np.exp(1j * (angle - sweep.curve_rad))))
