"""Series of lines: the seventh multiple of order 5 / 7, as of a belt, is order 5; a magnet's line of order 5 is not."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.stages.one_source import one_source
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.catalogue import base_name

FIRST = 5.0 / 7.0


def handed(multiples: tuple[int, ...], last_deg: float, first: float = FIRST) -> State:
    """The state after a search in a series that falls from 0.2 deg, and a line of order 5 of so many degrees."""
    state = before(stepwise, Made(points=120, turns=14))
    shaft = state.fit.observations.motion.shaft_rad
    lines = [(first * k, 0.2 * 0.75 ** (k - 1)) for k in multiples] + [(5.0, last_deg)]
    waves = sum(np.radians(size) * np.sin(order * shaft + order) for order, size in lines)
    return stepwise(with_residual(state, noise(len(state.sweep)) + np.asarray(waves)))


def magnets(state: State) -> int:
    return [base_name(key) for key in state.keys].count("magnet_harmonic")


def test_the_next_multiple_is_of_the_series() -> None:
    found = handed((1, 2, 3, 4, 5, 6), 0.03)
    assert magnets(found) == 1
    united = one_source(found)
    assert magnets(united) == 0
    orders = sorted(united.fit.chain.values[key]["order"] for key in united.keys)
    # Of 14 turns with 120 readings each the orders are told to a thousandth.
    assert orders == pytest.approx([FIRST * k for k in range(1, 8)], abs=0.005)
    assert one_source(united) is united


@pytest.mark.parametrize(
    ("multiples", "last_deg", "first"),
    [
        ((1, 2, 3, 4, 5, 6), 0.2, FIRST),
        ((1, 2, 3, 4, 5), 0.03, FIRST),
        ((1, 2), 0.03, 5.0 / 3.0),
        ((1, 3, 4, 5, 6), 0.03, FIRST),
    ],
    ids=["larger than the last", "not the next", "two lines", "not one after the other"],
)
def test_others_stay(multiples: tuple[int, ...], last_deg: float, first: float) -> None:
    found = handed(multiples, last_deg, first)
    assert magnets(found) == 1
    assert one_source(found) is found
