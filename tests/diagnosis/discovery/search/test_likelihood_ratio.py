"""What an effect has to gain beyond the others, and what a likelihood ratio of restricted fits is worth."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import f as f_distribution

from diagnosis.discovery.fitting.free_parameters import free_of
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.search.likelihood_ratio import degrees, doubt_beside, handicap, judged_p, likelihood
from diagnosis.discovery.search.screening import Base, by_chance
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


INL = find("adc_inl")


def with_weights(wider: float) -> Fit:
    """The clean fit with a converter's weights free, none of them off, which may be off by so many times as much."""
    fit = clean().fit
    params = {
        name: replace(param, prior_sd=wider * param.prior_sd) if name in INL.drawn else param
        for name, param in INL.params.items()
    }
    effects = tuple(replace(e, params=params) if e is INL else e for e in fit.chain.effects)
    chain = replace(fit.chain, effects=effects).with_values({"adc_inl": INL.null()})
    free = (*fit.free, *free_of(INL, "adc_inl", turns=1, channels=False))
    return evaluate(chain, free, fit.observations, fit.weighting)


def known_share(fit: Fit) -> float:
    """Sum over the weights of the variance that is left against that before the sweep (the trace of a Gaussian)."""
    drawn = [place for place, one in enumerate(fit.free) if one.name in INL.drawn]
    _, jacobian = fit.whitened()
    rows = jacobian[drawn]
    return float(np.trace(np.linalg.inv(rows @ rows.T) * fit.strengths[drawn][:, None] ** 2))


def test_a_converters_weights_pay_for_the_room_that_they_have() -> None:
    """Integrated out, each costs the log of its prior over its posterior deviation: e times the room costs a nat.

    One that the readings hardly tell costs less, by the share of its variance that is left: between those shares with
    the narrow room and with the wide one, beside the other weights alone; the factors leave each a little more.
    """
    narrow, wide = with_weights(1.0), with_weights(float(np.e))
    cost = likelihood(narrow) - likelihood(wide)
    assert 6.0 - known_share(narrow) - 0.1 < cost < 6.0
    assert cost > 4.0
    assert (degrees(INL, 7), INL.drawn_of(7)) == (1, 6)


def test_to_first_order_draws_pay_half_the_log_of_their_evidence() -> None:
    base, gain = Base.of(clean().fit), np.array(200.0)
    plain = replace(INL, params={name: replace(param, prior_sd=0.0) for name, param in INL.params.items()})
    paid = 6.0 * (1.0 + np.log(200.0 / 6.0))
    # What is left is tested as the bow's, which is no draw.
    alone = by_chance(base, replace(plain, params={"bow_lsb": INL.params["bow_lsb"]}), gain - paid, 1, 25.0)
    assert by_chance(base, INL, gain, 7, 25.0) == pytest.approx(alone)
