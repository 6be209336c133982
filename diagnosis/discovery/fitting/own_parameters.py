"""What a given twin brings along, set free: its own parameters, as far as this recording tells them."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.free_parameters import BASELINE, Free, free_of, value_of
from diagnosis.discovery.fitting.initial_fit import awake
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from twin.angles import Array
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Effect

_TOLD = 1e-4
"""Share of a parameter's column that no other parameter can do, below which a recording does not tell it: the square of
it stands in a fit's normal equations, beside which a double has four digits left."""


def own_free(fit: Fit, keys: Collection[str], *, shapes: bool) -> Fit:
    """The fit with the given twin's own parameters free as well, as far as this recording tells them.

    These are the paper's factors and the parameters of the effects ``keys`` that the twin has; with ``shapes`` also
    those that mean nothing without a strength: orders, memories, frequencies.
    """
    chain = awake(fit.chain)
    held = set(fit.free)
    effects = _of_effects(fit, chain, keys, shapes=shapes)
    offered = [free for free in (*BASELINE, *effects) if free not in held]
    free = _told(evaluate(chain, (*fit.free, *offered), fit.observations, fit.weighting), len(fit.free))
    return solve(evaluate(chain, free, fit.observations, fit.weighting))


def _of_effects(fit: Fit, chain: Chain, keys: Collection[str], *, shapes: bool) -> list[Free]:
    """The parameters of the effects that the twin has beside the baseline, where the recording can show them."""
    provides = fit.observations.motion.provides
    found: list[Free] = []
    for key in keys:
        effect, values = find(key, chain.effects), chain.values.get(key, {})
        present = not effect.is_null({**effect.null(), **values})
        if effect.footprint == "mean" and not effect.baseline and present and effect.visible_in(provides):
            free = free_of(effect, key, turns=1, channels=fit.observations.observables == 2)
            found += [one for one in free if one.turn is None and (shapes or not is_shape(effect, one.name))]
    return found


def is_shape(effect: Effect, name: str) -> bool:
    """Whether a parameter means nothing without a strength, as an order or a memory does."""
    return effect.params[name].role == "shape"


def _told(fit: Fit, most: int) -> tuple[Free, ...]:
    """The free parameters without those that the ones ahead of them can do; the first ``most`` are kept in any case."""
    _, jacobian = fit.whitened()
    kept: list[Free] = list(fit.free[:most])
    basis: list[Array] = []
    for place, (free, column) in enumerate(zip(fit.free, jacobian, strict=True)):
        size = float(np.linalg.norm(column))
        left = column
        for _ in range(2):
            # Twice: once leaves rounding that is as large as what a nearly dependent column has of its own.
            left = left - sum((one * float(one @ left) for one in basis), np.zeros_like(left))
        own = float(np.linalg.norm(left))
        if own > 1e-12 and own > _TOLD * size:
            basis.append(left / own)
            kept += [free] if place >= most else []
    return tuple(kept)


def tested(fit: Fit, before: Fit) -> tuple[Free, ...]:
    """The parameters free beyond those before that are asked whether they have moved."""
    added = (free for free in fit.free if free not in before.free)
    return tuple(free for free in added if not is_any(find(free.key, fit.chain.effects), free.name))


def is_any(effect: Effect, name: str) -> bool:
    """Whether another recording of the same device may have any value of a parameter, so that it is no change.

    So what belongs to the recording, and where something sits that turns when sensor or magnet is put back.
    """
    owner = effect.owner(name)
    return owner == "recording" or (owner == "mounting" and effect.params[name].role == "phase")


def set_back(fit: Fit, free: Sequence[Free], twin: Chain) -> Fit:
    """The fit with these parameters held at the values that the twin has for them, all others at their optimum."""
    values = {key: dict(params) for key, params in fit.chain.values.items()}
    for one in free:
        values[one.key][one.name] = value_of(twin, one)
    kept = tuple(one for one in fit.free if one not in set(free))
    return solve(evaluate(replace(fit.chain, values=values), kept, fit.observations, fit.weighting))
