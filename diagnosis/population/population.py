"""All that is said of a batch of devices, from the figures of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from diagnosis.population.apart import Apart, Distances, distances, standing_apart, usual_devices
from diagnosis.population.batch import Batch
from diagnosis.population.changes import ChangeOfBatch, changes_of
from diagnosis.population.corrections import Correction, corrections_of
from diagnosis.population.spread import CauseOfBatch, FactorOfBatch, cause_of, factors_of
from twin.errors import UserError

FEWEST_DEVICES = 2
"""One has no spread."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Population:
    """What usable devices have in common and how they scatter; which stand apart; what changes in their order.

    ``batch`` holds them; places in ``apart`` and ``changes`` are its own.
    """

    batch: Batch
    factors: tuple[FactorOfBatch, ...]
    causes: tuple[CauseOfBatch, ...]
    apart: tuple[Apart, ...]
    changes: tuple[ChangeOfBatch, ...]
    corrections: tuple[Correction, ...]
    distances: Distances


def population_of(batch: Batch, not_told_from: Mapping[int, tuple[str, ...]]) -> Population:
    """The population of the usable devices of a batch.

    ``not_told_from``: by place among the candidates, causes that said as much of the batch as the one that was taken.
    Raises UserError where there are too few devices.
    """
    usable = batch.part(batch.usable)
    if len(usable) < FEWEST_DEVICES:
        raise UserError(
            f"{len(usable)} of {len(batch)} devices can be used; expected at least {FEWEST_DEVICES}, one file each"
        )
    far = distances(usable)
    apart = standing_apart(usable, far)
    usual = usual_devices(usable, apart)
    within = usable.part(usual)
    causes = [
        cause_of(usable, number, not_told_from.get(place, ()), usual)
        for number, place in enumerate(usable.question.present)
    ]
    return Population(
        batch=usable,
        factors=tuple(factors_of(within if len(within) >= FEWEST_DEVICES else usable)),
        causes=tuple(sorted(causes, key=lambda one: one.log_p)),
        apart=tuple(apart),
        changes=tuple(changes_of(usable, usual)),
        corrections=tuple(
            corrections_of(usable, usual, [one.phase_from[-1] if one.phase_from else None for one in causes])
        ),
        distances=far,
    )
