"""Held-out proof: what each step of the extension gains on blocks of readings that its fit has not seen."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from diagnosis.discovery.fitting.joint_fit import BASELINE, Fit, evaluate, solve
from diagnosis.discovery.proof.whole_recordings import are_halves, by_recordings, halves, held_out_rows
from twin.angles import TAU, Array, IntArray, wrap
from twin.effect import BoolArray


def folds(fit: Fit, keys: Sequence[str] = ()) -> IntArray:
    """Fold (n,) of each row: blocks of a part of a turn of travel, dealt out so that every part is held out in
    some turn.

    A block is shorter than a turn, so that each turn's own zero can be fitted from the rest of it. Of several
    recordings each is held out as a whole, see :mod:`~diagnosis.discovery.proof.whole_recordings`.
    """
    motion, count = fit.observations.motion, fit.settings.folds
    block = np.floor(motion.travel_rad / TAU * fit.settings.blocks_a_turn + 1e-9).astype(np.int64)
    if block.max(initial=0) < 2 * count:
        block = np.floor(np.arange(len(motion)) * (3 * count) / max(len(motion), 1)).astype(np.int64)
    if by_recordings(fit, keys):
        return halves(fit, block)
    return np.asarray(block % count, dtype=np.int64)


def scattered(fit: Fit, keys: Sequence[str] = ()) -> IntArray:
    """Fold (n,) of each row where neighbours share none: for what is narrower than a block, in white noise."""
    if by_recordings(fit, keys):
        return halves(fit, np.arange(len(fit.observations), dtype=np.int64))
    return np.arange(len(fit.observations), dtype=np.int64) % fit.settings.folds


def held_out_residuals(fit: Fit, keys: Sequence[str], fold: IntArray) -> list[Array]:
    """Residuals (n,) [rad] on held-out rows: of the baseline, then of the baseline with one cause after the other.

    ``fold`` (n,) is that of each row.
    """
    return [held_out_residual(fit, keys, keys[:count], fold) for count in range(len(keys) + 1)]


def held_out_residual(fit: Fit, keys: Sequence[str], present: Collection[str], fold: IntArray) -> Array:
    """Residual (n,) [rad] on held-out rows of the baseline with those of the causes ``keys`` that are present."""
    use = fit.observations.usable
    base_free = [f for f in fit.free if f.key not in keys] or list(BASELINE)
    free = (*base_free, *(f for f in fit.free if f.key in present))
    chain = fit.chain.without(*(key for key in keys if key not in present))
    if are_halves(fit, fold):
        return held_out_rows(fit, chain, free, fold)
    residual = np.full(len(fit.observations), np.nan)
    for number in range(fit.settings.folds):
        held = fold == number
        # Fewer readings than parameters tell the fit nothing.
        if not np.any(held & use) or np.count_nonzero(use & ~held) <= len(fit.free):
            continue
        trained = solve(evaluate(chain, free, fit.observations.masked(use & ~held), fit.weighting), iterations=6)
        residual[held] = wrap(fit.observations.measured - trained.linear.angle)[held]
    return residual


def rms_deg(residual: Array, use: BoolArray) -> float:
    """RMS [deg] over the rows in use that have been held out."""
    chosen = residual[use & np.isfinite(residual)]
    return float(np.degrees(np.sqrt(np.mean(chosen**2)))) if chosen.size else float("nan")
