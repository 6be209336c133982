"""Held-out proof over several recordings: what the others tell of the device, on a recording that they have not seen.

A recording is held out as a whole. What belongs to it alone, its zero and what happened in it, is fitted to one half of
it and judged on the other, in blocks; everything else comes from the other recordings.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.own_zeros import owner
from twin.angles import IntArray
from twin.catalogue import find
from twin.each_recording import acts_in
from twin.effect import BoolArray

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


@dataclass(frozen=True, eq=False)
class Split:
    """Rows that are held out: what is fitted to others first, and in each part what to which rows, ahead of its own.

    ``seen`` (n,) are the rows of the first fit, ``free`` what it moves, ``fewest`` the readings that it takes. A part
    holds the rows (n,) of a second fit, what that moves, and the rows (n,) that are then predicted.
    """

    seen: BoolArray
    free: tuple[Free, ...]
    fewest: int
    parts: tuple[tuple[BoolArray, tuple[Free, ...], BoolArray], ...]


def of_recordings(fit: Fit, free: Sequence[Free], fold: IntArray) -> Iterator[Split]:
    """Each recording as a whole: what is common is told by the others, what is its own by the other half of it.

    ``fold`` (n,) is that of :func:`halves`.
    """
    use, recordings = fit.observations.usable, fit.observations.motion.recordings
    assert recordings is not None
    for number in range(len(recordings)):
        own = tuple(one for one in free if owner(one, fit.observations.motion) == number)
        shared = tuple(one for one in free if one not in own)
        here = fold // HALVES == number
        halves_here = [here & (fold % HALVES == half) for half in range(HALVES)]
        parts = tuple((use & here & ~held, own, held) for held in halves_here)
        yield Split(use & ~here, shared, len(shared), parts)
