"""The displacements of sensor and magnet that a joint fit of several air gaps finds, with their intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.factors.gap_fit import GapFit
from diagnosis.factors.modulus import modulus_interval


@dataclass(frozen=True)
class Displacement:
    """How far off the axis, with its 95 % interval, and in which direction."""

    mm: float
    low_mm: float
    high_mm: float
    direction_deg: float
    """From the sensor's x axis; of sensor and magnet together this or both opposite ones."""
    direction_half_deg: float
    """Half width of the direction's 95 % interval; 180 where it is open."""


def sensor_displacement(fit: GapFit) -> Displacement | None:
    """The sensor off the shaft's axis; None where the fit holds none."""
    if "sensor" not in fit.causes:
        return None
    squared, error = fit.pair("sensor")
    low, high = modulus_interval(abs(squared), error)
    half = 0.5 * _angle_half(fit, "sensor")
    return Displacement(
        float(np.sqrt(abs(squared))),
        float(np.sqrt(low)),
        float(np.sqrt(high)),
        float(np.degrees(np.angle(squared)) / 2.0),
        half,
    )


def magnet_displacement(fit: GapFit) -> Displacement | None:
    """The magnet off the shaft, from its product with the sensor's displacement; None where the fit holds none."""
    if "magnet" not in fit.causes:
        return None
    product, _ = fit.pair("magnet")
    squared, _ = fit.pair("sensor")
    value = product / np.sqrt(squared)
    # d ln|m| = d ln|P| - d ln|D| / 2, with the errors of both and what they share.
    at = [2 * fit.causes.index(name) for name in ("sensor", "magnet")]
    rows = [at[0], at[0] + 1, at[1], at[1] + 1]
    covariance = fit.covariance[np.ix_(rows, rows)]
    # The product without the sensor: complex, dm = dP / s - m dD / (2 D).
    to_m = np.concatenate([_as_matrix(-value / (2.0 * squared)), _as_matrix(1.0 / np.sqrt(squared))], axis=1)
    own = to_m @ covariance @ to_m.T
    along = np.array([value.real, value.imag]) / max(abs(value), 1e-300)
    low, high = modulus_interval(abs(value), float(np.sqrt(along @ own @ along)))
    across = np.array([-along[1], along[0]])
    half = float(np.degrees(1.96 * np.sqrt(across @ own @ across) / max(abs(value), 1e-300)))
    return Displacement(abs(value), low, high, float(np.degrees(np.angle(value))), min(half, 180.0))


def _as_matrix(factor: complex) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Multiplication by a complex number, on real and imaginary part."""
    return np.array([[factor.real, -factor.imag], [factor.imag, factor.real]])


def _angle_half(fit: GapFit, cause: str) -> float:
    """Half width [deg] of the 95 % interval of a pair's direction; 360 where it is open."""
    value, _ = fit.pair(cause)
    at = 2 * fit.causes.index(cause)
    across = np.array([-value.imag, value.real]) / max(abs(value), 1e-300)
    error = float(np.sqrt(across @ fit.covariance[at : at + 2, at : at + 2] @ across))
    return float(min(np.degrees(1.96 * error / max(abs(value), 1e-300)), 360.0))
