"""Readings that were chosen: the even index of a table, at angles of the reference that are not even."""

from __future__ import annotations

import numpy as np

from twin.angles import Array, wrap_deg

_FEWEST = 8
_SAME_DEG = 1e-6
"""Steps that differ by less are one: cells of a file have nine digits."""


def step_of_grid_deg(measured_deg: Array, reference_deg: Array) -> float | None:
    """Step of readings that were chosen, None where they are what the sensor happened to return.

    Chosen are readings that go on from row to row by one and the same step while the reference does not. A sensor with
    few codes may do the former, read at as many even angles, but then the reference is even, too; read at uneven ones
    it repeats a code or leaves one out.

    Parameters
    ----------
    measured_deg, reference_deg : ndarray
        Readings and angles [deg], (n,), in the order in which they were taken.

    Returns
    -------
    float or None
        The step [deg], positive.
    """
    if measured_deg.size < _FEWEST:
        return None
    even, angle = even_step_deg(measured_deg), wrap_deg(np.diff(reference_deg))
    return None if even is None or np.ptp(angle) <= 2.0 * _SAME_DEG else abs(even)


def even_step_deg(angle_deg: Array) -> float | None:
    """The step [deg] by which an angle (n,) goes on from row to row, None where it is not one and the same, or none."""
    step = wrap_deg(np.diff(angle_deg))
    even = float(np.median(step)) if step.size else 0.0
    return None if even == 0.0 or np.max(np.abs(step - even)) > _SAME_DEG else even
