"""What is looked for on every device."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.population.candidates import HIGHEST_ORDER, candidates_for, columns_of, factor_columns, overlaps
from twin.chain import Chain
from twin.motion import Motion

THERE = np.radians(np.arange(0.0, 360.0, 1.0))
BOTH, ONE_WAY = (Motion.from_angle(rad) for rad in (np.concatenate([THERE, THERE[::-1]]), np.arange(720) * 0.0175))
CHAIN = Chain(
    values={
        "offset": {"x_percent": 0.5, "y_percent": -0.3},
        "gain_mismatch": {"ratio": 1.01},
        "phase": {"beta_deg": 0.2},
        "quadratic_nonlinearity": {"q_percent": 0.1},
        "zero": {"zero_deg": 50.0},
    }
)


def test_columns_are_those_of_the_linearised_chain() -> None:
    """Lines at a hundred orders come of one of them; every candidate's columns are the chain's own."""
    candidates = candidates_for(BOTH, CHAIN)
    linear = Linear(CHAIN, BOTH, blur=0.0, observables=1)
    for one, columns in zip(candidates, columns_of(linear, candidates), strict=True):
        wanted = linear.columns(one.declared, [one.values])[0, :, 0]
        assert columns.shape == (one.terms, len(BOTH))
        np.testing.assert_allclose(columns, wanted, atol=1e-8 * np.abs(wanted).max())


def test_every_order_is_asked_for_once() -> None:
    """Of a line that several causes make, one is asked and the others are named beside it."""
    candidates = candidates_for(BOTH, CHAIN)
    lines = [one for one in candidates if one.order is not None]
    orders = sorted(one.order or 0.0 for one in lines)
    # The factors take orders 1 and 2.
    assert orders == list(range(3, HIGHEST_ORDER + 1))
    assert all("unnamed_order" in (one.effect, *one.same) or one.order < 9 for one in lines if one.order is not None)
    assert {one.effect for one in candidates} >= {"backlash", "saturation"}


def test_what_a_motion_does_not_show_is_not_asked() -> None:
    names = {one.effect for one in candidates_for(ONE_WAY, CHAIN)}
    assert not names & {"backlash", "hysteresis", "zero_drift", "offset_drift"}
    assert "saturation" in names


def test_overlaps_are_cosines_beyond_the_factors() -> None:
    candidates = candidates_for(BOTH, CHAIN)
    found = overlaps(BOTH, CHAIN, candidates, ())
    np.testing.assert_allclose(found, found.T, atol=1e-9)
    assert found.max() <= 1.0 + 1e-9
    linear = Linear(CHAIN, BOTH, blur=0.0, observables=1)
    along = factor_columns(linear)
    alone = [k for k, one in enumerate(candidates) if one.terms == 1][:2]
    left = []
    for columns in columns_of(linear, [candidates[k] for k in alone]):
        solved, *_ = np.linalg.lstsq(along.T, columns[0], rcond=None)
        left.append(columns[0] - solved @ along)
    cosine = abs(left[0] @ left[1]) / np.linalg.norm(left[0]) / np.linalg.norm(left[1])
    assert found[alone[0], alone[1]] == pytest.approx(cosine, abs=1e-6)
