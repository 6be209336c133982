"""Every derivative that a fit takes, against a central difference of the whole chain; one table drives all of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from diagnosis.discovery.fitting.free_parameters import Free, free_of
from diagnosis.discovery.fitting.linearised_chain import Linear
from tests.contract.examples import EXAMPLES
from tests.twin.test_mirror import MISPLACED
from twin.adc.adc_inl import BLUR, STEP_PERCENT
from twin.angles import Array, wrap
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.effect import Effect
from twin.example import full_motion
from twin.motion import Motion

# Off the axes, where clipping and a stuck bit have their kinks.
MOTION = replace(full_motion(), shaft_rad=full_motion().shaft_rad + 0.01234)
TURNS = int(MOTION.turn.max()) + 1
EPS = float(np.finfo(np.float64).eps)
INNER_STEP = 1e-6
"""Step, as a share of the amplitude, by which the linearised chain differentiates what lies behind an effect."""
OTHERS = {
    "cardan_coupling": {"amplitude_deg": 0.3, "phase_deg": 20.0},
    "zero": {"zero_deg": 33.0},
    "phase": {"beta_deg": 1.5},
    "quadratic_nonlinearity": {"q_percent": 1.0},
    "offset": {"x_percent": 3.0, "y_percent": -2.0},
    "gain_mismatch": {"ratio": 1.05},
    "saturation": {"k_percent": 2.0},
}
"""Effects on all three signals, larger than on any bench: what acts ahead of them passes through their slopes."""
CHAINS = {
    "alone": Chain(),
    "behind others": Chain(values=OTHERS, sensor_sense=-1, output_sense=-1),
    "misplaced magnet": Chain(values=OTHERS, sensor_sense=-1, output_sense=1, magnet=MISPLACED),
}


@dataclass(frozen=True)
class Case:
    """One parameter of one effect in one chain."""

    chain: str
    free: Free

    def __str__(self) -> str:
        return f"{self.free.key}.{self.free.name}-{self.chain}".replace(" ", "_")


def example(effect: Effect) -> dict[str, Any]:
    """Parameters of an effect that is present, where it has slopes."""
    if effect.roles("per turn"):
        return {effect.roles("per turn")[0]: np.linspace(-0.2, 0.3, TURNS)}
    # Edges have slopes where noise blurs them.
    blur = {"blur_percent": 0.1} if "blur_percent" in effect.params else {}
    # What no plain example sets: both displaced, and tilted.
    free = [name for name, param in effect.params.items() if param.prior_sd or name == "product_mm2"]
    held = {name: effect.params[name].null + 0.4 * effect.params[name].typical for name in free}
    return {**effect.null(), **EXAMPLES[effect.name].params, **held, **blur}


def parameters(effect: Effect) -> list[Free]:
    """What a fit may move of an effect; of the zeros of the turns, one."""
    free = free_of(effect, effect.name, turns=TURNS, channels=True)
    return [one for one in free if one.turn in (None, 3)]


CASES = [Case(chain, one) for chain in CHAINS for effect in CATALOGUE for one in parameters(effect)]


def linear(chain: Chain) -> Linear:
    return Linear(chain, MOTION, blur=0.0, observables=2, slopes=True)


def observed(chain: Chain, motion: Motion = MOTION) -> Array:
    """Angle and log of the channels' amplitude (2, n), as the chain alone has them."""
    shaft = chain.shaft(motion)
    x, y = chain.channels(shaft)
    return np.stack([chain.readings(shaft), np.log(np.hypot(x, y))])


def moved(chain: Chain, free: Free, step: float) -> Chain:
    """The chain with one parameter moved by a step in its own unit."""
    value = np.array(chain.values[free.key][free.name], dtype=np.float64)
    if free.turn is None:
        value = value + step
    else:
        value[free.turn] += step
    found: Any = value if value.ndim else float(value)
    return chain.with_values({free.key: {**chain.values[free.key], free.name: found}})


def step_of(effect: Effect, name: str, value: float) -> float:
    """The step at which a central difference is taken: that of the one-sided difference under test."""
    if effect.line is not None and name == effect.line.param:
        return 1e-7 * max(abs(value), 1.0)
    return 1e-4 * effect.params[name].typical


