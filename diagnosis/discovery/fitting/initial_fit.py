"""Where a discovery starts: who counts which way, and the fit of the baseline or of a given twin."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.free_parameters import BASELINE, ZERO_ANGLE, Free, free_of
from diagnosis.discovery.fitting.joint_fit import Fit, Weighting, evaluate, solve
from diagnosis.discovery.fitting.noise_family import noise_family
from diagnosis.discovery.fitting.observations import Observations
from diagnosis.discovery.fitting.own_zeros import own_zeros
from diagnosis.discovery.fitting.tidy import tidy
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import Array, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.following import slope_of
from twin.motion import Motion
from twin.sweep import Sweep


def senses_of_channels(sweep: Sweep) -> tuple[int, int] | None:
    """Who counts which way, (s, h), where the recorded channels say it: the reading follows h atan2(vy, vx)."""
    if sweep.vx is None or sweep.vy is None:
        return sweep.senses
    measured, reference = np.radians(sweep.measured_deg), np.radians(sweep.reference_deg)
    channel = np.arctan2(sweep.vy, sweep.vx)
    output = slope_of(channel, measured)
    return slope_of(reference, measured) * output, output


def unfitted(observations: Observations, start: Chain, settings: DiscoverySettings) -> Fit:
    """A chain held against the observations as it is, nothing fitted."""
    weight = 1.0 if observations.observables == 2 else 0.0
    weighting = Weighting(
        noise_family(observations.lengths, settings.colour_log_odds, motion=observations.motion_spectrum),
        radius_weight=weight,
        settings=settings,
    )
    return evaluate(start, (), observations, weighting)


def baseline_of(chain: Chain) -> tuple[Free, ...]:
    """The parameters of the error model that a chain can have: a sensor of two periods has no gain error of one."""
    known = {effect.name for effect in chain.effects}
    return tuple(free for free in BASELINE if free.key in known)


def baseline_fit(fit: Fit) -> Fit:
    """The paper's error model, all six factors free."""
    return solve(
        evaluate(awake(fit.chain), (*baseline_of(fit.chain), *own_zeros(fit.chain)), fit.observations, fit.weighting)
    )


def senses_of_angles(observations: Observations) -> int:
    """Whether the readings count with the reference (1) or against it (-1)."""
    return slope_of(observations.motion.shaft_rad, observations.measured)


def counted_alike(twin: Chain, observations: Observations, senses: tuple[int, int] | None) -> Chain:
    """A given twin as the sweep counts: its output turned round where that alone agrees with the readings.

    ``senses`` are (s, h) where the channels say them: a twin of angles alone may be the mirrored one of the pair.
    """
    slope = senses_of_angles(observations) if senses is None else senses[0] * senses[1]
    turned = replace(twin, output_sense=slope * twin.sensor_sense)
    return turned if senses is None or senses[0] == turned.sensor_sense else turned.mirrored()


def fit_of_given(fit: Fit) -> Fit:
    """A given twin with only its zeros free: the zero, and each turn's own where the reference finds it anew."""
    observations, weighting = fit.observations, fit.weighting
    turns = int(observations.motion.turn.max(initial=0)) + 1
    start = fit.chain
    each_turn = {key: effect for key in start.values if (effect := find(key, start.effects)).zeroes_turns}
    chain = start.without(*each_turn)
    chain = chain.with_values({ZERO_ANGLE.key: {ZERO_ANGLE.name: 0.0, **chain.values.get(ZERO_ANGLE.key, {})}})
    chain = aligned(chain, observations.motion, observations.measured)
    free: list[Free] = [ZERO_ANGLE, *own_zeros(chain)]
    if each_turn and turns > 1:
        # Each turn's zero from its own readings: zeros that all begin alike would be held there by their own scatter.
        motion = chain.shaft(observations.motion)
        off = wrap(observations.measured - chain.readings(motion))
        sense = chain.sensor_sense * chain.output_sense
        zeros = np.array([-sense * np.degrees(np.median(off[motion.turn == turn])) for turn in range(turns)])
        for key, effect in each_turn.items():
            chain = chain.with_values({key: {**effect.null(), effect.roles("per turn")[0]: zeros}})
            free += free_of(effect, key, turns=turns, channels=False)
    fit = solve(evaluate(chain, tuple(free), observations, weighting))
    return solve(evaluate(fit.chain, fit.free, observations, weighting))


def awake(chain: Chain) -> Chain:
    """The chain with the whole baseline present, so that every one of its parameters can be fitted."""
    values: dict[str, dict[str, Any]] = {}
    for free in baseline_of(chain):
        null = find(free.key).params[free.name].null
        values.setdefault(free.key, {})[free.name] = chain.values.get(free.key, {}).get(free.name, null)
    return chain.with_values(values)


def aligned(chain: Chain, recorded: Motion, measured: Array) -> Chain:
    """The chain with its zero turned so that its readings agree with the measured ones (n,) on average."""
    zero = float(chain.values[ZERO_ANGLE.key][ZERO_ANGLE.name])
    for _ in range(2):
        off = np.angle(np.mean(np.exp(1j * (measured - chain.readings(chain.shaft(recorded))))))
        zero += float(np.degrees(off)) * chain.output_sense
        chain = chain.with_values({ZERO_ANGLE.key: {ZERO_ANGLE.name: zero}})
    return tidy(chain)
