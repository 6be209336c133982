"""Batches of the independent generator, and what is said of them."""

from __future__ import annotations

from functools import cache

from diagnosis.population.looks import Looked, looked_at_sweeps
from diagnosis.population.population import Population
from diagnosis.population.template import Template, template_of
from tests.hidden.fleets.generator import Plan
from tests.hidden.fleets.study import sweeps_of


def looked(plan: Plan, *, seed: int) -> tuple[Template, Looked]:
    sweeps = sweeps_of(plan, seed=seed)
    template = template_of(sweeps[:16], told_sense=None, seed=0)
    return template, looked_at_sweeps(template, sweeps)


@cache
def clean() -> tuple[Template, Looked, Population]:
    """Sixty devices that share nothing but the scatter of their factors."""
    template, found = looked(Plan(count=60), seed=11)
    return template, found, found.population
