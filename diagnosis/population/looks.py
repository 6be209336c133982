"""Look at every device, again with each cause that the batch shows fitted along, until it shows no further one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.population.batch import Batch, asked_next, log_p_of_candidates
from diagnosis.population.device import Question, estimates
from diagnosis.population.pooled import not_told_from, together
from diagnosis.population.population import Population, population_of
from diagnosis.population.template import Template
from twin.sweep import Sweep

MOST_LOOKS = 12
"""Looks at every device: a batch that shows yet more causes is not searched further, and the answer says so."""

Look = Callable[[int, Question], Batch]
"""The batch as every device answers a question; the first look has the number 0."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Looked:
    """The batch at the last look, how many there were, and whether it then showed no further cause.

    ``not_told_from``: by place among the candidates, causes that said nearly as much of the batch when it was found.
    """

    batch: Batch
    looks: int
    ended: bool
    not_told_from: Mapping[int, tuple[str, ...]]

    @property
    def population(self) -> Population:
        """What is said of the batch. Raises UserError where too few of its devices can be used."""
        return population_of(self.batch, self.not_told_from)


def looked_at(template: Template, look: Look) -> Looked:
    """Ask all devices until nothing new is found; see :func:`diagnosis.population.batch.asked_next`."""
    others: dict[int, tuple[str, ...]] = {}
    question = template.question
    number = 0
    while True:
        question = template.with_noise(question)
        batch = look(number, question)
        number += 1
        usable = batch.part(batch.usable)
        log_p = together(log_p_of_candidates(usable))
        following = asked_next(usable, log_p, template.overlaps(question))
        if following is None or number == MOST_LOOKS:
            return Looked(batch=batch, looks=number, ended=following is None, not_told_from=others)
        for place in following.present:
            others.setdefault(place, not_told_from(place, log_p, question.candidates))
        question = following


def looked_at_sweeps(template: Template, sweeps: Sequence[Sweep]) -> Looked:
    """The same of sweeps that are held in memory."""

    def look(number: int, question: Question) -> Batch:
        rng = np.random.default_rng([question.seed, number])
        return Batch(tuple(sweep.name for sweep in sweeps), question, estimates(sweeps, question, rng=rng))

    return looked_at(template, look)
