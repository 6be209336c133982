"""The figures of all devices of a batch, and what of them belongs to which candidate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.population.candidates import Candidate
from diagnosis.population.device import Question
from diagnosis.population.false_discovery import believed
from diagnosis.population.pooled import FALSE_SHARE, Figures, log_p_of, newly_found, together
from twin.angles import Array
from twin.baseline import FACTORS
from twin.effect import BoolArray

ZERO = len(FACTORS) - 1
"""Place of the zero among the factors: it says how a device was put on the bench, and nothing of the device."""
_ALIKE = 0.99
"""Length of the mean of unit vectors above which directions count as one: scatter of 8 deg."""


@dataclass(frozen=True, eq=False)
class Batch:
    """Names of the devices (N,) in their order, what they were asked, and their figures by name (N, ...).

    See :func:`diagnosis.population.device.estimates`.
    """

    names: tuple[str, ...]
    question: Question
    arrays: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def usable(self) -> BoolArray:
        """Which devices (N,) could be fitted."""
        return np.isfinite(self.arrays["fitted"]).all(axis=1) & np.isfinite(self.arrays["sigma_deg"])

    def part(self, chosen: BoolArray) -> Batch:
        """The batch with some of its devices alone."""
        names = tuple(name for name, kept in zip(self.names, chosen, strict=True) if kept)
        return Batch(names, self.question, {name: values[chosen] for name, values in self.arrays.items()})

    @property
    def present(self) -> tuple[Candidate, ...]:
        """The candidates that are fitted along."""
        return tuple(self.question.candidates[place] for place in self.question.present)

    def figures(self, place: int) -> Figures:
        """The coefficients of a candidate beside what is fitted."""
        one = self.question.candidates[place]
        return Figures(
            line=_is_line(one),
            values=self.arrays["candidate"][:, place, : one.terms],
            halves=np.moveaxis(self.arrays["candidate_halves"][:, :, place, : one.terms], 1, 0),
            errors=self.arrays["candidate_error"][:, place],
            turned=self._turned(one),
        )

    def figures_of_present(self, number: int) -> Figures:
        """The coefficients of what is fitted along, beside all the rest of it."""
        one = self.present[number]
        start = len(FACTORS) + sum(other.terms for other in self.present[:number])
        own = slice(start, start + one.terms)
        return Figures(
            line=_is_line(one),
            values=self.arrays["fitted"][:, own],
            halves=np.moveaxis(self.arrays["fitted_halves"][:, :, own], 1, 0),
            errors=np.sqrt(np.mean(self.arrays["fitted_error"][:, own] ** 2, axis=1)),
            turned=self._turned(one),
        )

    def _turned(self, one: Candidate) -> Array | None:
        """By how much the phase (N,) [rad] of a line counted from the sensor's zero is less than from the reference."""
        if not _is_line(one):
            return None
        assert one.order is not None
        sensor_sense = self.arrays["sense"] * self.question.output_sense
        turned = np.asarray(sensor_sense * one.order * np.radians(self.arrays["fitted"][:, ZERO]))
        known = turned[np.isfinite(turned)]
        return None if known.size == 0 or abs(np.mean(np.exp(1j * known))) > _ALIKE else turned


def _is_line(one: Candidate) -> bool:
    """Whether its two coefficients are a strength at two phases over the turn."""
    return one.order is not None and one.terms == 2


def log_p_of_candidates(batch: Batch) -> Array:
    """Log p (C, 3) of each candidate that is not fitted along, by the way in which devices may share it; else NaN."""
    found = np.full((len(batch.question.candidates), 3), np.nan)
    for place, one in enumerate(batch.question.candidates):
        if place not in batch.question.present:
            found[place] = log_p_of(batch.figures(place), one.sign)
    return found


def log_p_of_present(batch: Batch) -> Array:
    """Log p (K,) of what is fitted along, beside all the rest of it."""
    found = [log_p_of(batch.figures_of_present(number), one.sign) for number, one in enumerate(batch.present)]
    return together(np.array(found).reshape(-1, 3))


def asked_next(batch: Batch, log_p: Array, overlaps: Array) -> Question | None:
    """The question with what the batch shows besides, and without what it no longer shows; None: this one was the last.

    ``log_p`` (C,) are those of the candidates, NaN for what is fitted along, ``overlaps`` as in :func:`newly_found`.
    What was taken back is not fitted along again.
    """
    question = batch.question
    every = log_p.copy()
    every[list(question.present)] = log_p_of_present(batch)
    sure = believed(every, FALSE_SHARE)
    back = tuple(place for place in question.present if not sure[place])
    new = [place for place in newly_found(log_p, overlaps, devices=len(batch)) if place not in question.taken_back]
    if not new and not back:
        return None
    kept = tuple(place for place in question.present if place not in back)
    return replace(question, present=(*kept, *new), taken_back=(*question.taken_back, *back))
