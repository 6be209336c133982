"""Ringing: a narrow band of noise, as a bracket makes it that random knocks keep at its resonance."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from twin.angles import Array
from twin.noise.description import Noise

_QUALITIES = np.geomspace(3.0, 48.0, 7)
"""From where a resonance has hardly a peak to where it rings out in some fifteen periods."""
_WHITE_SHARES = (0.1, 0.3, 0.5, 0.7, 0.85)
_LEAST_WIDTH = 4.0
"""Of a band in units of what the record resolves: one that is narrower is no wider than a line."""
_HALVINGS = 4
_STILL = 0.1
"""Of the motion's variance against the noise's: less of it changes no mean square by more than its own scatter."""
_MOST_BINS = 1500
"""Of longer records neighbouring coefficients are averaged: no band is as narrow as these are then wide."""


def ringing(fit: Fit) -> Noise | None:
    """The resonance that explains best what the fit leaves of the angle; None where none can be told.

    By the likelihood of the cosine coefficients, each of which has the variance that the spectrum says (P. Whittle,
    Ark. Mat. 2 (1953) 423): first on a grid as fine as the bands are wide, then about its best point.
    """
    if len(fit.observations.lengths) > 1 and fit.observations.motion.estimated is None:
        return None
    squares, rows = _mean_squares(fit)
    if not np.nansum(squares):
        return None
    bins = squares.size
    told = np.isfinite(squares)
    squares = squares[told]

    def cost(spectrum: Array) -> float:
        here = spectrum[told]
        return float(np.log(np.mean(squares / here)) + np.mean(np.log(here)))

    tried = (
        (cost(white + (1.0 - white) * spectrum), replace(noise, white_share=white))
        for noise in _tried(rows)
        for spectrum in (noise.spectrum(bins),)
        for white in _WHITE_SHARES
    )
    lowest, best = min(tried, key=lambda one: one[0], default=(np.inf, None))
    if best is None:
        return None
    for halving in range(1, _HALVINGS + 1):
        for step in itertools.product((-1.0, 0.0, 1.0), repeat=3):
            near = _moved(best, 0.5**halving * np.array(step))
            if (here := cost(near.spectrum(bins))) < lowest:
                best, lowest = near, here
    return best


def _mean_squares(fit: Fit) -> tuple[Array, int]:
    """Mean squares (bins,) of what the fit leaves over frequency, and the rows of a sequence that resolve it.

    The noise of a record in several sequences is alike in all. NaN where the shaft may have moved as much as that.
    """
    observations = fit.observations
    rows = int(np.median(observations.lengths))
    bins = -(-rows // -(-rows // _MOST_BINS))
    frequency = _frequencies(observations.lengths)
    still = np.broadcast_to(np.asarray(observations.motion_spectrum) < _STILL, frequency.shape)
    number = np.minimum((2.0 * frequency[still] * bins).astype(np.int64), bins - 1)
    squares = fit.cosine_residual[0][still] ** 2
    count = np.bincount(number, minlength=bins)
    with np.errstate(invalid="ignore"):
        return np.bincount(number, squares, minlength=bins) / count, rows


def _frequencies(lengths: Sequence[int]) -> Array:
    """Frequency (n,) [1/reading] of each cosine coefficient of sequences one behind the other."""
    return np.concatenate([(np.arange(length) + 0.5) / (2.0 * length) for length in lengths])


def _tried(rows: int) -> Iterator[Noise]:
    """Resonances half a band's width apart, of all frequencies at which the record shows their width."""
    for quality in _QUALITIES:
        place = _LEAST_WIDTH * quality / rows
        while place < 0.5:
            yield Noise(ringing_per_reading=float(place), ringing_quality=float(quality))
            place *= 1.0 + 0.5 / quality


def _moved(noise: Noise, by: Array) -> Noise:
    """A noise near it: by shares of the grid's steps in frequency, quality and white share."""
    quality = noise.ringing_quality
    return replace(
        noise,
        ringing_per_reading=float(np.clip(noise.ringing_per_reading * (1.0 + 0.5 * by[0] / quality), 1e-4, 0.5)),
        ringing_quality=float(quality * (_QUALITIES[1] / _QUALITIES[0]) ** by[1]),
        white_share=float(np.clip(noise.white_share + 0.2 * by[2], 0.01, 0.95)),
    )


def within_band(noise: Noise, columns: Array, lengths: Sequence[int]) -> Array:
    """The share (q,) of the squares of cosine coefficients (q, n), sequence by sequence, in the band of a resonance.

    Twice as far to both sides as it is wide at half of its height: there stand five sixths of its own.
    """
    place, width = noise.ringing_per_reading, noise.ringing_per_reading / noise.ringing_quality
    inside = np.abs(_frequencies(lengths) - place) < 2.0 * width
    squares = columns**2
    return np.asarray(squares[..., inside].sum(axis=-1) / np.maximum(squares.sum(axis=-1), 1e-300))
