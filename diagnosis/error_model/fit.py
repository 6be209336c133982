"""The fit of the paper's error model: the swarm finds the neighbourhood of the minimum, least squares the minimum.

    from diagnosis.error_model.fit import fit_baseline

    fit = fit_baseline(reference_rad, measured_rad, rng=np.random.default_rng(0))
    fit.chain()                     # twin.Chain with the fitted parameters and senses
    fit.values["offset"]            # {"x_percent": ..., "y_percent": ...}
    fit.low, fit.high               # 95 % intervals (6,), order and units of model.NAMES
    fit.outliers                    # (n,) rows that robust=True left out
    fit.residual_rad                # (n,) measured - predicted, wrapped

Angles (n,) in rad, any range, wrapped or not, in any order; 8 rows to millions. ``senses=(s, h)`` fixes the senses
in which sensor and output count; otherwise both pairs that agree with the slope are tried. ``weights`` (n,) are
inverse variances up to a factor; a row of weight 0 is not used. ``robust=True`` leaves isolated gross errors (jumps of
up to 180 deg in up to a few per cent of the rows) out of the fit; smooth structure, however large, is never left out.
``band_rad`` is Delta E of Eq. 7 (:func:`diagnosis.error_model.error_band.delta_e_rad`) and turns on the discard rule of
Eq. 11.

:func:`fit_equal` does many sweeps of equal length at once, (batch, n) each, :func:`fit_many` a list of any lengths.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import least_squares, model, swarm
from diagnosis.error_model.global_search import Valley, first_look, search
from diagnosis.error_model.model import LOWER_LIMIT, NAMES, UPPER_LIMIT, Readings
from diagnosis.error_model.result import BaselineFit, Contributions, SearchRange, Senses
from twin.angles import Array

QUICK = swarm.SwarmSettings(particles=32, iterations=64, stop_settled=True)
"""Enough to come near the minimum; least squares does the rest. The paper's own setting is ``SwarmSettings()``."""

_CLEAR_SIGMA2 = 100.0
"""Swapped senses whose first fit is worse by this many squared standard errors are not fitted to the readings."""
_BATCH = 128


def fit_baseline(
    reference_rad: Array,
    measured_rad: Array,
    *,
    rng: np.random.Generator,
    weights: Array | None = None,
    senses: tuple[int, int] | None = None,
    robust: bool = False,
    settings: swarm.SwarmSettings = QUICK,
    band_rad: float | None = None,
) -> BaselineFit:
    """Fit one sweep, all arrays (n,); see the module's text."""
    return fit_equal(
        np.asarray(reference_rad)[None],
        np.asarray(measured_rad)[None],
        rng=rng,
        weights=None if weights is None else np.asarray(weights)[None],
        senses=senses,
        robust=robust,
        settings=settings,
        band_rad=band_rad,
    )[0]


def fit_many(
    sweeps: Sequence[tuple[Array, Array]],
    *,
    rng: np.random.Generator,
    senses: tuple[int, int] | None = None,
    robust: bool = False,
    settings: swarm.SwarmSettings = QUICK,
    band_rad: float | None = None,
) -> list[BaselineFit]:
    """Fit sweeps (reference, measured) of any lengths; those of equal length together."""
    by_length: dict[int, list[int]] = {}
    for index, (reference, _) in enumerate(sweeps):
        by_length.setdefault(reference.size, []).append(index)
    found: dict[int, BaselineFit] = {}
    for indices in by_length.values():
        fits = fit_equal(
            np.stack([sweeps[i][0] for i in indices]),
            np.stack([sweeps[i][1] for i in indices]),
            rng=rng,
            senses=senses,
            robust=robust,
            settings=settings,
            band_rad=band_rad,
        )
        found.update(zip(indices, fits, strict=True))
    return [found[i] for i in range(len(sweeps))]


