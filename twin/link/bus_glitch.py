"""bus_glitch: single bits flip in transmitted angle words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import TAU, Array
from twin.drawing import whole
from twin.effect import BoolArray, Effect, Marks, Param, Parameters
from twin.motion import Motion

WORD_BITS = 16


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    out = np.array(signal)
    flat = out.reshape(-1, out.shape[-1])
    counts = np.broadcast_to(np.ravel(np.asarray(values["count"], dtype=np.int64)), (flat.shape[0],))
    for row, count in zip(flat, counts, strict=True):
        places = rng.choice(row.size, size=min(int(count), row.size), replace=False)
        words = np.round(row[places] / TAU * 2**WORD_BITS).astype(np.int64) % 2**WORD_BITS
        flipped = words ^ (1 << rng.integers(0, WORD_BITS, size=words.size))
        row[places] += (flipped - words) / 2**WORD_BITS * TAU
    return out


def marks(
    measured: Array, residual: Array, noise: Array | float, step: float, motion: Motion
) -> tuple[BoolArray, float]:
    """Rows whose residual stands far out of the noise and is 360/2^k deg within the noise.

    Chance: an outlier of any size lands as near to some 360/2^k with the probability of the share of the logarithmic
    axis that is as near (no nearer than half the noise counts). Those of all rows together: Fisher's method.
    """
    size = np.abs(residual)
    sigma = np.broadcast_to(np.maximum(noise, max(step / np.sqrt(12.0), 1e-9)), size.shape)
    far = size > 7.0 * sigma
    power = np.round(np.log2(TAU / np.maximum(size, 1e-12)))
    away = np.abs(size - TAU / 2.0**power)
    mask = far & (away < 4.0 * sigma) & (power >= 1)
    if not mask.any() or np.count_nonzero(mask) > 0.05 * mask.size:
        # So many are no rare event, whatever their size.
        return np.zeros_like(mask), 0.0
    width = np.minimum(2.0 * np.maximum(away[mask], 0.5 * sigma[mask]) / size[mask] / np.log(2.0), 1.0)
    # An outlier that is no power of two speaks as much against bit flips as one that is speaks for them.
    others = int(np.count_nonzero(far & ~mask))
    return mask, min(_together(float(-np.sum(np.log(width))), width.size) + 3.0 * others, 0.0)


def _together(total: float, count: int) -> float:
    """Log probability that ``count`` uniform p-values have a product of exp(-total) or less: Fisher's method."""
    terms = np.arange(count)
    logs = terms * np.log(max(total, 1e-300)) - np.cumsum(np.log(np.maximum(terms, 1)))
    return float(np.logaddexp.reduce(logs)) - total


def told(touched: int, readings: int) -> Mapping[str, tuple[float, float]]:
    """How many words were hit: known exactly."""
    return {"count": (float(touched), 0.0)}


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """A few words: their error is that of a bit, whatever the strength."""
    return {"count": whole(uniform[:, 0], 1, 6)}


BUS_GLITCH = Effect(
    name="bus_glitch",
    stage="link",
    acts_on="angle",
    params={
        "count": Param(
            unit="1", null=0, lower=0, upper=1e6, doc="words hit", role="random", counts=True, owner="recording"
        ),
    },
    forward=forward,
    footprint="sequence",
    marks=Marks(find=marks, told=told, rows_listed=True),
    record_wide=True,
    drawing=drawing,
    source="definition: one bit of the angle word, so an error of 360/2^k deg",
    signature="rare large errors of 360/2^k deg",
)
