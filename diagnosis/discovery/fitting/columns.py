"""Columns: what each free parameter does to the observables of a linearised chain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.discovery.fitting.coefficients import observables_to_cosine
from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.fitting.nuisance import without_nuisance
from diagnosis.discovery.fitting.observations import Observations
from twin.angles import Array
from twin.catalogue import find


@dataclass(frozen=True, eq=False)
class Columns:
    """What each free parameter does to the observables, found once it is asked for.

    A trial step that is taken back never asks, and of a fit that is at its end only some are asked for. ``moved`` are
    the parameters: each with the key of its instance, its name, and its turn where it has one a turn.
    """

    linear: Linear
    moved: tuple[tuple[str, str, int | None], ...]
    observations: Observations

    @property
    def rows(self) -> Array:
        """Derivatives (P, O, n) over the rows."""
        return self._found(range(len(self.moved)))[0]

    @property
    def cosine(self) -> Array:
        """The same as cosine coefficients (P, O, n)."""
        return self._found(range(len(self.moved)))[1]

    def cosine_at(self, places: Sequence[int]) -> Array:
        """The coefficients (len(places), O, n) of the parameters at these places."""
        return np.asarray(self._found(places)[1][_span(places)])

    @cached_property
    def _kept(self) -> tuple[Array, Array, set[str]]:
        """Derivatives (P, O, n) over the rows and as coefficients, and the instances whose are known."""
        shape = (len(self.moved), self.observations.observables, len(self.observations))
        return np.empty(shape), np.empty(shape), set()

    def _found(self, places: Sequence[int]) -> tuple[Array, Array]:
        """What is kept, with the derivatives at these places known."""
        rows, cosine, known = self._kept
        asked = dict.fromkeys(key for key in (self.moved[place][0] for place in places) if key not in known)
        if asked:
            new = [place for place, (key, _, _) in enumerate(self.moved) if key in asked]
            for key in asked:
                own = [place for place in new if self.moved[place][0] == key]
                effect = find(key, self.linear.chain.effects)
                rows[_span(own)] = self.linear.derivatives(key, effect, [self.moved[place][1:] for place in own])
            part = _span(new)
            rows[part] = without_nuisance(self.observations, rows[part])
            cosine[part] = observables_to_cosine(self.observations, rows[part])
            known.update(asked)
        return rows, cosine


def _span(places: Sequence[int]) -> slice | list[int]:
    """Places that follow one another as a slice: nothing is copied then."""
    if not places or list(places) != list(range(places[0], places[-1] + 1)):
        return list(places)
    return slice(places[0], places[-1] + 1)
