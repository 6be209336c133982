"""The work behind the figures, each part done once and only where a figure or a table asks for it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from diagnosis.progress import Count
from scenarios.commands.paper.delta_e import drawn_chain, terms_deg
from scenarios.commands.paper.devices import Device, devices
from scenarios.commands.paper.search import Method, Searched, coarse_grid_rad, methods, search
from scenarios.commands.paper.search_figures import BANDS
from scenarios.commands.paper.table_2 import Cases, draw
from twin.angles import Array

CASES = 100
"""As many as the paper's."""


@dataclass(frozen=True, eq=False)
class Work:
    """``cases`` are drawn from Table 2; the same seed makes the same figures. ``count`` hears how far it is."""

    cases: int = CASES
    seed: int = 0
    count: Count = field(default_factory=lambda: Count(0))

    @staticmethod
    def steps(cases: int) -> int:
        """How many searches there are in all."""
        return cases * (len(methods(0.0)) + len(BANDS) - 1)

    @property
    def delta_e_deg(self) -> float:
        """Delta E of the drawn cases."""
        return sum(terms_deg(drawn_chain()).values())

    @cached_property
    def drawn(self) -> Cases:
        """The random cases."""
        return draw(self.cases, np.random.default_rng(self.seed))

    @cached_property
    def methods(self) -> dict[str, Method]:
        """What is compared."""
        return methods(float(np.radians(self.delta_e_deg)))

    @cached_property
    def searched(self) -> dict[str, Searched]:
        """Each method on the same cases."""
        return {name: self._search(method, place) for place, (name, method) in enumerate(self.methods.items())}

    @cached_property
    def banded(self) -> dict[float, Searched]:
        """The discard rule with bands of so many Delta E."""
        wider = [
            self._search(Method("", band_rad=float(np.radians(times * self.delta_e_deg))), len(self.methods) + place)
            for place, times in enumerate(BANDS[1:])
        ]
        return dict(zip(BANDS, [self.searched["discard"], *wider], strict=True))

    @cached_property
    def coarse_grid_rad(self) -> Array:
        """RMS error that the ordinary method's coarse grid leaves (cases,)."""
        return coarse_grid_rad(self.drawn)

    @cached_property
    def devices(self) -> dict[str, Device]:
        """The devices of Table 2."""
        return devices(self.seed)

    def _search(self, method: Method, place: int) -> Searched:
        return search(self.drawn, method, seed=self.seed + 1, count=self.count, done=place * self.cases)
