"""Parts: a sensor of several periods is named by the lines of its offset and of its gain and phase together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis.discovery.search.exchange import Search, improve
from diagnosis.discovery.search.likelihood_ratio import settle
from diagnosis.discovery.search.parts import lacks_a_part
from diagnosis.discovery.search.screening import Base, screen_one
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.searches import with_cause
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.catalogue import find


def with_lines(orders: tuple[int, ...]) -> State:
    """Readings that hold these orders, of 0.1 deg each."""
    state = before(stepwise, Made(points=180, turns=2))
    shaft = state.fit.observations.motion.shaft_rad
    waves = sum(np.radians(0.1) * np.sin(order * shaft + order) for order in orders)
    return with_residual(state, noise(len(state.sweep)) + np.asarray(waves))


@dataclass(frozen=True, kw_only=True)
class Case:
    """Orders in the readings, and the names that the search ends with."""

    orders: tuple[int, ...]
    named: tuple[str, ...]


CASES = {
    "both lines": Case(orders=(5, 10), named=("multipole",)),
    "the first alone": Case(orders=(5,), named=("magnet_harmonic",)),
    "the second alone": Case(orders=(6,), named=("magnet_harmonic",)),
    "no multiples": Case(orders=(5, 8), named=("magnet_harmonic", "magnet_harmonic#2")),
    "as of a motor": Case(orders=(24, 48), named=("drive_ripple", "drive_ripple#2")),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_sensor_of_several_periods_is_named_by_both_of_its_lines(case: Case) -> None:
    assert tuple(sorted(stepwise(with_lines(case.orders)).keys)) == case.named


def test_a_screening_passes_over_periods_of_which_only_one_line_shows() -> None:
    one, both = (Base.of(settle(with_lines(orders).fit)[0]) for orders in ((5,), (5, 10)))
    assert screen_one(one, find("multipole")) is None
    found = screen_one(both, find("multipole"))
    assert found is not None
    assert found.values["periods"] == 5.0


def test_one_that_was_taken_before_the_rest_was_known_gives_way() -> None:
    state = with_cause(with_lines((6, 7)), "multipole", periods=3.0)
    state = with_cause(state, "magnet_harmonic", order=7.0)
    level = state.settings.footprint_log_p
    assert lacks_a_part(state.fit, "multipole", level)
    # Nothing stands ready to take its place.
    search = Search.among(state.searched, state.fit).with_contenders({"multipole": ()})
    _, held, _ = improve(state.fit, state.keys, search)
    assert "multipole" not in held
