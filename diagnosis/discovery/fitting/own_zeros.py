"""The zeros of further recordings of a device: each beside that of the first one."""

from __future__ import annotations

from diagnosis.discovery.fitting.joint_fit import ZERO_ANGLE, Free
from twin.chain import Chain
from twin.each_recording import MARK, acts_in
from twin.mechanics.zero import ZERO


def own_zeros(chain: Chain) -> tuple[Free, ...]:
    """The zeros of further recordings of the device, each beside that of the first one."""
    return tuple(Free(effect.name, ZERO_ANGLE.name) for effect in chain.effects if zero_of(effect.name) is not None)


def zero_of(key: str) -> int | None:
    """The further recording (counted from 0) whose own zero a key is; None: it is something else."""
    return acts_in(key) if key.startswith(f"{ZERO.name}{MARK}") else None
