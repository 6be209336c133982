"""All that was found of a batch of devices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from diagnosis.population.population import Population
from diagnosis.population.template import Template


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """All that was found of a batch: its population, and of each file why it could not be used.

    ``names`` in the order of production; ``devices`` are the numbers of their files; ``explained`` answers of
    ``explain`` by number.
    """

    population: Population
    template: Template
    names: tuple[str, ...]
    devices: tuple[int, ...]
    reasons: Mapping[str, str]
    looks: int
    ended: bool
    explained: Mapping[int, dict[str, Any]] = field(default_factory=dict)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """The number of each device in the order of production, from 1."""
        return {name: place for place, name in enumerate(self.names, 1)}
