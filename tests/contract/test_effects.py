"""Every effect of the catalogue keeps the same promises: one table of examples drives every test."""

from __future__ import annotations

import numpy as np
import pytest

from tests.contract.examples import EXAMPLES, Example
from twin.angles import Array, wrap
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.contract import PROMISES, ROUNDING_RAD, Promise, check
from twin.effect import Effect
from twin.example import full_motion

MOTION = full_motion()

each_effect = pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.name)


def example(effect: Effect) -> Example:
    return EXAMPLES[effect.name]


def error(effect: Effect, **params: object) -> Array:
    return Chain().with_effect(effect.name, **params).error(MOTION)


def test_the_table_is_complete() -> None:
    assert set(EXAMPLES) == {effect.name for effect in CATALOGUE}


@each_effect
def test_says_where_it_comes_from(effect: Effect) -> None:
    declared, *_ = check(effect, example=example(effect), motion=MOTION)
    assert declared.kept, declared.said


@pytest.mark.parametrize(
    ("effect", "promise"),
    [(e, p) for p in PROMISES for e in CATALOGUE if not p.unasked(e, EXAMPLES[e.name])],
    ids=lambda case: case.name.replace(" ", "_").replace(",", ""),
)
def test_keeps_its_promises(effect: Effect, promise: Promise) -> None:
    assert promise.broken(effect, example(effect), MOTION) == ""


@each_effect
def test_keeps_them_on_an_example_made_from_its_declaration(effect: Effect) -> None:
    """So an effect of the user's own, for which there is no table, is not refused for the example it is given."""
    assert [result for result in check(effect, motion=MOTION) if result.kept is False] == []


# The others leave their mark on the spread, the values or single readings: see test_footprints.
@pytest.mark.parametrize("effect", [e for e in CATALOGUE if EXAMPLES[e.name].signature], ids=lambda effect: effect.name)
def test_leading_signature(effect: Effect) -> None:
    """What the signature leaves over falls at least twice as fast as the effect itself when the amplitude halves."""
    case = example(effect)
    assert case.signature is not None
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
