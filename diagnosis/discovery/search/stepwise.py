"""The stepwise search: add the cause that gains most, refit everything exactly, exchange and prune, until nothing is
left that stands out of the noise."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.rounding import stairs_rule
from diagnosis.discovery.search.exchange import Search, improve, in_its_place
from diagnosis.discovery.search.forward_step import best_addition, best_together
from diagnosis.discovery.search.likelihood_ratio import settle
from diagnosis.discovery.search.screening import Base
from diagnosis.discovery.search.standing import Standing
from twin.catalogue import base_name, unnamed
from twin.effect import Effect


@dataclass(frozen=True, eq=False)
class Found:
    """What the search ends with: the joint fit, the keys of its causes, how many effects were looked at, and how the
    causes stand against others."""

    fit: Fit
    keys: tuple[str, ...]
    looked_at: int
    standings: Mapping[str, Standing] = field(default_factory=dict)


Tell = Callable[[Found], None]
"""Hears what a search holds whenever that changes."""


def nobody(found: Found) -> None:
    """Hear it and do nothing."""


def search(
    fit: Fit,
    effects: Sequence[Effect],
    keys: Sequence[str] = (),
    *,
    standings: Mapping[str, Standing] | None = None,
    tell: Tell = nobody,
) -> Found:
    """Find the causes that the fit's chain lacks.

    Parameters
    ----------
    fit : Fit
        The joint fit that the search sets out from.
    effects : sequence of Effect
        What may be found; those that the recording cannot show are left out.
    keys : sequence of str
        Causes that the fit holds already, open to revision.
    standings : mapping, optional
        How these stood when they were last examined, by key.
    tell : callable
        Hears what the search holds after each step.

    Returns
    -------
    Found
        The fit is settled with its noise. The causes come without a judgement of their rivals: see
        :func:`~diagnosis.discovery.search.rivals.judge`.
    """
    fit = replace(fit, weighting=replace(fit.weighting, coarse=stairs_rule(fit)))
    plan = Search.among(effects, fit)
    held = list(keys)
    barred: set[str] = set()
    seen: set[frozenset[str]] = set()
    fit, base = settle(fit)
    standings = standings or {}
    if held:
        fit, base, held, standings = _improved(fit, base, held, plan, standings)
    while len(held) < fit.settings.most_causes and _stands_out(fit):
        offered = [effect for effect in plan.effects if effect.name not in barred]
        level = plan.level_beside(fit, held)
        step = best_addition(fit, base, offered, held, level) or best_together(fit, base, offered, held, level)
        if step is None:
            break
        plan = plan.with_contenders(step.added)
        fit, base = settle(step.fit)
        tell(Found(fit, (*held, *step.added), len(plan.effects)))
        fit, base, held, standings = _improved(fit, base, [*held, *step.added], plan, standings)
        # Pruned or exchanged at once: offered again, it would only go round.
        idle = {base_name(key) for key in step.added if key not in held}
        barred |= idle
        tell(Found(fit, tuple(held), len(plan.effects)))
        if not idle and frozenset(held) in seen:
            # Two causes that take each other's place in turns.
            break
        seen.add(frozenset(held))
    # Of those that were handed in it has been asked at the end of the search that they come from.
    for key in [key for key in held if unnamed(key)] if set(held) != set(keys) else []:
        fit, held = in_its_place(fit, key, held, plan)
    return Found(fit, tuple(held), len(plan.effects), standings)


def _improved(
    fit: Fit, base: Base, keys: Sequence[str], plan: Search, standings: Mapping[str, Standing]
) -> tuple[Fit, Base, list[str], Mapping[str, Standing]]:
    """The settled fit improved, and settled again where anything has changed; and how its causes stand."""
    better, held, standings = improve(fit, keys, plan, standings)
    return (fit, base, held, standings) if better is fit else (*settle(better), held, standings)


def _stands_out(fit: Fit) -> bool:
    """Whether anything is left that a file's digits could carry: below, the last digit itself is the structure."""
    rms_rad = float(np.sqrt(np.mean(fit.residual[0][fit.observations.usable] ** 2)))
    return rms_rad > float(np.radians(fit.settings.smallest_rms_deg))