def fit_equal(
    reference_rad: Array,
    measured_rad: Array,
    *,
    rng: np.random.Generator,
    weights: Array | None = None,
    senses: tuple[int, int] | None = None,
    robust: bool = False,
    settings: swarm.SwarmSettings = QUICK,
    band_rad: float | None = None,
) -> list[BaselineFit]:
    """Fit sweeps of equal length, all arrays (batch, n), with one batched swarm; see the module's text."""
    fits: list[BaselineFit] = []
    for start in range(0, reference_rad.shape[0], _BATCH):
        rows = slice(start, start + _BATCH)
        part = None if weights is None else weights[rows]
        fits += _fit_batch(reference_rad[rows], measured_rad[rows], part, senses, robust, settings, band_rad, rng)
    return fits


def _fit_batch(
    reference: Array,
    measured: Array,
    weights: Array | None,
    senses: tuple[int, int] | None,
    robust: bool,
    settings: swarm.SwarmSettings,
    band_rad: float | None,
    rng: np.random.Generator,
) -> list[BaselineFit]:
    n = reference.shape[1]
    sensor, output = _first_senses(reference, measured, weights, senses)
    plain = Readings.of(
        reference, measured, sensor_sense=sensor[:, None], output_sense=output[:, None], weights=weights
    )
    both = senses is None
    used, swap = first_look(plain, reference, both=both, robust=robust)
    used = used.oriented(swap)
    valley = search(used, settings=settings, rng=rng, band_rad=band_rad)

    coarse = least_squares.descend(least_squares.on_gram(valley.gram), valley.best, count=n)
    exact = least_squares.descend(least_squares.on_readings(used), coarse.points, count=n)
    other: tuple[Array, Array] | None = None
    if both:
        swapped = least_squares.descend(
            least_squares.on_gram(model.swapped_gram(valley.gram)), model.mirrored(coarse.points), count=n
        )
        exact, other, turned = _both_senses(used, exact, coarse, swapped)
        swap = swap ^ turned
    sign = np.where(swap, -1.0, 1.0)
    return _results(used, plain.oriented(swap), sensor * sign, output * sign, exact, other, valley)


def _both_senses(
    used: Readings, exact: least_squares.Polished, coarse: least_squares.Polished, swapped: least_squares.Polished
) -> tuple[least_squares.Polished, tuple[Array, Array], NDArray[np.bool_]]:
    """Fit the swapped senses to the readings too, where they are not clearly worse; keep the better pair of each sweep.

    Returns the better one, points (batch, 6) and costs (batch,) of the other, and where the swapped one is the better.
    """
    noise = np.maximum(np.minimum(coarse.cost, swapped.cost) / max(used.count - 6, 1), 1e-300)
    close = (swapped.cost - coarse.cost) / noise < _CLEAR_SIGMA2
    points, cost = swapped.points.copy(), swapped.cost.copy()
    turned = np.zeros(cost.size, dtype=np.bool_)
    if close.any():
        rest = used.sweeps(close).oriented(np.ones(int(close.sum()), dtype=np.bool_))
        second = least_squares.descend(least_squares.on_readings(rest), points[close], count=used.count)
        points[close], cost[close] = second.points, second.cost
        turned = close & (cost < exact.cost * (1.0 - 1e-9))
        if turned.any():
            curvature, settled = exact.curvature.copy(), exact.settled.copy()
            curvature[turned] = second.curvature[turned[close]]
            settled[turned] = second.settled[turned[close]]
            best = np.where(turned[:, None], points, exact.points)
            points, cost, least = (
                np.where(turned[:, None], exact.points, points),
                np.where(turned, exact.cost, cost),
                np.where(turned, cost, exact.cost),
            )
            exact = least_squares.Polished(best, least, curvature, exact.passes, settled)
    return exact, (points, cost), turned


def _first_senses(
    reference: Array, measured: Array, weights: Array | None, senses: tuple[int, int] | None
) -> tuple[Array, Array]:
    """s and h (batch,) of the pair that is tried first: h = +1 where the senses are free."""
    batch = reference.shape[0]
    if senses is not None:
        return np.full(batch, float(senses[0])), np.full(batch, float(senses[1]))
    w = 1.0 if weights is None else weights
    follows = [np.abs(np.sum(w * np.exp(1j * (measured - sense * reference)), axis=-1)) for sense in (1, -1)]
    return np.where(follows[0] >= follows[1], 1.0, -1.0), np.ones(batch)


