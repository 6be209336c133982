"""Held-out proof over several recordings: what the others tell of the device, on a recording that they have not seen.

A recording is held out as a whole. What belongs to it alone, its zero and what happened in it, is fitted to one half of
it and judged on the other, in blocks; everything else comes from the other recordings.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, Free, evaluate, solve
from diagnosis.discovery.fitting.own_zeros import owner
from twin.angles import Array, IntArray, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.each_recording import acts_in

HALVES = 2


def by_recordings(fit: Fit, keys: Sequence[str]) -> bool:
    """Whether every recording can be held out as a whole: the others alone must be able to show each of the causes.

    Two recordings that part two causes together, by the sensor's turn or by the air gap, part nothing one by one.
    """
    motion = fit.observations.motion
    if motion.recordings is None:
        return False
    effects = [find(key, fit.chain.effects) for key in keys if acts_in(key) is None]
    for number in range(len(motion.recordings)):
        rest = motion.part(np.flatnonzero(motion.recordings.number != number))
        if not all(effect.visible_in(rest.provides) for effect in effects):
            return False
    return True


def are_halves(fit: Fit, fold: IntArray) -> bool:
    """Whether folds (n,) are those of :func:`halves`."""
    recordings = fit.observations.motion.recordings
    return recordings is not None and np.array_equal(fold // HALVES, recordings.number)


def halves(fit: Fit, block: IntArray) -> IntArray:
    """Fold (n,) of each row: two of each recording, dealt out by the blocks (n,) of it."""
    recordings = fit.observations.motion.recordings
    assert recordings is not None
    return np.asarray(HALVES * recordings.number + block % HALVES, dtype=np.int64)


def held_out_rows(fit: Fit, chain: Chain, free: Sequence[Free], fold: IntArray) -> Array:
    """Residual (n,) [rad] of every row in use, each predicted from other recordings and the other half of its own.

    ``chain`` is where the fits set out from, ``free`` what they may move, ``fold`` (n,) that of :func:`halves`.
    """
    use, recordings = fit.observations.usable, fit.observations.motion.recordings
    assert recordings is not None
    residual = np.full(len(fit.observations), np.nan)
    for number in range(len(recordings)):
        own = [one for one in free if owner(one, fit.observations.motion) == number]
        shared = tuple(one for one in free if one not in own)
        here = fold // HALVES == number
        if np.count_nonzero(use & ~here) <= len(shared):
            continue
        told = solve(evaluate(chain, shared, fit.observations.masked(use & ~here), fit.weighting), iterations=6)
        for half in range(HALVES):
            seen = here & (fold % HALVES != half)
            if np.count_nonzero(use & seen) <= len(own):
                continue
            settled = solve(evaluate(told.chain, tuple(own), fit.observations.masked(use & seen), fit.weighting))
            held = here & (fold % HALVES == half)
            residual[held] = wrap(fit.observations.measured - settled.linear.angle)[held]
    return residual
