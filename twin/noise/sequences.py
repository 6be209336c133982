"""Sequences of noise drawn from a spectrum, Gaussian or heavy-tailed, and what they do to a pair of channels."""

from __future__ import annotations

import numpy as np

from twin.angles import Array
from twin.noise.spectrum import to_cosine, to_rows


def innovations(rng: np.random.Generator, shape: tuple[int, ...], *, dof: float = np.inf) -> Array:
    """Independent draws of unit variance: Gaussian, or of Student's t with ``dof`` > 2 degrees of freedom."""
    if not np.isfinite(dof):
        return rng.standard_normal(shape)
    return np.asarray(np.sqrt((dof - 2.0) / dof) * rng.standard_t(dof, shape))


def draw(rng: np.random.Generator, shape: tuple[int, ...], spectrum: Array, *, dof: float = np.inf) -> Array:
    """Noise (..., n) of a spectrum (n,) over the cosine coefficients, along the last axis; its :func:`innovations` too.

    Near the ends of a strongly correlated sequence the RMS is up to 1.4 times that of its middle: the basis takes the
    sequence to be mirrored there.
    """
    white = innovations(rng, shape, dof=dof)
    # In any orthonormal basis Gaussian innovations look alike.
    return to_rows(np.sqrt(spectrum) * (to_cosine(white) if np.isfinite(dof) else white))


def autoregressive(
    rng: np.random.Generator, shape: tuple[int, ...], correlation: float, *, dof: float = np.inf
) -> Array:
    """Stationary first-order autoregressive noise of unit variance along the last axis, by its recursion."""
    white = innovations(rng, shape, dof=dof)
    if correlation == 0.0:
        return white
    out = np.empty(shape)
    state = white[..., 0]
    out[..., 0] = state
    innovation = np.sqrt(1.0 - correlation**2)
    for k in range(1, shape[-1]):
        state = correlation * state + innovation * white[..., k]
        out[..., k] = state
    return out


def turned(channels: Array, angle_rad: Array) -> Array:
    """Channels (..., 2, n) turned about the origin by angles (..., n) [rad]."""
    x, y = channels[..., 0, :], channels[..., 1, :]
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    return np.stack([x * cos - y * sin, x * sin + y * cos], axis=-2)
