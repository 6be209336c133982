"""The error curve from calibration readings: the paper's parameters, and as many smooth orders as the data support.

On top of the fitted error model stand Fourier orders 3 to 32 with a Gaussian prior that falls with the order (flat up
to order 4, where saturation and the magnet's harmonics live, as order^-2p beyond). How large the prior is against the
noise, and how fast it falls, is not chosen but averaged over with the weight of the evidence (restricted likelihood,
the six parameters projected out). So eight readings give hardly more than the paper's model, and sixty-four give
every line that is really there, without a threshold between the two.

All sums are over the readings once; what follows is 60 x 60 algebra.

Readings over temperature are calibrated alike: in the place of the six parameters stand the terms of their laws that
the readings support. The orders hold at every temperature.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model.fit import fit_baseline
from diagnosis.error_model.model import LOWER_LIMIT, UPPER_LIMIT, twin_values
from diagnosis.error_model.result import BaselineFit
from diagnosis.thermal.levels import Span
from diagnosis.thermal.over_temperature import OverTemperature, beside_of, find_laws
from diagnosis.thermal.recording import Recording
from diagnosis.thermal.sums import Beside, Model, sums
from twin.angles import Array
from twin.chain import Chain
from twin.effect import BoolArray
from twin.empirical.orders import UNNAMED_ORDER
from twin.motion import NOMINAL_C

ORDERS = np.arange(3, 33)
_FALLS = (0.5, 1.0, 2.0, 3.0)
_STRENGTHS = np.logspace(-1.0, 6.0, 29)
"""Prior variance of a low order in variances of a reading."""
_FLAT_TO = 4.0
_SMALLEST_DEG = 1e-4
_FEWEST_ROBUST = 24
_FEWEST_ROWS = 8
_NO_NOISE = 1e-14


@dataclass(frozen=True, eq=False)
class Calibration:
    """As many orders as the readings support beside the error model, and the fit of it that they build on.

    ``coefficients`` (6, powers) are those of the error model's point in powers of the temperature, one where there is
    no other. ``orders`` (60,) [rad] are cosines, then sines.
    """

    fit: BaselineFit
    span: Span
    coefficients: Array
    orders: Array
    over: OverTemperature | None = None

    @property
    def gross(self) -> BoolArray:
        """Which readings (n,) were set aside as gross errors."""
        return self.fit.outliers if self.over is None else self.over.gross

    @property
    def sigma_rad(self) -> float:
        """Standard deviation of a reading."""
        return self.fit.sigma_rad if self.over is None else self.over.noise_rad

    @property
    def chain(self) -> Chain:
        """The calibrated twin at 25 C."""
        return self.at(NOMINAL_C)

    def at(self, temperature_c: float) -> Chain:
        """The calibrated twin at a temperature [C], as if it had no other; beyond the span as at its end."""
        powers = self.span.powers(self.span.clipped(temperature_c), self.coefficients.shape[1] - 1)
        senses = self.fit.senses
        point = np.clip(self.coefficients @ powers, LOWER_LIMIT, UPPER_LIMIT)
        chain = Chain(values=twin_values(point), sensor_sense=senses.sensor, output_sense=senses.output)
        cosine, sine = np.split(self.orders, 2)
        for order, c, s in zip(ORDERS, cosine, sine, strict=True):
            amplitude = float(np.degrees(np.hypot(c, s)))
            if amplitude > _SMALLEST_DEG:
                phase = float(np.degrees(np.arctan2(c, s)))
                chain = chain.with_effect(
                    f"{UNNAMED_ORDER.name}#{order}", order=float(order), amplitude_deg=amplitude, phase_deg=phase
                )
        return chain


def calibrate(
    reference_rad: Array, measured_rad: Array, *, rng: np.random.Generator, senses: tuple[int, int] | None = None
) -> Calibration:
    """The twin with the error curve of readings (n,), n >= 8; isolated gross errors are left out where n is large.

    ``senses`` in which sensor and output count; None: both are tried. Where the quadratic term is too small to tell,
    either gives the same curve: order 3, in which the two differ, is fitted beside it.
    """
    n = reference_rad.size
    fit = fit_baseline(reference_rad, measured_rad, rng=rng, senses=senses, robust=n >= _FEWEST_ROBUST)
    span, used = Span(NOMINAL_C, NOMINAL_C), ~fit.outliers
    if used.sum() < _FEWEST_ROWS:
        return Calibration(fit, span, fit.point[:, None], np.zeros(2 * ORDERS.size))
    readings = Recording.at_one_temperature(reference_rad[used], measured_rad[used], NOMINAL_C)
    model = Model(readings, (fit.senses.sensor, fit.senses.output), span, np.ones((6, 1), dtype=bool))
    coefficients, orders = _with_orders(model, fit.point[:, None], Beside(ORDERS))
    return Calibration(fit, span, coefficients, orders)


def calibrate_over_temperature(
    recording: Recording, *, rng: np.random.Generator, senses: tuple[int, int] | None = None
) -> Calibration:
    """The twin with the error curve of readings at several temperatures: factors follow it that are sensitive to it.

    ``senses`` in which sensor and output count; None: both are tried.
    """
    over = find_laws(recording, rng=rng, senses=senses)
    beside = Beside(ORDERS, directed=beside_of(over.model.recording).directed)
    coefficients, orders = _with_orders(over.model, over.coefficients, beside)
    # What a zero that was set anew did on the way is no drift of the sensor's.
    coefficients[~over.followed, 1:] = 0.0
    return Calibration(over.fit, over.model.span, coefficients, orders, over)


def _with_orders(model: Model, coefficients: Array, beside: Beside) -> tuple[Array, Array]:
    """Coefficients (6, powers) of the laws and the orders (60,) beside them, from the laws' fit alone."""
    total = sums(model, coefficients, beside)
    own = model.count + beside.directed_count
    orders = _averaged_orders(total.gram, total.pull, total.squares, total.rows, own)
    step = np.linalg.lstsq(total.gram[:own, :own], total.pull[:own] - total.gram[:own, own:] @ orders, rcond=None)[0]
    return model.moved(coefficients, np.asarray(step[: model.count])), orders


def _averaged_orders(gram: Array, pull: Array, total: float, count: int, own: int) -> Array:
    """Cosines and sines of the orders (60,): the mean over the priors' strengths and falls, weighted by evidence.

    ``own`` columns, which come first, have no prior.
    """
    across = np.linalg.lstsq(gram[:own, :own], np.column_stack([gram[:own, own:], pull[:own]]), rcond=None)[0]
    inner = gram[own:, own:] - gram[own:, :own] @ across[:, :-1]
    push = pull[own:] - gram[own:, :own] @ across[:, -1]
    left = max(total - float(pull[:own] @ across[:, -1]), 0.0)
    freedom = max(count - own, 1)
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
