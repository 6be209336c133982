"""What all devices of a batch are asked: taken from the first of them, as their protocol is one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from diagnosis.error_model.fit import fit_baseline
from diagnosis.factors.channels import output_sense
from diagnosis.factors.mirror import DECIDED_LOG_ODDS
from diagnosis.population.candidates import candidates_for, overlaps
from diagnosis.population.device import FEWEST_ROWS, Question, left_over
from diagnosis.population.noise import autoregression
from twin.angles import Array, radians
from twin.chain import Chain
from twin.following import slope_of
from twin.motion import Motion
from twin.sweep import Sweep

LOOKED_AT = 32
"""Devices that tell which way their outputs count: together they know the quadratic term five times better than one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Template:
    """A motion and a chain like those of most devices, and what all are asked.

    ``sense_by`` says who told which way the outputs count, m = h atan2(y, x); ``decided`` whether the odds did.
    ``sweeps`` are those of the first devices.
    """

    sweeps: Sequence[Sweep]

    motion: Motion
    chain: Chain
    question: Question
    sense_by: Literal["option", "channels", "quadratic term"]
    decided: bool

    def with_noise(self, question: Question) -> Question:
        """The question with the noise that the first devices show, less what is fitted along."""
        known = [sweep for sweep in self.sweeps if len(sweep) >= FEWEST_ROWS + 2 * question.fitted]
        if not known:
            return question
        left = left_over(known, question, rng=np.random.default_rng(question.seed))
        return replace(question, noise=tuple(map(float, autoregression(left))))

    def overlaps(self, question: Question) -> Array:
        """Largest cosines (C, C) between the candidates, beyond what is fitted along."""
        present = [question.candidates[place] for place in question.present]
        return overlaps(self.motion, self.chain, question.candidates, present)


def template_of(sweeps: Sequence[Sweep], *, told_sense: int | None, seed: int) -> Template:
    """The template of at least one device."""
    provided = [sweep.motion().provides for sweep in sweeps]
    usual = Counter(provided).most_common(1)[0][0]
    first = sweeps[provided.index(usual)]
    sense, by, decided = _output_sense(sweeps, told_sense, seed)
    reference, measured = radians(first.reference_deg), radians(first.measured_deg)
    senses = (slope_of(reference, measured) * sense, sense)
    fit = fit_baseline(reference, measured, rng=np.random.default_rng(seed), senses=senses, robust=True)
    motion, chain = first.motion(), fit.chain()
    question = Question(candidates=candidates_for(motion, chain), output_sense=sense, seed=seed)
    return Template(sweeps=tuple(sweeps), motion=motion, chain=chain, question=question, sense_by=by, decided=decided)


def _output_sense(
    sweeps: Sequence[Sweep], told: int | None, seed: int
) -> tuple[int, Literal["option", "channels", "quadratic term"], bool]:
    """Which way the outputs count; devices of one kind count alike, so that their evidence adds up."""
    if told is not None:
        return told, "option", True
    channels = [
        output_sense(radians(sweep.measured_deg), sweep.vx, sweep.vy)
        for sweep in sweeps
        if sweep.vx is not None and sweep.vy is not None
    ]
    if channels:
        return (1 if sum(channels) >= 0 else -1), "channels", True
    rng = np.random.default_rng(seed)
    log_odds = 0.0
    for sweep in sweeps:
        fit = fit_baseline(radians(sweep.reference_deg), radians(sweep.measured_deg), rng=rng, robust=True)
        log_odds += 0.5 * fit.senses.output * fit.senses.sigma**2
    return (1 if log_odds >= 0.0 else -1), "quadratic term", abs(log_odds) >= DECIDED_LOG_ODDS
