"""What the raw channels add: each amplitude and offset on its own, the output's sense, errors free of the reference.

The points (vx, vy) lie on a curve that no reference encoder enters: x = Vx + Ax F(cos a), y = Vy + Ay F(sin(a + beta))
with a eliminated. What an angle shows beyond that curve sits in the reference or in the coupling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model.model import BETA, GAIN, NOMINAL, QUAD, VX, VY
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors.mechanical import counter_rotating
from twin.angles import Array
from twin.following import slope_of

NAMES = ("Vx", "Vy", "Ax", "Ay", "beta_rad", "quad")
_SURE = 4.0


@dataclass(frozen=True)
class ChannelFit:
    """The curve (vx, vy) of one sweep: values and standard errors (6,) of :data:`NAMES`, in the channels' unit."""

    values: Array
    covariance: Array
    rms_relative: float
    """Distance of the points from the curve, in amplitudes."""

    @property
    def standard_errors(self) -> Array:
        """Standard errors (6,) of the values."""
        return np.sqrt(np.diagonal(self.covariance))

    @property
    def amplitude(self) -> float:
        """Mean of Ax and Ay."""
        return float(0.5 * (self.values[2] + self.values[3]))

    @property
    def amplitude_error(self) -> float:
        """Relative standard error of the amplitude."""
        return float(0.5 * np.sqrt(self.covariance[2:4, 2:4].sum()) / self.amplitude)

    def point(self) -> Array:
        """The visible parameters (6,) that the curve alone gives; its zero is 0, for it has none."""
        vx, vy, ax, ay, beta, quad = self.values
        return np.array([vx / ax, vy / ay, ay / ax, beta, quad, 0.0])


@dataclass(frozen=True)
class Added:
    """What the channels added to the fit of the angle."""

    curve: ChannelFit
    beyond_order_1_deg: float
    """Order 1 in the angle that the curve does not hold."""
    beyond_order_2_deg: float
    sentences: tuple[str, ...]


def output_sense(measured_rad: Array, vx: Array, vy: Array) -> int:
    """h of m = h atan2(vy, vx), from arrays (n,)."""
    return slope_of(np.arctan2(vy - np.median(vy), vx - np.median(vx)), measured_rad)


def fit_curve(vx: Array, vy: Array) -> ChannelFit:
    """Least squares on the relative distance of the points (n,) from the curve."""
    from scipy.optimize import least_squares

    values = np.array([np.mean(vx), np.mean(vy), np.sqrt(2) * np.std(vx), np.sqrt(2) * np.std(vy), 0.0, 0.0])
    scale = np.array([values[2], values[3], values[2], values[3], 1.0, 1.0])
    found = least_squares(
        lambda moved: _distance(values + scale * moved, vx, vy), np.zeros(6), jac="3-point", xtol=1e-12, ftol=None
    )
    variance = 2.0 * float(found.cost) / max(vx.size - 6, 1)
    # Few or wild points may leave some direction open: the pseudo-inverse gives it no weight.
    covariance = variance * np.linalg.pinv(found.jac.T @ found.jac) * scale[:, None] * scale
    return ChannelFit(values + scale * found.x, covariance, float(np.sqrt(np.mean(found.fun**2))))


def _distance(values: Array, vx: Array, vy: Array) -> Array:
    ox, oy, ax, ay, beta, quad = values
    cosine = _undo_quadratic((vx - ox) / ax, quad)
    sine = (_undo_quadratic((vy - oy) / ay, quad) - cosine * np.sin(beta)) / np.cos(beta)
    return np.asarray(np.hypot(cosine, sine) - 1.0)


def _undo_quadratic(value: Array, quad: float) -> Array:
    """The root c of c + q c^2 = value that is near value where q is small."""
    return np.asarray(2.0 * value / (1.0 + np.sqrt(np.maximum(1.0 + 4.0 * quad * value, 0.0))))


def added(fit: BaselineFit, vx: Array, vy: Array) -> Added:
    """Compare the fit of the angle with the curve of the channels (n,): what the curve lacks, the reference adds."""
    used = ~fit.outliers
    curve = fit_curve(vx[used], vy[used])
    own, error = curve.point(), _point_errors(curve)
    error = np.hypot(error, fit.standard_errors)
    gap = fit.point - own
    order_1 = float(np.degrees(np.hypot(gap[VX], gap[VY])))
    order_2 = float(np.degrees(abs(counter_rotating(fit.point) - counter_rotating(own))))
    said = [
        f"vx, vy: the output follows atan2(vy, vx) with h = {fit.senses.output:+d}, which settles the mirror solution",
        f"vx, vy: amplitudes {curve.values[2]:.5g} and {curve.values[3]:.5g}, offsets {curve.values[0]:.4g} and "
        f"{curve.values[1]:.4g} in the unit of the channels",
    ]
    if np.hypot(gap[VX] / error[VX], gap[VY] / error[VY]) > _SURE:
        said.append(
            f"vx, vy: {order_1:.3f} deg of order 1 are not in the channels' own curve: a magnet and a sensor that are "
            "both off the axis, or the reference's eccentricity"
        )
    if np.hypot(gap[GAIN] / error[GAIN], gap[BETA] / error[BETA]) > _SURE:
        said.append(
            f"vx, vy: {order_2:.3f} deg of order 2 are not in the channels' own curve: an angled joint of the "
            "coupling, or a magnet and a sensor far off the axis"
        )
    if len(said) == 2:
        said.append("vx, vy: the channels' own curve holds all that the angle shows; the reference adds nothing")
    return Added(curve, order_1, order_2, tuple(said))


def _point_errors(curve: ChannelFit) -> Array:
    """Standard errors (6,) of :meth:`ChannelFit.point`, each gain's own uncertainty taken as independent."""
    error, values = curve.standard_errors, curve.values
    out = np.zeros_like(NOMINAL)
    out[VX], out[VY] = error[0] / values[2], error[1] / values[3]
    out[GAIN] = values[3] / values[2] * np.hypot(error[2] / values[2], error[3] / values[3])
    out[BETA], out[QUAD] = error[4], error[5]
    return out
