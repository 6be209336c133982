"""What an effect has to gain beyond the others, and what a likelihood ratio of restricted fits is worth."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import f as f_distribution

from diagnosis.discovery.search.likelihood_ratio import degrees, doubt_beside, handicap, judged_p
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before
from twin.catalogue import find


@functools.cache
def clean() -> State:
    return before(stepwise, Made(points=120, turns=2, back=True, bits=30))


@pytest.mark.parametrize(
    ("name", "plain", "coarse"),
    [
        ("saturation", 0.0, 0.0),
        ("backlash", 0.0, 0.0),
        # Stairs alias to lines at any order, and to a slip or a memory somewhere among many places.
        ("magnet_harmonic", 0.0, 20.0),
        ("drive_ripple", 0.0, 20.0),
        ("index_slip", 0.0, 20.0),
        ("unnamed_order", 6.0, 26.0),
        ("unnamed_bump", 6.0, 26.0),
    ],
)
def test_what_an_effect_has_to_gain_beyond_others(name: str, plain: float, coarse: float) -> None:
    """400 to 1 without a name; and beside coarse stairs e^20 to 1 where these pass for it."""
    fit, effect = clean().fit, find(name)
    assert handicap(effect, fit) == pytest.approx(plain + effect.handicap)
    beside = replace(fit, weighting=replace(fit.weighting, coarse=True))
    assert handicap(effect, beside) == pytest.approx(coarse + effect.handicap)


@pytest.mark.parametrize(("shapes", "coarse"), [(12, 0.0), (20, 0.0), (21, 20.0), (38, 20.0)])
def test_among_many_places_stairs_pass_for_one(shapes: int, coarse: float) -> None:
    fit = clean().fit
    effect = replace(
        find("hysteresis"), shapes=lambda motion: [{"memory_deg": 1.0 + 0.1 * place} for place in range(shapes)]
    )
    beside = replace(fit, weighting=replace(fit.weighting, coarse=True))
    assert handicap(effect, beside) == pytest.approx(coarse + effect.handicap)


@pytest.mark.parametrize(
    ("keys", "member", "nats"),
    [
        ((), 0, 0.0),
        (("saturation",), 0, 0.0),
        (("saturation", "unnamed_bump#2"), 0, 6.0),
        (("unnamed_order",), 3, 0.0),
    ],
)
def test_what_a_cause_has_to_gain_beside_a_shape_without_a_name(
    keys: tuple[str, ...], member: int, nats: float
) -> None:
    """Which describes something only nearly; in coloured noise what it leaves is taken for that."""
    fit = clean().fit
    fit = replace(fit, weighting=replace(fit.weighting, member=member))
    assert doubt_beside(fit, keys) == pytest.approx(nats)


@pytest.mark.parametrize(("terms", "dof", "looks"), [(1, 50, 1.0), (2, 200, 30.0), (4, 30, 5.0)])
@pytest.mark.parametrize("gain", [2.0, 20.0, 60.0])
def test_the_probability_is_that_of_an_f_test_at_the_best_of_so_many_looks(
    gain: float, terms: int, dof: int, looks: float
) -> None:
    """A gain of -dof log(1 - R^2) by so many coefficients; R^2 as the F distribution has it."""
    explained = 1.0 - np.exp(-gain / dof)
    ratio = explained / terms / ((1.0 - explained) / (dof - terms))
    expected = np.log(f_distribution.sf(ratio, terms, dof - terms)) + np.log(looks)
    assert judged_p(gain, terms, dof, looks) == pytest.approx(float(expected), rel=1e-9)


def test_zeros_of_the_turns_cost_the_one_scatter_that_they_are_drawn_with() -> None:
    assert degrees(find("reference_rezero"), 7) == 1
    assert degrees(find("magnet_harmonic"), 2) == 2
