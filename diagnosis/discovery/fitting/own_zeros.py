"""What belongs to single recordings of a device: zeros, those of their turns, and what happened in them alone."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.free_parameters import ZERO_ANGLE, Free
from twin.chain import Chain
from twin.each_recording import MARK, acts_in
from twin.mechanics.zero import ZERO
from twin.motion import Motion


def own_zeros(chain: Chain) -> tuple[Free, ...]:
    """The zeros of further recordings of the device, each beside that of the first one."""
    return tuple(Free(effect.name, ZERO_ANGLE.name) for effect in chain.effects if zero_of(effect.name) is not None)


def zero_of(key: str) -> int | None:
    """The further recording (counted from 0) whose own zero a key is; None: it is something else."""
    return acts_in(key) if key.startswith(f"{ZERO.name}{MARK}") else None


def owner(free: Free, motion: Motion) -> int | None:
    """The recording (counted from 0) that a free parameter belongs to; None: it is common to all.

    The first one's zero is that of all, beside which the others count; a turn's zero is its recording's.
    """
    assert motion.recordings is not None
    if free == ZERO_ANGLE:
        return 0
    if free.turn is not None:
        return int(motion.recordings.number[np.argmax(motion.turn == free.turn)])
    return acts_in(free.key)
