"""Displacements and tilts of sensor and magnet, as a joint fit of several air gaps finds them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.factors.gap_fit import GapFit
from diagnosis.factors.gap_model import per_product
from diagnosis.factors.modulus import modulus_interval
from diagnosis.factors.mounting import coefficients
from twin.angles import Array, wrap_deg
from twin.confidence import Z95
from twin.magnet.magnet import Magnet


@dataclass(frozen=True)
class Displacement:
    """How far off [mm], or how tilted [deg], with the 95 % interval, and in which direction."""

    value: float
    low: float
    high: float
    direction_deg: float
    """From the sensor's x axis; of what is displaced or tilted together this or all opposite ones."""
    direction_half_deg: float
    """Half width of the direction's 95 % interval; 180 where it is open."""
    period_deg: float = 360.0
    """180 where the opposite direction is the same: that of a square."""


def hull(found: Sequence[Displacement]) -> Displacement:
    """The first of several with the interval that holds all of theirs: one of them is true, and it is open which."""
    first = found[0]
    turns = 360.0 / first.period_deg
    turned = [abs(float(wrap_deg(turns * (one.direction_deg - first.direction_deg)))) / turns for one in found]
    half = max(one.direction_half_deg + off for one, off in zip(found, turned, strict=True))
    return replace(
        first,
        low=min(one.low for one in found),
        high=max(one.high for one in found),
        direction_half_deg=half if half < 0.5 * first.period_deg else 180.0,
    )


def sensor_displacement(fit: GapFit) -> Displacement | None:
    """The sensor off the shaft's axis [mm]; None where the fit holds none."""
    if "sensor" not in fit.causes:
        return None
    squared, error = fit.pair("sensor")
    low, high = modulus_interval(abs(squared), error)
    half = _half_angle(squared, _covariance(fit, "sensor"))
    # The square turns twice as far.
    value, low, high = (float(np.sqrt(one)) for one in (abs(squared), low, high))
    return Displacement(value, low, high, 0.5 * _towards(squared), 0.5 * half, period_deg=180.0)


def magnet_displacement(fit: GapFit) -> Displacement | None:
    """The magnet off the shaft [mm]; None where the fit holds none."""
    return _beside_sensor(fit, "magnet", 1.0) if "magnet" in fit.causes else None


def sensor_tilt(fit: GapFit) -> Displacement | None:
    """The sensor's tilt [deg], towards where its normal leans; None where the fit holds none."""
    return _beside_sensor(fit, "tilt", float(np.degrees(1.0))) if "tilt" in fit.causes else None


def magnet_tilt(fit: GapFit) -> Displacement | None:
    """The magnet's tilt [deg], towards where its axis leans at a = 0; None where the fit holds none."""
    return _beside_sensor(fit, "magnet_tilt", float(np.degrees(1.0))) if "magnet_tilt" in fit.causes else None


def tilt_on_axis(fit: GapFit) -> Displacement | None:
    """The tilt [deg] of a sensor on the axis with the share of order 2 of the electronics; None where there is none.

    The field lies in the plane there. A tilt by t shortens it by cos t along the direction in which the normal leans,
    which is a share of tan(t/2)^2 against that direction, at every gap and before every magnet.
    """
    if "electronics" not in fit.causes:
        return None
    pair, _ = fit.pair("electronics")
    # To first order 1 - g and beta make the share ((1 - g) + i beta) / 2.
    share = complex(-0.5 * pair.real, 0.5 * pair.imag)
    slopes = np.diag([-0.5, 0.5])
    covariance = slopes @ _covariance(fit, "electronics") @ slopes.T
    error = float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))
    value, low, high = (
        float(np.degrees(2.0 * np.arctan(np.sqrt(size)))) for size in (abs(share), *modulus_interval(abs(share), error))
    )
    half = 0.5 * _half_angle(share, covariance)
    return Displacement(value, low, high, 0.5 * _towards(-share), half, period_deg=180.0)


@dataclass(frozen=True)
class Product:
    """The sensor's tilt times the magnet's displacement or tilt along its magnetisation, with the 95 % interval.

    The interval holds what the product's law, of the first order in each, neglects: see :func:`neglected`.
    """

    value: float
    low: float
    high: float
    unit: str


