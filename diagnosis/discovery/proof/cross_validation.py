"""Held-out proof: what each step of the extension gains on blocks of readings that its fit has not seen."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np

from diagnosis.discovery.fitting.coefficients import without_motion
from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.initial_fit import baseline_of
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.proof.whole_recordings import Split, are_halves, by_recordings, halves, of_recordings
from twin.angles import TAU, Array, IntArray, wrap
from twin.effect import BoolArray

_ITERATIONS = 6
"""Steps of a held-out fit: it sets out from the fit of all rows, which is near."""


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


def held_out_residuals(fit: Fit, keys: Sequence[str], fold: IntArray, *, at_once: bool = False) -> list[Array]:
    """Residuals (n,) [rad] on held-out rows: of the baseline, then of the baseline with one cause after the other.

    ``fold`` (n,) is that of each row; ``at_once`` as in :func:`held_out_residual`.
    """
    return [held_out_residual(fit, keys, keys[:count], fold, at_once=at_once) for count in range(len(keys) + 1)]


def held_out_residual(
    fit: Fit, keys: Sequence[str], present: Collection[str], fold: IntArray, *, at_once: bool = False
) -> Array:
    """Residual (n,) [rad] on held-out rows of the baseline with those of the causes ``keys`` that are present.

    ``at_once``: each fit goes from that of all rows by one step, which is all of it where the chain is linear.
    """
    base_free = [f for f in fit.free if f.key not in keys] or list(baseline_of(fit.chain))
    free = (*base_free, *(f for f in fit.free if f.key in present))
    chain = fit.chain.without(*(key for key in keys if key not in present))
    splits = of_recordings(fit, free, fold) if are_halves(fit, fold) else _of_blocks(fit, free, fold)
    residual = np.full(len(fit.observations), np.nan)
    iterations = 1 if at_once else _ITERATIONS
    for split in splits:
        # Fewer readings than parameters tell a fit nothing.
        if np.count_nonzero(split.seen) <= split.fewest:
            continue
        observations = fit.observations.masked(split.seen)
        told = solve(evaluate(chain, split.free, observations, fit.weighting), iterations=iterations)
        for seen, own, held in split.parts:
            if np.count_nonzero(seen) <= len(own):
                continue
            settled = told
            if own:
                settled = solve(evaluate(told.chain, own, fit.observations.masked(seen), fit.weighting))
            residual[held] = wrap(fit.observations.measured - settled.linear.angle)[held]
    return without_motion(fit.observations, residual)


def _of_blocks(fit: Fit, free: tuple[Free, ...], fold: IntArray) -> Iterator[Split]:
    """Each fold (n,) told by the others."""
    use = fit.observations.usable
    for number in range(fit.settings.folds):
        held = fold == number
        if np.any(held & use):
            yield Split(use & ~held, free, len(fit.free), ((use & ~held, (), held),))


def rms_deg(residual: Array, use: BoolArray) -> float:
    """RMS [deg] over the rows in use that have been held out."""
    chosen = residual[use & np.isfinite(residual)]
    return float(np.degrees(np.sqrt(np.mean(chosen**2)))) if chosen.size else float("nan")
