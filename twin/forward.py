"""The signals of the chain, and what an effect does to one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from twin.angles import Array
from twin.motion import Motion
from twin.param import Parameters

ActsOn = Literal["shaft", "field", "channels", "angle", "word", "reference"]
"""The signal an effect changes, in the order of the chain.

``shaft``      angle of the magnet on the shaft [rad], one for each channel's sampling instant, ``(..., 2, n)``
``field``      angle of the field in the sensor's axes [rad], ``(..., 2, n)``
``channels``   x and y, nominal amplitude 1, ``(..., 2, n)``
``angle``      the angle computed from them [rad], ``(..., 1, n)``
``word``       the same as it is sent, counted as the output counts [rad], ``(..., 1, n)``
``reference``  the reference encoder's reading [rad], ``(..., 1, n)``
"""


class Forward(Protocol):
    """What an effect does to its signal.

    Parameters
    ----------
    signal : array, (..., k, n)
        The signal that the effect acts on, as :data:`ActsOn` describes it.
    motion : Motion
        What the shaft does at each of the n readings.
    values : mapping
        Every parameter by name: scalars, or arrays (batch, 1, 1).
    rng : numpy.random.Generator or None
        Draws what is random; without it the effect acts in expectation, and what is random does nothing.

    Returns
    -------
    array
        The changed signal, of the same shape; the one handed in stays as it is.
    """

    def __call__(self, signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array: ...


@dataclass(frozen=True, kw_only=True)
class Behind:
    """What an effect also does to a signal behind the one that it acts on.

    ``forward`` is given all of the effect's parameters; where those named in ``params`` are at their nulls it does
    nothing. ``record_wide`` is as in :class:`Effect`.
    """

    acts_on: ActsOn
    forward: Forward
    params: tuple[str, ...]
    record_wide: bool = False
