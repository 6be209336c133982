"""The error curve from calibration readings: the paper's parameters, and as many smooth orders as the data support.

On top of the fitted error model stand Fourier orders 3 to 32 with a Gaussian prior that falls with the order (flat up
to order 4, where saturation and the magnet's harmonics live, as order^-2p beyond). How large the prior is against the
noise, and how fast it falls, is not chosen but averaged over with the weight of the evidence (restricted likelihood,
the six parameters projected out). So eight readings give hardly more than the paper's model, and sixty-four give
every line that is really there, without a threshold between the two.

All sums are over the readings once; what follows is 60 x 60 algebra.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model.fit import fit_baseline
from diagnosis.error_model.model import Readings, twin_values
from diagnosis.error_model.result import BaselineFit
from twin.angles import Array
from twin.chain import Chain
from twin.empirical.orders import UNNAMED_ORDER

ORDERS = np.arange(3, 33)
_FALLS = (0.5, 1.0, 2.0, 3.0)
_STRENGTHS = np.logspace(-1.0, 6.0, 29)
"""Prior variance of a low order in variances of a reading."""
_FLAT_TO = 4.0
_SMALLEST_DEG = 1e-4
_FEWEST_ROBUST = 24
_FEWEST_ROWS = 8
_CHUNK = 16384
_NO_NOISE = 1e-14


@dataclass(frozen=True, eq=False)
class Calibration:
    """The twin with as many orders as the readings support, and the fit of the paper's model that it builds on."""

    chain: Chain
    fit: BaselineFit


def calibrate(reference_rad: Array, measured_rad: Array, *, rng: np.random.Generator) -> Calibration:
    """The twin with the error curve of readings (n,), n >= 8; isolated gross errors are left out where n is large."""
    n = reference_rad.size
    fit = fit_baseline(reference_rad, measured_rad, rng=rng, robust=n >= _FEWEST_ROBUST)
    used = ~fit.outliers
    if used.sum() < _FEWEST_ROWS:
        return Calibration(fit.chain(), fit)
    readings = Readings.of(
        reference_rad[used],
        measured_rad[used],
        sensor_sense=float(fit.senses.sensor),
        output_sense=float(fit.senses.output),
    )
    gram, pull, total = _sums(readings, reference_rad[used], fit.point)
    orders = _averaged_orders(gram, pull, total, int(used.sum()))
    own = np.linalg.lstsq(gram[:6, :6], pull[:6] - gram[:6, 6:] @ orders, rcond=None)[0]
    chain = Chain(values=twin_values(fit.point + own), sensor_sense=fit.senses.sensor, output_sense=fit.senses.output)
    cosine, sine = np.split(orders, 2)
    for order, c, s in zip(ORDERS, cosine, sine, strict=True):
        amplitude = float(np.degrees(np.hypot(c, s)))
        if amplitude > _SMALLEST_DEG:
            phase = float(np.degrees(np.arctan2(c, s)))
            chain = chain.with_effect(
                f"{UNNAMED_ORDER.name}#{order}", order=float(order), amplitude_deg=amplitude, phase_deg=phase
            )
    return Calibration(chain, fit)


def _sums(readings: Readings, reference: Array, point: Array) -> tuple[Array, Array, float]:
    """The normal equations of the six slopes and the orders' cosines and sines: matrix (66, 66), right side (66,).

    And the sum of squares of the residual.
    """
    size = 6 + 2 * ORDERS.size
    gram, pull, total = np.zeros((size, size)), np.zeros(size), 0.0
    for start in range(0, reference.size, _CHUNK):
        rows = slice(start, start + _CHUNK)
        residual, slopes = readings.sweeps((rows,)).linearised(point)
        waves = ORDERS[:, None] * reference[rows]
        columns = np.concatenate([slopes, np.cos(waves), np.sin(waves)])
        gram += columns @ columns.T
        pull += columns @ residual
        total += float(residual @ residual)
    return gram, pull, total


def _averaged_orders(gram: Array, pull: Array, total: float, count: int) -> Array:
    """Cosines and sines of the orders (60,): the mean over the priors' strengths and falls, weighted by evidence."""
    across = np.linalg.lstsq(gram[:6, :6], np.column_stack([gram[:6, 6:], pull[:6]]), rcond=None)[0]
    inner = gram[6:, 6:] - gram[6:, :6] @ across[:, :-1]
    push = pull[6:] - gram[6:, :6] @ across[:, -1]
    left = max(total - float(pull[:6] @ across[:, -1]), 0.0)
    freedom = max(count - 6, 1)
    observations, means = [], []
    for fall in _FALLS:
        prior = np.tile(np.minimum((ORDERS / _FLAT_TO) ** (-2.0 * fall), 1.0), 2)
        root = np.sqrt(prior)
        values, vectors = np.linalg.eigh(inner * root[:, None] * root)
        seen = values > 1e-12 * values[-1]
        values, vectors = values[seen], vectors[:, seen]
        along = vectors.T @ (root * push)
        for strength in _STRENGTHS:
            shrink = 1.0 + strength * values
            square = left - float(np.sum(strength * along**2 / shrink))
            variance = max(square / freedom, _NO_NOISE)
            observations.append(-0.5 * (freedom * np.log(variance) + np.sum(np.log(shrink))))
            means.append(root * (vectors @ (strength * along / shrink)))
    weight = np.exp(np.array(observations) - max(observations))
    return np.asarray(weight @ np.array(means) / weight.sum())
