"""One source: lines that were found one by one are put under the name of the motor that makes them together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.search.likelihood_ratio import likelihood
from diagnosis.discovery.stages.one_source import one_source
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.catalogue import base_name
from twin.magnet.motor_poles import balanced, unite


@dataclass(frozen=True, kw_only=True)
class Case:
    """Orders of 0.2 deg each that are in the readings, and those that become lines of one motor."""

    orders: tuple[int, ...]
    of_motor: tuple[int, ...] = ()


CASES = {
    "slots, poles and their doubles": Case(orders=(12, 14, 24, 28), of_motor=(12, 14, 24, 28)),
    "one of the doubles": Case(orders=(9, 8, 16), of_motor=(8, 9, 16)),
    "low orders": Case(orders=(6, 4, 8), of_motor=(4, 6, 8)),
    "slots and poles that nothing else sets": Case(orders=(10, 12), of_motor=(10, 12)),
    "two orders of a magnet": Case(orders=(4, 6)),
    "one line": Case(orders=(12,)),
    "a motor's line and its double": Case(orders=(24, 48)),
    "poles without slots": Case(orders=(14, 28)),
}


def handed(case: Case) -> State:
    """The state after a search that has found these lines."""
    state = before(stepwise, Made(points=256))
    shaft = state.fit.observations.motion.shaft_rad
    waves = sum(np.radians(0.2) * np.sin(order * shaft + order) for order in case.orders)
    return stepwise(with_residual(state, noise(len(state.sweep)) + np.asarray(waves)))


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_the_lines_of_a_motor_are_one_cause_and_others_stay(case: Case) -> None:
    found = handed(case)
    united = one_source(found)
    own = [united.fit.chain.values[key] for key in united.keys if base_name(key) == "motor_poles"]
    assert sorted(int(values["order"]) for values in own) == sorted(case.of_motor)
    assert (united is found) == (not case.of_motor)
    assert all(values["amplitude_deg"] == pytest.approx(0.2, abs=0.02) for values in own)
    # An order that a fit left free is now whole: by chance that loses less than three sigma a line.
    assert likelihood(found.fit) - likelihood(united.fit) < 4.5 * len(case.orders)
    assert one_source(united) is united


def test_a_motor_is_one_that_can_be_wound_and_makes_most_of_the_lines() -> None:
    assert unite([12, 14, 24, 28])[0] == {"slots": 12.0, "poles": 14.0}
    assert [balanced(*motor) for motor in ((12, 14), (12, 16), (9, 8), (9, 6), (12, 12), (9, 9), (10, 8))] == [
        *(True, True, True, True, False, False, False)
    ]
    # All of them multiples of one order, which may as well be that of a sensor's periods: a fourth line is asked for.
    assert unite([4, 12, 24]) == []
    assert unite([4, 8, 12, 24])[0] == {"slots": 12.0, "poles": 4.0}


def test_the_answer_names_the_motor_once_with_its_lines() -> None:
    shaft = np.arange(0.0, 360.0, 360.0 / 256)
    rng = np.random.default_rng(3)
    lines = sum(size * np.sin(np.radians(order * shaft + order)) for order, size in ((12, 0.3), (14, 0.3), (28, 0.1)))
    answer = explain({"reference_deg": shaft, "measured_deg": shaft + lines + rng.normal(0.0, 0.03, 256)}).to_dict()
    (cause,) = answer["causes"]
    assert cause["name"] == "motor_poles"
    told = {name: cause["parameters"][name]["value"] for name in ("slots", "poles")}
    assert told == {"slots": 12.0, "poles": 14.0}
    assert {cause["parameters"][name]["value"] for name in ("order", "order_2", "order_3")} == {12.0, 14.0, 28.0}
