"""Displacements of sensor and magnet and the sensor's tilt, as a joint fit of several air gaps finds them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.factors.gap_fit import GapFit
from diagnosis.factors.modulus import modulus_interval
from twin.angles import Array, wrap_deg

_NORMAL_95 = 1.96


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


def hull(found: Sequence[Displacement]) -> Displacement:
    """The first of several with the interval that holds all of theirs: one of them is true, and it is open which."""
    first = found[0]
    turned = [abs(float(wrap_deg(one.direction_deg - first.direction_deg))) for one in found]
    return replace(
        first,
        low=min(one.low for one in found),
        high=max(one.high for one in found),
        direction_half_deg=max(one.direction_half_deg + off for one, off in zip(found, turned, strict=True)),
    )


def sensor_displacement(fit: GapFit) -> Displacement | None:
    """The sensor off the shaft's axis [mm]; None where the fit holds none."""
    if "sensor" not in fit.causes:
        return None
    squared, error = fit.pair("sensor")
    low, high = modulus_interval(abs(squared), error)
    direction = float(np.degrees(np.angle(squared)))
    half = _half_angle(squared, _covariance(fit, "sensor"))
    # The square turns twice as far.
    value, low, high = (float(np.sqrt(one)) for one in (abs(squared), low, high))
    return Displacement(value, low, high, 0.5 * direction, 0.5 * half)


def magnet_displacement(fit: GapFit) -> Displacement | None:
    """The magnet off the shaft [mm]; None where the fit holds none."""
    return _beside_sensor(fit, "magnet", 1.0) if "magnet" in fit.causes else None


def sensor_tilt(fit: GapFit) -> Displacement | None:
    """The sensor's tilt [deg], towards where its normal leans; None where the fit holds none."""
    return _beside_sensor(fit, "tilt", float(np.degrees(1.0))) if "tilt" in fit.causes else None


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
    return Displacement(abs(value), low, high, float(np.degrees(np.angle(value))), half)


def _covariance(fit: GapFit, *causes: str) -> Array:
    at = [2 * fit.causes.index(cause) for cause in causes]
    rows = [place for first in at for place in (first, first + 1)]
    return np.asarray(fit.covariance[np.ix_(rows, rows)])


def _half_angle(value: complex, covariance: Array) -> float:
    """Half width [deg] of the 95 % interval of a direction, 360 where it is open."""
    across = np.array([-value.imag, value.real]) / max(abs(value), 1e-300)
    error = float(np.sqrt(across @ covariance @ across))
    return float(min(np.degrees(_NORMAL_95 * error / max(abs(value), 1e-300)), 360.0))


def _as_matrix(factor: complex) -> Array:
    """Multiplication by a complex number, on real and imaginary part."""
    return np.array([[factor.real, -factor.imag], [factor.imag, factor.real]])


MEASURED: Mapping[str, Callable[[GapFit], Displacement | None]] = {
    "sensor": sensor_displacement,
    "magnet": magnet_displacement,
    "tilt": sensor_tilt,
}
"""By the cause."""