def _results(
    used: Readings,
    plain: Readings,
    sensor: Array,
    output: Array,
    exact: least_squares.Polished,
    other: tuple[Array, Array] | None,
    valley: Valley,
) -> list[BaselineFit]:
    """One result a sweep; ``plain`` are the readings in the senses that were kept, with the caller's weights."""
    batch, n = exact.points.shape[0], plain.count
    # residual() is h m - atan2(y, x): times h it is measured minus predicted.
    residual = output[:, None] * plain.residual(exact.points)
    weights = used.weights
    counted = np.full((batch, n), True) if weights is None else weights > 0.0
    outliers = (
        np.zeros((batch, n), dtype=bool) if plain.weights is None and weights is None else _left_out(plain, counted)
    )
    fits = []
    for k in range(batch):
        rows = int(np.count_nonzero(counted[k]))
        freedom = max(rows - 6, 1)
        squares = residual[k] ** 2 if weights is None else weights[k] * residual[k] ** 2
        sigma = float(np.sqrt(squares.sum() / freedom))
        rms = float(np.sqrt(np.mean(residual[k][counted[k]] ** 2)))
        covariance = sigma**2 * _inverse(exact.curvature[k])
        half = _student(freedom) * np.sqrt(np.diagonal(covariance))
        point = exact.points[k].copy()
        best, own = valley.histories[k]
        share = float(rows if plain.weights is None else plain.weights[k].sum())
        excess = np.inf if other is None else max(float(other[1][k] - exact.cost[k]), 0.0) / max(sigma**2, 1e-300)
        fits.append(
            BaselineFit(
                point=point,
                covariance=covariance,
                low=point - half,
                high=point + half,
                at_bound=(point <= LOWER_LIMIT) | (point >= UPPER_LIMIT),
                senses=Senses(
                    sensor=int(sensor[k]),
                    output=int(output[k]),
                    sigma=float(np.sqrt(excess)),
                    other=None if other is None else other[0][k].copy(),
                ),
                search=SearchRange(
                    lower=valley.box.lower[k].copy(),
                    upper=valley.box.upper[k].copy(),
                    widened=tuple(name for name, wide in zip(NAMES, valley.box.widened[k], strict=True) if wide),
                    rounds=int(valley.rounds[k]),
                ),
                contributions=Contributions(
                    zero_only_rms_rad=float(np.sqrt(valley.zero_only[k] / share)),
                    swarm_rms_rad=float(np.sqrt(valley.cost[k] / share)),
                    polished_rms_rad=rms,
                    particles_evaluated=int(valley.evaluations[k]),
                    particles_discarded=int(valley.discarded[k]),
                    passes=exact.passes,
                    best_history_rad=np.sqrt(best / share),
                    own_history_rad=np.sqrt(own / share),
                ),
                residual_rad=residual[k],
                outliers=outliers[k],
                sigma_rad=sigma,
                rms_rad=rms,
                degrees_of_freedom=freedom,
                settled=bool(exact.settled[k]),
            )
        )
    return fits


def _left_out(plain: Readings, counted: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Rows that the robust option left out; those to which the caller gave the weight 0 are not among them."""
    return ~counted if plain.weights is None else ~counted & (plain.weights > 0.0)


def _inverse(curvature: Array) -> Array:
    """Inverse of (6, 6); combinations that the readings do not determine get an enormous variance."""
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(curvature), 1e-300))
    values, vectors = np.linalg.eigh(curvature * scale[:, None] * scale)
    return np.asarray((vectors / np.maximum(values, 1e-13)) @ vectors.T * scale[:, None] * scale)


def _student(freedom: int) -> float:
    """Half width of a 95 % interval in standard errors."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))
