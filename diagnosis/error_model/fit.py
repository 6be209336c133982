"""The fit of the paper's error model: near the minimum on the quadratic form, to the minimum on the readings.

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
The neighbourhood is found by descents from several starts, and by the paper's modified particle swarm where these do
not agree, or where it is asked for by its ``settings``.
``band_rad`` is Delta E of Eq. 7 (:func:`diagnosis.error_model.error_band.delta_e_rad`) and asks for the
swarm with the discard rule of Eq. 11.

:func:`fit_equal` does many sweeps of equal length at once, (batch, n) each, :func:`fit_many` a list of any lengths.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import least_squares, model, swarm
from diagnosis.error_model.first_look import first_look
from diagnosis.error_model.global_search import search
from diagnosis.error_model.model import Readings
from diagnosis.error_model.outcome import Outcome, results
from diagnosis.error_model.result import BaselineFit
from twin.angles import Array

_CLEAR_SIGMA2 = 100.0
"""Swapped senses whose first fit is worse by this many squared standard errors are not fitted to the readings."""
BATCH = 128
"""Sweeps of equal length that are fitted at once."""


def fit_baseline(
    reference_rad: Array,
    measured_rad: Array,
    *,
    rng: np.random.Generator,
    weights: Array | None = None,
    senses: tuple[int, int] | None = None,
    robust: bool = False,
    settings: swarm.SwarmSettings | None = None,
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
    settings: swarm.SwarmSettings | None = None,
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
    settings: swarm.SwarmSettings | None = None,
    band_rad: float | None = None,
) -> list[BaselineFit]:
    """Fit sweeps of equal length, all arrays (batch, n), together; see the module's text."""
    fits: list[BaselineFit] = []
    for start in range(0, reference_rad.shape[0], BATCH):
        rows = slice(start, start + BATCH)
        fits += _fit_batch(
            reference_rad[rows],
            measured_rad[rows],
            rng=rng,
            weights=None if weights is None else weights[rows],
            senses=senses,
            robust=robust,
            settings=settings,
            band_rad=band_rad,
        )
    return fits


def _fit_batch(
    reference: Array,
    measured: Array,
    *,
    rng: np.random.Generator,
    weights: Array | None,
    senses: tuple[int, int] | None,
    robust: bool,
    settings: swarm.SwarmSettings | None,
    band_rad: float | None,
) -> list[BaselineFit]:
    n = reference.shape[1]
    plain = Readings.of(reference, measured, weights=weights)
    sensor, output = _first_senses(plain, senses)
    plain = plain.in_senses(sensor[:, None], output[:, None])
    both = senses is None
    look = first_look(plain, reference, both=both, robust=robust)
    used, swap = look.readings, look.swap
    found = search(look, settings=settings, rng=rng, band_rad=band_rad)

    coarse, swapped = (found.best, found.cost), look.other
    if found.rounds.any() or found.box.widened.any():
        # The swarm stops near the minimum, and of large errors the form is another one.
        coarse = least_squares.descend_on_gram(found.gram, found.best, count=n)[:2]
        if look.other is not None:
            near = np.where(look.agreed[:, None], look.other[0], model.mirrored(coarse[0]))
            swapped = least_squares.descend_on_gram(model.swapped_gram(found.gram), near, count=n)[:2]
    exact = least_squares.descend(least_squares.on_readings(used), coarse[0], count=n)
    other: tuple[Array, Array] | None = None
    if swapped is not None:
        exact, other, turned = _both_senses(used, exact, coarse[1], swapped)
        swap = swap ^ turned
    sign = np.where(swap, -1.0, 1.0)
    outcome = Outcome(
        used=used,
        plain=plain.oriented(swap),
        sensor=sensor * sign,
        output=output * sign,
        exact=exact,
        other=other,
        search=found,
    )
    return results(outcome)


def _both_senses(
    used: Readings, exact: least_squares.Minimum, coarse_cost: Array, swapped: tuple[Array, Array]
) -> tuple[least_squares.Minimum, tuple[Array, Array], NDArray[np.bool_]]:
    """Fit the swapped senses to the readings too, where they are not clearly worse; keep the better pair of each sweep.

    ``swapped`` are points (batch, 6) and costs (batch,) of the swapped senses on the form, ``coarse_cost`` (batch,) of
    the others. Returns the better one, points (batch, 6) and costs (batch,) of the other, and where the swapped one is
    the better.
    """
    points, cost = (one.copy() for one in swapped)
    noise = np.maximum(np.minimum(coarse_cost, cost) / max(used.count - 6, 1), 1e-300)
    close = (cost - coarse_cost) / noise < _CLEAR_SIGMA2
    turned = np.zeros(cost.size, dtype=np.bool_)
    if close.any():
        rest = used.sweeps(close).oriented(np.ones(int(close.sum()), dtype=np.bool_))
        second = least_squares.descend(least_squares.on_readings(rest), points[close], count=used.count)
        points[close], cost[close] = second.points, second.cost
        turned = close & (cost < exact.cost * (1.0 - 1e-9))
        if turned.any():
            curvature, settled, residual = exact.curvature.copy(), exact.settled.copy(), exact.residual.copy()
            curvature[turned] = second.curvature[turned[close]]
            settled[turned] = second.settled[turned[close]]
            residual[turned] = second.residual[turned[close]]
            best = np.where(turned[:, None], points, exact.points)
            points, cost, least = (
                np.where(turned[:, None], exact.points, points),
                np.where(turned, exact.cost, cost),
                np.where(turned, cost, exact.cost),
            )
            exact = least_squares.Minimum(best, least, curvature, exact.passes, settled, residual)
    return exact, (points, cost), turned


def _first_senses(readings: Readings, senses: tuple[int, int] | None) -> tuple[Array, Array]:
    """s and h (batch,) of the pair that is tried first: h = +1 where the senses are free."""
    batch = readings.cos_shaft.shape[0]
    if senses is not None:
        return np.full(batch, float(senses[0])), np.full(batch, float(senses[1]))
    with_shaft, against = (np.hypot(*readings.resultant(sense)) for sense in (1.0, -1.0))
    return np.where(with_shaft >= against, 1.0, -1.0), np.ones(batch)
