"""Every effect of the catalogue keeps the same promises: one table of examples drives every test."""

from __future__ import annotations

import numpy as np
import pytest

from tests.contract.examples import EXAMPLES, Example
from tests.contract.motions import full_motion, permuted
from twin.angles import Array, wrap
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.effect import Effect

MOTION = full_motion()
ROUNDING_RAD = 1e-12
"""Angles of up to 4 pi and channels of size 1 carry some 1e-15; a few operations and the arctangent add to it."""

each_effect = pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.name)


def example(effect: Effect) -> Example:
    return EXAMPLES[effect.name]


def signal_for(effect: Effect) -> Array:
    """A signal of the kind that the effect acts on, with the parts that differ from channel to channel."""
    angle = np.stack([MOTION.shaft_rad, MOTION.shaft_rad + 0.01])
    if effect.acts_on in ("shaft", "field"):
        return angle
    if effect.acts_on == "channels":
        return np.stack([np.cos(angle[0]), np.sin(angle[1])])
    return MOTION.shaft_rad[None]


def error(effect: Effect, **params: object) -> Array:
    return Chain().with_effect(effect.name, **params).error(MOTION)


def test_the_table_is_complete() -> None:
    assert set(EXAMPLES) == {effect.name for effect in CATALOGUE}


@each_effect
def test_says_where_it_comes_from(effect: Effect) -> None:
    assert len(effect.source) > 10
    assert effect.signature
    assert all(param.doc for param in effect.params.values())


@each_effect
def test_vanishes_exactly_at_null(effect: Effect) -> None:
    signal = signal_for(effect)
    values = {**effect.null(), **example(effect).shapes}
    for rng in (None, np.random.default_rng(1)):
        np.testing.assert_array_equal(effect.forward(signal, MOTION, values, rng), signal)
    chain = Chain().with_effect(effect.name, **values)
    np.testing.assert_array_equal(chain.readings(MOTION), Chain().readings(MOTION))
    assert np.max(np.abs(wrap(chain.readings(MOTION) - MOTION.shaft_rad))) < ROUNDING_RAD


@each_effect
def test_keeps_shape_stays_finite_and_repeats(effect: Effect) -> None:
    signal = signal_for(effect)
    kept = signal.copy()
    values = {**effect.null(), **example(effect).params}
    first, second = (effect.forward(signal, MOTION, values, np.random.default_rng(5)) for _ in range(2))
    assert first.shape == signal.shape
    assert np.isfinite(first).all()
    assert first.tobytes() == second.tobytes()
    np.testing.assert_array_equal(signal, kept)
    assert not np.array_equal(first, signal)


@each_effect
def test_same_seed_same_sweep(effect: Effect) -> None:
    chain = Chain().with_effect(effect.name, **example(effect).params)
    one, two, other = (chain.simulate(MOTION, seed=seed) for seed in (3, 3, 4))
    for name, values in one.columns.items():
        assert values.tobytes() == two.columns[name].tobytes()
    same = all(np.array_equal(values, other.columns[name]) for name, values in one.columns.items())
    # The converter's rounding is the one "random" role that draws no numbers.
    assert same == (not effect.roles("random") or effect.name == "adc_quantisation")


@each_effect
def test_batch_equals_loop(effect: Effect) -> None:
    if not [name for name in example(effect).strengths if effect.params[name].role in ("strength", "level")]:
        pytest.skip("acts only where a generator is given")
    factors = (1.0, 0.5, 0.25)
    members = [example(effect).scaled(factor, effect.null()) for factor in factors]
    for name, param in effect.params.items():
        if param.counts and name in example(effect).strengths:
            members = [{**member, name: round(member[name]) + 1.0} for member in members]
    batch = {name: np.array([member[name] for member in members]) for name in example(effect).strengths}
    together = error(effect, **{**example(effect).shapes, **batch})
    alone = np.stack([error(effect, **member) for member in members])
    np.testing.assert_allclose(together, alone, rtol=0.0, atol=ROUNDING_RAD)


@each_effect
def test_leading_signature(effect: Effect) -> None:
    """What the signature leaves over falls at least twice as fast as the effect itself when the amplitude halves."""
    case = example(effect)
    if case.signature is None:
        pytest.skip("leaves its mark on the spread, the values or single readings: see test_footprints")
    left, size = [], []
    for factor in (1.0, 0.5):
        params = {**effect.null(), **case.scaled(factor, effect.null())}
        expected = case.signature(MOTION, params)
        # Within the kinks' share a reading may stand on the other side of an edge.
        left.append(np.quantile(np.abs(wrap(error(effect, **params) - expected)), 1.0 - case.kinks))
        size.append(np.max(np.abs(expected)))
    assert size[0] / size[1] == pytest.approx(2.0**case.power, rel=0.15)
    assert left[0] < 0.05 * size[0]
    # A remainder of the next order is halved once more than the effect; 0.6 allows for the order after that.
    assert left[1] < max(0.6 * 0.5**case.power * left[0], ROUNDING_RAD)


@each_effect
def test_pointwise_effects_commute_with_permuting_the_readings(effect: Effect) -> None:
    case = example(effect)
    if case.memory or not [name for name in case.strengths if effect.params[name].role in ("strength", "level")]:
        pytest.skip("needs the order of the readings, or a generator")
    # The first and the last reading keep their places: they set the clock's zero and the record's middle.
    order = np.arange(len(MOTION))
    order[1:-1] = np.random.default_rng(2).permutation(order[1:-1])
    chain = Chain().with_effect(effect.name, **case.params)
    shuffled = chain.error(permuted(MOTION, order))
    np.testing.assert_allclose(shuffled, chain.error(MOTION)[order], rtol=0.0, atol=ROUNDING_RAD)


@each_effect
def test_refuses_what_is_out_of_range(effect: Effect) -> None:
    for name, param in effect.params.items():
        for wrong in (param.upper + 1.0 + abs(param.upper), float("nan")):
            with pytest.raises(ValueError, match=rf"{effect.name}.{name} must lie between"):
                Chain().with_effect(effect.name, **{name: wrong})
