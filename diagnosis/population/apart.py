"""Which devices stand apart from their batch, and in what; false alarms are held down over devices and figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.population.batch import ZERO, Batch
from diagnosis.population.false_discovery import threshold
from diagnosis.population.pooled import FALSE_SHARE, SENSOR, Figures
from diagnosis.population.robust_distance import rest_of
from twin.angles import Array
from twin.baseline import FACTORS
from twin.effect import BoolArray

RESIDUAL = "residual RMS"
FACTORS_AND_RESIDUAL = (*(factor.label for factor in FACTORS[:ZERO]), RESIDUAL)
"""What the distance of a device is taken over."""
FEWEST_DEVICES = 5 * len(FACTORS_AND_RESIDUAL)
"""Fewer do not show how they scatter in so many figures."""


@dataclass(frozen=True, kw_only=True)
class Apart:
    """A device that stands apart: its place, how improbable that is by chance, and in what.

    Causes and factors come ahead of the residual, the most improbable first. ``log_p`` is that of the device in any
    figure; ``distance`` in standard deviations of the rest.
    """

    device: int
    log_p: float
    distance: float
    figures: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Distances:
    """Squared distances (N, 1 + C) of devices by their factors and by each candidate, log p of each; NaN: not known.

    ``scores`` (N, F): each of the factors and the residual's RMS by itself, in standard deviations of the rest.
    """

    squares: Array
    log_p: Array
    scores: Array


def distances(batch: Batch) -> Distances:
    """How far each device of a batch stands from the rest, in every figure."""
    count = len(batch.question.candidates)
    squares, log_p = (np.full((len(batch), 1 + count), np.nan) for _ in range(2))
    scores = np.zeros((len(batch), len(FACTORS_AND_RESIDUAL)))
    if len(batch) < FEWEST_DEVICES:
        return Distances(squares, log_p, scores)
    values = np.column_stack([batch.arrays["fitted"][:, :ZERO], np.log(batch.arrays["sigma_deg"])])
    rest = rest_of(values)
    squares[:, 0], scores = rest.squares(values, _errors_beyond_usual(batch)), rest.scores(values)
    log_p[:, 0] = _log_p(squares[:, 0], values.shape[1], len(batch) - values.shape[1])
    freedom = batch.arrays["freedom"]
    for place, one in enumerate(batch.question.candidates):
        if place in batch.question.present:
            figures = batch.figures_of_present(batch.question.present.index(place))
            squares[:, 1 + place] = _of_shared(figures)
        else:
            squares[:, 1 + place] = _of_absent(batch.arrays["candidate_square"][:, place], one.terms)
        log_p[:, 1 + place] = _log_p(squares[:, 1 + place], one.terms, freedom)
    return Distances(squares, log_p, scores)


def _errors_beyond_usual(batch: Batch) -> Array:
    """Variances (N, F) by which a device's figures are less well known than a usual one's.

    The errors of usual ones are part of the scatter of the rest.
    """
    errors = batch.arrays["fitted_error"][:, :ZERO]
    log_rms = 1.0 / np.sqrt(2.0 * batch.arrays["freedom"])
    variance = np.column_stack([errors, log_rms]) ** 2
    return np.asarray(np.maximum(variance - np.median(variance, axis=0), 0.0))


def standing_apart(batch: Batch, found: Distances, share: float = FALSE_SHARE) -> list[Apart]:
    """The devices that stand apart, farthest first.

    Of each the most improbable figure counts, as many times as there are figures (Bonferroni); devices are independent
    of one another, as their readings are.
    """
    tried = np.count_nonzero(np.isfinite(found.log_p), axis=1)
    together = np.full(tried.size, np.nan)
    together[tried > 0] = np.nanmin(found.log_p[tried > 0], axis=1) + np.log(tried[tried > 0])
    limit = threshold(together, share, independent=True)
    apart = []
    with np.errstate(invalid="ignore", divide="ignore"):
        outside = found.log_p + np.log(tried)[:, None] <= limit
    for device in np.flatnonzero(outside.any(axis=1)):
        places = np.flatnonzero(outside[device])
        ranked = places[np.argsort(found.log_p[device, places])]
        names = [_name(batch, found, int(device), int(place)) for place in ranked]
        # A residual that is larger says nothing beside what makes it so.
        names.sort(key=lambda name: name == RESIDUAL)
        best = ranked[0]
        apart.append(
            Apart(
                device=int(device),
                log_p=float(together[device]),
                distance=float(np.sqrt(found.squares[device, best])),
                figures=tuple(dict.fromkeys(names)),
            )
        )
    return sorted(apart, key=lambda one: (one.log_p, one.device))


def _name(batch: Batch, found: Distances, device: int, place: int) -> str:
    """What a device stands apart in: a cause by its name, the factors by that which is farthest off."""
    if place > 0:
        return batch.question.candidates[place - 1].effect
    return FACTORS_AND_RESIDUAL[int(np.argmax(np.abs(found.scores[device])))]


def _of_absent(squares: Array, terms: int) -> Array:
    """Squared distances (N,) by a cause that the batch does not share, from its sizes in errors, squared."""
    from scipy.special import chdtri

    seen = np.isfinite(squares)
    if np.count_nonzero(seen) < FEWEST_DEVICES:
        return np.full(squares.size, np.nan)
    # Only noise scatters here: where it does so by more than the errors say, the errors are too small.
    return squares / max(float(np.median(squares[seen])) / float(chdtri(terms, 0.5)), 1.0)


def _of_shared(figures: Figures) -> Array:
    """Squared distances (N,) by a cause that the batch shares, in the scatter of its own sizes."""
    found = np.full(figures.seen.size, np.nan)
    if np.count_nonzero(figures.seen) >= FEWEST_DEVICES:
        values = _about_what_is_usual(figures)[figures.seen]
        found[figures.seen] = rest_of(values).squares(values)
    return found


def _about_what_is_usual(figures: Figures) -> Array:
    """Coefficients (N, T) less their medians, with phases counted from where they agree best."""
    ways = [figures.values] if figures.turned is None else [figures.values, figures.counted_from(SENSOR)]
    about = [values - np.median(values[figures.seen], axis=0) for values in ways]
    sizes = [float(np.median(np.linalg.norm(values[figures.seen], axis=1))) for values in about]
    return about[int(np.argmin(sizes))]


def _log_p(squares: Array, terms: int, freedom: Array | int) -> Array:
    """Log of the probability of squared distances (N,) as large, their unit known with so many degrees of freedom."""
    known = np.isfinite(squares)
    found = np.full(squares.shape, np.nan)
    free = np.broadcast_to(freedom, squares.shape)[known]
    found[known] = log_probability((free + terms) * np.log1p(squares[known] / free), terms, free + terms)
    return found


def usual_devices(batch: Batch, apart: list[Apart]) -> BoolArray:
    """Which devices (N,) do not stand apart."""
    usual = np.full(len(batch), True)
    usual[[one.device for one in apart]] = False
    return usual
