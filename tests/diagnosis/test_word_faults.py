"""Faults of the link in the answer: named, taken off the readings ahead of the fit, and part of the extended twin."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.explanation import Explanation
from tests.hidden.link_faults import Drawn, draw
from twin.decoded import decoded


def answered(drawn: Drawn) -> Explanation:
    found = explain(drawn.columns)
    assert [cause.name for cause in found.causes] == [drawn.cause], drawn.truth
    assert found.verdict == "explained"
    return found


def test_rows_of_a_code_are_named_and_set_aside() -> None:
    drawn = draw("error_code", seed=1)
    found = answered(drawn)
    (cause,) = found.causes
    assert set(drawn.truth["hit_rows"].tolist()) == set(cause.rows)
    assert found.to_dict()["sweep"]["touched"] == len(cause.rows)
    # What is left is the noise: of so few readings it is known to a tenth.
    assert found.to_dict()["extended"]["rms_deg"] == pytest.approx(drawn.truth["noise_deg"], rel=0.25)
    assert found.extended.values["error_code"]["reading_deg"] == pytest.approx(drawn.truth["reading_deg"] % 360.0)


def test_a_bit_is_named_and_its_twin_errs_alike() -> None:
    drawn = draw("word_bit", seed=26)
    found = answered(drawn)
    (cause,) = found.causes
    assert cause.parameters["bit"].value == drawn.truth["bit"]
    assert found.to_dict()["extended"]["rms_deg"] == pytest.approx(drawn.truth["noise_deg"], rel=0.25)
    again = found.extended.simulate(found.sweep.motion(), seed=3)
    (key, fault), *rest = decoded(again, found.extended.effects).faults
    assert (key, rest) == ("word_bit", [])
    assert {name: fault.values[name] for name in ("bit", "word_bits")} == {
        "bit": drawn.truth["bit"],
        "word_bits": drawn.truth["bits"],
    }


def test_a_known_fault_of_the_words_is_no_cause() -> None:
    drawn = draw("word_bit", seed=26)
    twin = explain(drawn.columns).extended
    found = explain(drawn.columns, twin=twin)
    assert (found.verdict, found.causes) == ("adequate", ())
    assert found.extended.values["word_bit"]["bit"] == drawn.truth["bit"]


def test_readings_of_a_dead_zone_are_set_aside() -> None:
    found = answered(draw("dead_zone", seed=27))
    assert found.to_dict()["sweep"]["touched"] > 0


@pytest.mark.parametrize("seed", [3, 27])
def test_a_scale_is_told_with_its_interval(seed: int) -> None:
    drawn = draw("scale_error", seed=seed)
    (cause,) = answered(drawn).causes
    factor = cause.parameters["factor"]
    half = 0.5 * (factor.high - factor.low)
    # Twice the 95 % interval: one draw in ten thousand is farther off.
    assert abs(factor.value - drawn.truth["factor"]) < 2.0 * half
    assert half < 0.01
    turn = cause.parameters["turn_reads_deg"]
    assert turn.value == pytest.approx(360.0 * factor.value, rel=1e-6)
    assert np.isfinite([turn.low, turn.high]).all()
