"""Falling lines: orders 3 and 6 are a sensor's of three periods, or a magnet's that has the orders between as well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from diagnosis.discovery.search.falling_lines import Lines, as_lines_of_a_body, falling_odds
from diagnosis.discovery.stages.one_source import one_source
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.catalogue import base_name
from twin.hall.multipole import with_periods
from twin.magnet.magnet_harmonic import MAGNET_HARMONIC

ORDERS = np.arange(3.0, 9.0)
DEVIATION = 0.002
CASES = {
    "falls from order to order": ((0.3, 0.2, 0.13, 0.09, 0.05, 0.03), True),
    "orders 3 to 6, no others": ((0.3, 0.15, 0.1, 0.1, 0.0, 0.002), True),
    "unevenly falling": ((0.2, 0.06, 0.1, 0.05, 0.001, 0.02), True),
    "nothing but 3 and 6": ((0.3, 0.002, 0.001, 0.1, 0.003, 0.0), False),
    "6 larger than 3": ((0.1, 0.002, 0.001, 0.3, 0.003, 0.0), False),
    "a small neighbour": ((0.3, 0.008, 0.001, 0.3, 0.003, 0.0), False),
}


@pytest.mark.parametrize(("sizes", "of_a_magnet"), CASES.values(), ids=CASES)
def test_which_lines_belong_together(sizes: tuple[float, ...], of_a_magnet: bool) -> None:
    lines = Lines(ORDERS, np.array(sizes), np.full(6, DEVIATION))
    assert (falling_odds(lines, (3, 6), 20.0) > 0.0) == of_a_magnet


def test_lines_that_are_not_told_decide_nothing() -> None:
    """Either description of them is as likely, but for how its levels are divided."""
    lines = Lines(ORDERS, np.full(6, 0.1), np.full(6, 1e4))
    assert falling_odds(lines, (3, 6), 20.0) == pytest.approx(0.0, abs=0.2)


def handed(orders: tuple[int, ...], size_deg: float = 0.2) -> State:
    """The state after a search that has found these lines."""
    state = before(stepwise, Made(points=240))
    shaft = state.fit.observations.motion.shaft_rad
    waves = sum(np.radians(size_deg) * np.sin(order * shaft + order) for order in orders)
    return stepwise(with_residual(state, noise(len(state.sweep)) + np.asarray(waves)))


def test_lines_with_others_between_them_are_a_magnets() -> None:
    found = handed((4, 5, 7, 8))
    assert "multipole" in {base_name(key) for key in found.keys}
    magnet = one_source(found)
    assert {base_name(key) for key in magnet.keys} == {"magnet_harmonic"}
    assert sorted(magnet.fit.chain.values[key]["order"] for key in magnet.keys) == [4.0, 5.0, 7.0, 8.0]
    assert one_source(magnet) is magnet
    known = replace(found.fit.chain, effects=with_periods(found.fit.chain.effects, 4, given=False))
    assert as_lines_of_a_body(replace(found.fit, chain=known), found.keys, MAGNET_HARMONIC) is None


def test_lines_alone_are_a_sensors() -> None:
    found = handed((4, 8))
    assert [base_name(key) for key in found.keys] == ["multipole"]
    assert one_source(found) is found


@pytest.mark.parametrize("size_deg", [0.03, 0.06, 0.1])
def test_orders_3_and_6_beside_the_quadratic_term_too(size_deg: float) -> None:
    """The quadratic term makes order 3 as well: how large a line of order 3 is only the usual size of the term says."""
    magnet = one_source(handed((3, 4, 5, 6), size_deg))
    assert {base_name(key) for key in magnet.keys} == {"magnet_harmonic"}


def test_lines_that_a_motor_would_make_are_a_magnets_that_has_those_between_them() -> None:
    """4, 6 and 8 are the lines of six slots and four poles; with 5 between them and falling they are of one body."""
    state = before(stepwise, Made(points=240))
    shaft = state.fit.observations.motion.shaft_rad
    sizes = {4: 0.2, 5: 0.12, 6: 0.07, 8: 0.03}
    waves = sum(np.radians(size) * np.sin(order * shaft + order) for order, size in sizes.items())
    found = stepwise(with_residual(state, noise(len(state.sweep)) + np.asarray(waves)))
    assert {base_name(key) for key in one_source(found).keys} == {"magnet_harmonic"}
