"""Columns: what each free parameter does to the observables of a linearised chain."""

from __future__ import annotations

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

    A trial step that is taken back never asks. ``moved`` are the parameters: each with the key of its instance, its
    name, and its turn where it has one a turn.
    """

    linear: Linear
    moved: tuple[tuple[str, str, int | None], ...]
    observations: Observations

    @cached_property
    def rows(self) -> Array:
        """Derivatives (P, O, n) over the rows."""
        found = np.empty((len(self.moved), self.observations.observables, len(self.observations)))
        for key in dict.fromkeys(key for key, _, _ in self.moved):
            own = [place for place, (other, _, _) in enumerate(self.moved) if other == key]
            effect = find(key, self.linear.chain.effects)
            found[own] = self.linear.derivatives(key, effect, [self.moved[place][1:] for place in own])
        return without_nuisance(self.observations, found)

    @cached_property
    def cosine(self) -> Array:
        """The same as cosine coefficients (P, O, n)."""
        return observables_to_cosine(self.observations, self.rows)
