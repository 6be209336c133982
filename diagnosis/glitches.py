"""Which single readings are gross errors: far from the fit, and far from their neighbours on the circle too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.angles import Array

_REACH = 2
_FAR = 6.0
_MAD = 1.4826
_FLOOR_RAD = 1e-7


def isolated(
    residual_rad: Array, order: NDArray[np.intp], known: NDArray[np.bool_], weights: Array | None = None
) -> NDArray[np.bool_]:
    """Mask (batch, n) of isolated gross errors.

    ``order`` (batch, n) sorts the readings by shaft angle; ``known`` (batch, n) marks those found before, which are
    no witnesses for their neighbours. A reading counts when it lies more than six robust standard deviations from
    the fit *and* from the median of its neighbours: structure, which neighbours share, is never taken for a glitch.
    Rows of weight 0 are not looked at.
    """
    sorted_residual = np.take_along_axis(residual_rad, order, axis=-1)
    witnesses = np.take_along_axis(np.where(known, 0.0, residual_rad), order, axis=-1)
    padded = np.pad(witnesses, ((0, 0), (_REACH, _REACH)), mode="wrap")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * _REACH + 1, axis=-1)
    local = np.empty_like(residual_rad)
    np.put_along_axis(local, order, sorted_residual - np.median(windows, axis=-1), axis=-1)
    far = np.ones(residual_rad.shape, dtype=bool)
    for value in (residual_rad, local):
        looked_at = value if weights is None else np.where(weights > 0.0, value, np.nan)
        middle = np.nanmedian(looked_at, axis=-1, keepdims=True)
        scale = _MAD * np.nanmedian(np.abs(looked_at - middle), axis=-1, keepdims=True)
        far &= np.abs(value - middle) > _FAR * np.maximum(scale, _FLOOR_RAD)
    return far if weights is None else far & (weights > 0.0)
