"""Rival fits: what explains the readings as well, from wherever an angle leaves its shape open."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from diagnosis import explain
from diagnosis.discovery.search.every_start import likeliest
from diagnosis.discovery.search.likelihood_ratio import likelihood
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.rival_fits import rival_fits
from diagnosis.discovery.state import State
from diagnosis.explanation import Explanation
from scenarios.commands.protocol import Protocol
from tests.diagnosis.discovery.sweeps import Made, before
from twin.catalogue import find
from twin.presets import read_preset

MISPLACED, HARMONIC = "magnet_misalignment", "magnet_harmonic"
TRUE = {"Vx_over_Ax": 0.00392, "Vy_over_Ay": 0.00109, "gain_ratio": 1.00137, "beta_deg": 0.1}
"""Factors of the preset hall-misaligned with sensor and magnet on the axis, from its channels without noise: what its
tilts and its stray field do is among them."""


@functools.cache
def misaligned() -> Explanation:
    """The preset with a displaced magnet, from one turn of the angle alone."""
    motion = replace(Protocol(), points=1440, channels=False).motion()
    return explain(read_preset("hall-misaligned").simulate(motion, seed=5))


@functools.cache
def chipped() -> State:
    """A magnet's order 3 in an angle alone, ahead of the stage."""
    return before(rival_fits, Made(causes=((HARMONIC, 0.1),), points=120, seed=CHIPPED))


CHIPPED = 13
"""A seed whose harmonic is of order 3."""


def test_a_displaced_magnet_is_in_the_class_of_the_order_that_it_makes() -> None:
    (cause,) = misaligned().causes
    assert cause.name == HARMONIC
    assert cause.indistinguishable_from == (MISPLACED, "mechanics")
    assert "record vx and vy" in cause.to_tell_apart


def test_the_factors_intervals_hold_what_the_class_leaves_open() -> None:
    answer = misaligned().to_dict()
    sense = answer["senses"]["sensor"]
    for key, true in TRUE.items():
        told = answer["extended"]["parameters"][key]
        value = sense * true if key in ("Vy_over_Ay", "beta_deg") else true
        assert told["low"] <= value <= told["high"], key
        assert told["open_by"] == [MISPLACED]
        low, high = told["as_named"]
        assert told["low"] <= low <= high <= told["high"]
    # As the harmonic leaves them, two of them are beyond doubt something else.
    named = answer["extended"]["parameters"]["beta_deg"]["as_named"]
    assert not named[0] <= sense * TRUE["beta_deg"] <= named[1]


def test_every_fit_is_as_good_and_its_open_shape_is_held_somewhere_else() -> None:
    state = chipped()
    (cause,) = state.causes
    found = rival_fits(state).rival_fits
    assert {name for name, _ in found} == set(cause.rivals) == {MISPLACED}
    least = likelihood(cause.rivals[MISPLACED]) - 0.5 * DiscoverySettings().sigma_apart ** 2
    directions = set()
    for _, fit in found[1:]:
        assert likelihood(fit) > least
        assert "direction_deg" not in {one.name for one in fit.free}
        directions.add(fit.chain.values[MISPLACED]["direction_deg"])
    assert len(directions) == len(found) - 1 > 1


def test_of_what_the_sweep_shows_by_itself_there_is_the_one_fit() -> None:
    state = before(rival_fits, Made(causes=(("saturation", 0.08),), points=96))
    (cause,) = state.causes
    assert dict(rival_fits(state).rival_fits) == dict(cause.rivals)


def test_what_is_known_before_a_sweep_is_at_its_most_likely() -> None:
    shapes = likeliest(find(MISPLACED), chipped().fit.linear.motion)
    assert {shape["log_ratio"] for shape in shapes} == {0.0}
    assert np.ptp([shape["direction_deg"] for shape in shapes]) == 150.0
