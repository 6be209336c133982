"""Details: freed from their nulls where the readings call for them, put back where they do not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from diagnosis.discovery.fitting.free_parameters import Free
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.search import freed
from diagnosis.discovery.search.details import detailed
from diagnosis.discovery.search.likelihood_ratio import refit
from diagnosis.discovery.stages.stepwise import stepwise
from tests.diagnosis.discovery.searches import with_cause
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.catalogue import find
from twin.chain import Chain

BACK = Made(points=180, bits=30, back=True)
SHARE = Free("hysteresis", "on_axes")
LEVEL = -10.0


def held(share: float) -> Fit:
    """A fit that holds a hysteresis of 0.1 deg, of which this share is the axes' own."""
    state = before(stepwise, BACK)
    chain = state.fit.chain.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0, on_axes=share)
    shape = chain.readings(state.fit.observations.motion) - state.fit.linear.angle
    state = with_residual(state, shape + noise(len(state.sweep)))
    return with_cause(state, "hysteresis", lag_deg=0.1, memory_deg=8.0).fit


def test_a_detail_that_pays_is_free() -> None:
    found = detailed(held(1.0), ["hysteresis"], LEVEL)
    assert SHARE in found.free
    assert found.chain.values["hysteresis"]["on_axes"] > 0.8


@pytest.mark.parametrize("freed", [False, True])
def test_a_detail_that_says_nothing_goes_back_to_its_null(freed: bool) -> None:
    fit = held(0.0)
    if freed:
        chain = fit.chain.with_effect("hysteresis", on_axes=0.3)
        fit = refit(chain, (*fit.free, SHARE), fit)
    found = detailed(fit, ["hysteresis"], LEVEL)
    assert SHARE not in found.free
    assert found.chain.values["hysteresis"]["on_axes"] == 0.0


@pytest.mark.parametrize(("share", "fitted"), [(0.9, True), (1.1, False)])
def test_only_a_detail_that_promises_a_share_of_the_level_is_fitted(
    share: float, fitted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of what it has to reach, to first order: an exact fit gains up to three times that."""
    fit = held(0.0)
    wide = evaluate(fit.chain, (*fit.free, SHARE), fit.observations, fit.weighting)
    first = freed._log_p(freed._first_order(wide), fit)
    asked: list[Sequence[Free]] = []

    def recorded(chain: Chain, free: Sequence[Free], like: Fit) -> Fit:
        asked.append(free)
        return like

    monkeypatch.setattr(freed, "refit", recorded)
    freed.with_detail(fit, SHARE, share * first / fit.settings.rival_share)
    assert bool(asked) == fitted


def test_a_detail_stays_at_its_null_where_another_cause_does_it() -> None:
    """Lags of the axes make some of a saturation's order 4: without it the detail pays, and hides it."""
    state = before(stepwise, BACK)
    chain = state.fit.chain.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0)
    chain = chain.with_effect("saturation", k_percent=0.4)
    shape = chain.readings(state.fit.observations.motion) - state.fit.linear.angle
    fit = with_cause(
        with_residual(state, shape + noise(len(state.sweep))), "hysteresis", lag_deg=0.1, memory_deg=8.0
    ).fit
    assert SHARE in detailed(fit, ["hysteresis"], LEVEL).free
    assert SHARE not in detailed(fit, ["hysteresis"], LEVEL, [find("saturation")]).free
    # Where the axes do lag, no saturation says it better.
    assert SHARE in detailed(held(1.0), ["hysteresis"], LEVEL, [find("saturation")]).free


def test_a_cause_without_details_is_left_alone() -> None:
    fit = with_cause(before(stepwise, BACK), "saturation", k_percent=0.2).fit
    assert find("saturation").details(fit.observations.motion.provides) == ()
    assert detailed(fit, ["saturation"], LEVEL) is fit
    assert np.all(np.isfinite(fit.residual))


def test_a_detail_that_the_channels_tell_is_left_alone_in_angles() -> None:
    """A radius alters an angle by its product with other errors alone: what fits there tells of nothing."""
    harmonic = find("magnet_harmonic")
    assert harmonic.details(frozenset({"vx", "vy"})) == ("radius_ratio",)
    assert harmonic.details(frozenset({"one turn"})) == ()
