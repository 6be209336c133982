"""Which single readings are gross errors: far from the fit, and far from their neighbours on the circle too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from twin.angles import Array
from twin.confidence import OF_MAD

_FAR = 6.0
_FLOOR_RAD = 1e-7


def isolated(
    residual_rad: Array, order: NDArray[np.intp], known: NDArray[np.bool_], weights: Array | None = None
) -> NDArray[np.bool_]:
    """Mask (batch, n) of isolated gross errors.

    ``order`` (batch, n) sorts the readings by shaft angle; ``known`` (batch, n) marks those found before, which
    count for nothing where their neighbours are judged. A reading is a gross error when it lies more than six robust
    standard deviations from the fit and from the median of its four neighbours, and when those share less than half of
    its deviation: so structure, however narrow its peak, is never taken for one. Rows of weight 0 are not looked at.
    """
    witnesses = np.take_along_axis(np.where(known, 0.0, residual_rad), order, axis=-1)
    around = np.stack([np.roll(witnesses, shift, axis=-1) for shift in (-2, -1, 1, 2)])
    shared = np.empty_like(residual_rad)
    np.put_along_axis(shared, order, np.median(around, axis=0), axis=-1)
    own = residual_rad - shared
    far = np.abs(own) > 0.5 * np.abs(residual_rad)
    for value in (residual_rad, own):
        looked_at = value if weights is None else np.where(weights > 0.0, value, np.nan)
        middle = np.nanmedian(looked_at, axis=-1, keepdims=True)
        scale = OF_MAD * np.nanmedian(np.abs(looked_at - middle), axis=-1, keepdims=True)
        far &= np.abs(value - middle) > _FAR * np.maximum(scale, _FLOOR_RAD)
    return far if weights is None else far & (weights > 0.0)