def upright_product(fit: GapFit, cause: str, *, magnet: Magnet) -> Product | None:
    """The product that ``tilt_and_magnet`` or ``both_tilts`` stands for; None where the fit holds none."""
    if cause not in fit.causes:
        return None
    value, error = fit.pair(cause)
    scale, unit = {
        "tilt_and_magnet": (float(np.degrees(1.0)), "mm deg"),
        "both_tilts": (float(np.degrees(1.0)) ** 2, "deg^2"),
    }[cause]
    low, high = modulus_interval(abs(value), error)
    least, most = neglected(fit, cause, magnet)
    return Product(scale * abs(value), scale * low / most, scale * high / least, unit)


def neglected(fit: GapFit, cause: str, magnet: Magnet) -> tuple[float, float]:
    """The offsets in the field itself, over those of first order: from the least to the most, 1 between them.

    The product alone does not say how large each of the two is. They are taken as where the share of order 2 is the
    sensor's tilt, and the magnet's direction as up to 45 degrees off its magnetisation.
    """
    tilt = tilt_on_axis(fit)
    if tilt is None or tilt.value == 0.0:
        return 1.0, 1.0
    product, _ = fit.pair(cause)
    along = abs(product) / np.radians(tilt.value)
    gaps = np.tile(fit.gap_mm, 3)
    across = np.repeat([-along, 0.0, along], fit.gap_mm.size)
    if cause == "tilt_and_magnet":
        wrong = {"magnet_x_mm": np.full(gaps.size, along), "magnet_y_mm": across}
    else:
        # Leaning towards x is a turn about y, leaning towards y one backwards about x.
        wrong = {"magnet_tilt_y_deg": np.full(gaps.size, np.degrees(along)), "magnet_tilt_x_deg": -np.degrees(across)}
    field = coefficients(magnet, gaps, sensor_tilt_y_deg=np.full(gaps.size, tilt.value), **wrong)
    offset = field[:, 0, 0] / np.hypot(field[:, 0, 1], field[:, 0, 2])
    first = abs(product) * per_product(cause, magnet, gaps)
    ratio = offset / first
    return min(float(ratio.min()), 1.0), max(float(ratio.max()), 1.0)


def _towards(value: complex) -> float:
    return float(np.degrees(np.angle(value)))


def _beside_sensor(fit: GapFit, cause: str, scale: float) -> Displacement:
    """What stands in a product beside the sensor's displacement, with the errors of both and what they share."""
    product, _ = fit.pair(cause)
    squared, _ = fit.pair("sensor")
    root = np.sqrt(squared)
    value = product / root
    # v = P / sqrt(D), so dv = dP / sqrt(D) - v dD / (2 D).
    slopes = np.concatenate([_as_matrix(-value / (2.0 * squared)), _as_matrix(1.0 / root)], axis=1)
    covariance = scale**2 * slopes @ _covariance(fit, "sensor", cause) @ slopes.T
    value = complex(scale * value)
    along = np.array([value.real, value.imag]) / max(abs(value), 1e-300)
    low, high = modulus_interval(abs(value), float(np.sqrt(along @ covariance @ along)))
    half = min(_half_angle(value, covariance), 180.0)
    return Displacement(abs(value), low, high, _towards(value), half)


def _covariance(fit: GapFit, *causes: str) -> Array:
    at = [2 * fit.causes.index(cause) for cause in causes]
    rows = [place for first in at for place in (first, first + 1)]
    return np.asarray(fit.covariance[np.ix_(rows, rows)])


def _half_angle(value: complex, covariance: Array) -> float:
    """Half width [deg] of the 95 % interval of a direction, 360 where it is open."""
    across = np.array([-value.imag, value.real]) / max(abs(value), 1e-300)
    error = float(np.sqrt(across @ covariance @ across))
    return float(min(np.degrees(Z95 * error / max(abs(value), 1e-300)), 360.0))


def _as_matrix(factor: complex) -> Array:
    """Multiplication by a complex number, on real and imaginary part."""
    return np.array([[factor.real, -factor.imag], [factor.imag, factor.real]])


MEASURED: Mapping[str, Callable[[GapFit], Displacement | None]] = {
    "sensor": sensor_displacement,
    "magnet": magnet_displacement,
    "tilt": sensor_tilt,
    "magnet_tilt": magnet_tilt,
}
"""By the cause."""
