"""Own parameters: those of a given twin are set free, and what belongs to a recording is looked for afresh in this."""

from __future__ import annotations

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.own_parameters import is_any, own_free, tested
from diagnosis.discovery.search.likelihood_ratio import take_out
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.screening import Base, screen_one
from diagnosis.discovery.state import State
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Effect, Parameters


def own_parameters(state: State) -> State:
    """Free the parameters of a given twin, so that a cause is only what none of them can do.

    Which of them have moved is asked once the causes are known, and their shapes are free only then: without these
    they would go anywhere. An event or a movement in time that belonged to the twin's recording is kept where this one
    shows it too.
    """
    if state.given is None:
        return state
    held = state.fit
    fit = own_free(held, tuple(state.given.values), shapes=False)
    begun_before = {free.key for free in held.free}
    for key in dict.fromkeys(free.key for free in fit.free if free.key not in begun_before):
        effect, names = find(key, fit.chain.effects), [free.name for free in fit.free if free.key == key]
        if any(is_any(effect, name) for name in names):
            fit = _afresh(fit, key)
            if all(effect.owner(name) == "recording" for name in names):
                fit = _borne_out(fit, key)
    return state.with_(fit, baseline=held, own=tested(fit, held))


def _afresh(fit: Fit, key: str) -> Fit:
    """The fit with one effect begun where this recording shows it best: its phase, frequency or instant."""
    effect = find(key, fit.chain.effects)
    was = fit.chain.values[key]
    shapes = {name: float(was[name]) for name in effect.roles("shape") if name in was}
    # An order is the effect's own; a frequency or an instant that belongs to the recording is looked for too.
    kept = None if any(is_any(effect, name) for name in shapes) else [shapes]
    candidate = screen_one(Base.of(take_out(fit, key)), effect, shapes=kept)
    if candidate is None:
        return fit
    begun = {**was, **effect.begin(candidate.values)}
    chain = fit.chain.with_values({key: begun})
    found = solve(evaluate(chain, fit.free, fit.observations, fit.weighting))
    return evaluate(_alike(found.chain, key, effect, was), fit.free, fit.observations, fit.weighting)


def _alike(chain: Chain, key: str, effect: Effect, was: Parameters) -> Chain:
    """The chain with the strengths of an effect signed as they were, its phase half a turn on for that."""
    values = dict(chain.values[key])
    phases, strengths = effect.roles("phase"), effect.roles("strength")
    together = float(np.sum([float(values[name]) * float(was.get(name, 0.0)) for name in strengths]))
    if not phases or together >= 0.0:
        return chain
    values |= {name: -float(values[name]) for name in strengths}
    values[phases[0]] = float(values[phases[0]]) + 180.0
    return chain.with_values({key: values})


def _borne_out(fit: Fit, key: str) -> Fit:
    """The fit without an effect of another recording, where this one does not show it."""
    removal = Removal.of(fit, key)
    return removal.without if removal.log_p > fit.settings.effect_log_p(1) else fit
