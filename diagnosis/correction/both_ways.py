"""Readings of both ways as of a shaft that goes neither: what the ways differ by is taken off, half from each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from diagnosis.thermal.recording import Recording
from twin.angles import TAU, Array, wrap

_ORDERS, _ORDERS_OF_WAY = range(1, 9), (1, 2)
"""Of the turn that are fitted beside one another: a lag, and how it goes with a sensor's two axes."""
_SECTORS = 36
"""Of the turn, in which it is counted where both ways have been."""


def between_ways(recording: Recording) -> Recording:
    """The readings (n,) without half of what the ways differ by, as a constant and orders 1 and 2; the same where one
    way alone covers most of the turn.

    Where one of both ways is held out at some angles, a correction of the others would lean to the way that is left
    there, by all that the ways differ by, while the correction of all readings lies between them.
    """
    reference, way = recording.reference_rad, np.sign(recording.direction)
    if not _covered(reference, way):
        return recording
    error = wrap(recording.measured_rad - recording.slope * reference)
    error = wrap(error - np.angle(np.mean(np.exp(1j * error))))
    of_way = [way * shape for shape in _shapes(reference, _ORDERS_OF_WAY)]
    design = np.stack([*_shapes(reference, _ORDERS), *of_way], axis=1)
    fitted = np.linalg.lstsq(design, error, rcond=None)[0]
    return replace(recording, measured_rad=recording.measured_rad - np.stack(of_way, axis=1) @ fitted[-len(of_way) :])


def _shapes(angle: Array, orders: Iterable[int]) -> list[Array]:
    return [np.ones_like(angle), *(wave(order * angle) for order in orders for wave in (np.cos, np.sin))]


def _covered(reference: Array, way: Array) -> bool:
    """Whether both ways go through most of the angles, in more readings than shapes are fitted to."""
    sector = (np.mod(reference, TAU) * (_SECTORS / TAU)).astype(np.int64) % _SECTORS
    there, back = (np.unique(sector[way == one]) for one in (1.0, -1.0))
    return bool(2 * np.intersect1d(there, back).size > _SECTORS and reference.size > 2 * (2 * len(_ORDERS) + 6))
