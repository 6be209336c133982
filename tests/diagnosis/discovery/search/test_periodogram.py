"""The orders that a line is looked for at: which of them a record of so many turns can tell from one another."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.fitting.initial_fit import unfitted
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.search.likelihood_ratio import settle
from diagnosis.discovery.search.periodogram import line_shapes
from diagnosis.discovery.search.screening import Base, matched
from diagnosis.discovery.stages.stepwise import stepwise
from tests.diagnosis.discovery.sweeps import Made, before
from twin.catalogue import find

POINTS = 72


@pytest.mark.parametrize(("turns", "halves"), [(1.0, False), (1.7, False), (1.9, True), (3.4, True)])
def test_below_two_turns_whole_orders_alone_are_tried(turns: float, halves: bool) -> None:
    """Two turns are told from a half order more (Rayleigh), also where the last angle is not measured twice."""
    state = before(stepwise, Made(points=POINTS, turns=4))
    sweep = state.sweep.part(np.arange(round(POINTS * turns)))
    fit = settle(unfitted(collect(sweep), state.fit.chain, state.settings))[0]
    effect = find("unnamed_order")
    assert effect.line is not None
    shapes, _ = line_shapes(matched(Base.of(fit)), fit, effect)
    orders = np.array([shape[effect.line.param] for shape in shapes])
    assert orders.size
    assert np.any(orders != np.round(orders)) == halves