def neglected(chain: Chain) -> float:
    """Slope of the reference's error: by so much of itself a shaft that stands back for it stands back once more."""
    beside = replace(MOTION, shaft_rad=MOTION.shaft_rad + INNER_STEP)
    return float(np.max(np.abs(chain.reference(beside) - chain.reference(MOTION) - INNER_STEP))) / INNER_STEP


@pytest.mark.parametrize("case", CASES, ids=str)
def test_derivative(case: Case) -> None:
    """One-sided in the parameter, exact behind it: off by what the two one-sided differences are apart, at most."""
    free = case.free
    effect = find(free.key)
    chain = CHAINS[case.chain].with_effect(free.key, **example(effect))
    (derivative,) = linear(chain).derivatives(free.key, effect, [(free.name, free.turn)])
    step = step_of(effect, free.name, float(np.ravel(chain.values[free.key][free.name])[free.turn or 0]))
    up, here, down = (observed(moved(chain, free, way * step)) for way in (1.0, 0.0, -1.0))
    central = wrap(up - down) / (2.0 * step)
    truncation = np.abs(wrap(up - here) - wrap(here - down)) / step
    rounding = 4.0 * EPS * float(np.max(np.abs(here))) / step
    behind = 2.0 * INNER_STEP + (neglected(chain) if effect.acts_on == "reference" else 0.0)
    allowed = truncation + rounding + behind * float(np.max(np.abs(central)))
    assert np.max(np.abs(derivative)) > 10.0 * rounding
    assert np.all(np.abs(derivative - central) <= allowed)


EDGES = {"adc_inl": 0.01 * STEP_PERCENT / BLUR}
"""Widths of an edge in one unit of a strength."""
SEARCHED = [effect for effect in CATALOGUE if effect.footprint == "mean" and not effect.baseline]


@pytest.mark.parametrize("effect", SEARCHED, ids=lambda effect: effect.name)
@pytest.mark.parametrize("chain", CHAINS)
def test_columns_of_a_candidate_at_null(chain: str, effect: Effect) -> None:
    """A strength's column is a derivative; a level's, and a turn's zero, is the whole change, to first order."""
    base = CHAINS[chain].without(effect.name)
    point = linear(base)
    shapes = {**effect.null(), **EXAMPLES[effect.name].shapes}
    values = {**shapes, **{name: EXAMPLES[effect.name].params.get(name, 0.0) for name in effect.roles("level")}}
    # Beside a strength a search leaves levels at null.
    names = {*effect.roles("shape"), *(effect.roles("level") if effect.whole else ())}
    columns = point.columns(effect, [{name: float(values[name]) for name in names}])[0]
    for column, term in zip(columns, point.terms(effect), strict=True):
        param = effect.params[term.param]
        if param.role == "strength":
            step = 1e-3 * param.typical
            # An amplitude has one side: what is even in it, as a single displacement squared, shows there alone.
            below = 0.0 if param.lower == 0.0 else -step
            at = {name: values[name] for name in names} | dict.fromkeys(effect.roles("phase"), term.phase_deg)
            up, down = (observed(present(base, effect, {**at, term.param: param.null + to})) for to in (step, below))
            change, size = wrap(up - down) / (step - below), 1.0 / step
        else:
            whole = {name: values[name] for name in names}
            if term.turn is not None:
                whole = {term.param: 1.0 * (np.arange(TURNS) == term.turn)}
            elif effect.roles("phase"):
                whole |= {effect.roles("phase")[0]: effect.null()[effect.roles("phase")[0]]}
            change, size = wrap(observed(present(base, effect, whole)) - observed(base)), 1.0
        # The next order: the square of the angle that it turns by, which within one of several periods is so many times
        # as large.
        second = 2.0 * values.get("periods", 1.0) * float(np.max(np.abs(change)) / size) ** 2 * size
        # And the edge of a bit, which an error of its weight moves by so much of the edge's own width.
        second += EDGES.get(effect.name, 0.0) / size * float(np.max(np.abs(change)))
        rounding = 4.0 * EPS * float(np.max(np.abs(observed(base)))) * size
        assert np.max(np.abs(column)) > 10.0 * rounding
        behind = 2.0 * INNER_STEP * float(np.max(np.abs(change)))
        np.testing.assert_allclose(column, change, rtol=0.0, atol=second + rounding + behind)


def present(chain: Chain, effect: Effect, values: dict[str, Any]) -> Chain:
    """The chain with the effect, unchecked: an amplitude's derivative needs both its signs."""
    return chain.with_values({effect.name: {**effect.null(), **values}})
