"""Faults of the link in the answer: named, taken off the readings ahead of the fit, and part of the extended twin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from diagnosis import diagnose, explain
from diagnosis.explanation import Explanation
from tests.command_line import halltwin
from tests.hidden.link_faults import Drawn, draw
from twin.decoded import decoded
from twin.sweep import Sweep


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


@pytest.mark.parametrize("seed", [8, 22, 27])
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


def test_diagnose_and_compensate_say_which_rows_hold_a_code(tmp_path: Path) -> None:
    drawn = draw("error_code", seed=1)
    rows = drawn.truth["hit_rows"].tolist()
    found = diagnose(drawn.columns)
    assert [row for row in found.sweep.rejected if row in rows] == rows
    assert found.rms_deg == pytest.approx(drawn.truth["noise_deg"], rel=0.25)
    path = tmp_path / "sweep.csv"
    Sweep(**drawn.columns).write(path)
    said = " ".join(halltwin("compensate", path).out.split())
    assert f"{len(rows)} rejected (rows {rows[0]}, {rows[1]}" in said
    assert "error_code: the word" in said


def test_diagnose_says_that_readings_were_told_back() -> None:
    found = diagnose(draw("word_bit", seed=26).columns)
    assert any("word_bit: bit" in line and "told back" in line for line in found.sentences)


@pytest.mark.parametrize("seed", [2, 31])
def test_two_slips_are_told_with_their_instants(seed: int) -> None:
    """Two jumps of one sign look like a drift, unless both are placed together."""
    drawn = draw("index_slip", seed=seed)
    (cause,) = answered(drawn).causes
    steps = {cause.parameters[f"time_s{end}"].value: cause.parameters[f"step_deg{end}"] for end in ("", "_2")}
    assert sorted(steps) == pytest.approx(sorted(drawn.truth["time_s"]), abs=0.15)
    for size, instant in zip(drawn.truth["steps_deg"], drawn.truth["time_s"], strict=True):
        step = steps[min(steps, key=lambda one: abs(one - instant))]
        # A reference that jumps on reads less by its step from then on.
        assert abs(step.value + size) < step.high - step.low


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_index_of_a_table_is_no_quantiser(seed: int) -> None:
    found = explain(draw("table", seed=seed).columns)
    assert (found.verdict, found.causes) == ("adequate", ())
    assert found.to_dict()["sweep"]["output_bits"] is None


@pytest.mark.parametrize("seed", [1, 4])
def test_a_typing_error_of_a_small_table_is_named_as_its_row(seed: int) -> None:
    drawn = draw("typing_error", seed=seed)
    found = explain(drawn.columns)
    assert found.to_dict()["sweep"]["wild_rows"] == [drawn.truth["row"]]
    assert (found.verdict, found.causes) == ("adequate", ())


def test_a_typing_error_is_told_among_readings_that_rise_and_fall() -> None:
    """A six-step table: two readings a step, before and behind it; the row is off by twelve of their scatters."""
    row = np.arange(22)
    shaft = 360.0 / 11 * (row // 2) + 7.0 * (row % 2)
    error = 1.9 * np.sin(2.0 * np.radians(shaft)) + 0.28 * np.random.default_rng(4).choice([-1.0, 1.0], 22)
    error[16] += 3.5
    found = explain({"reference_deg": shaft, "measured_deg": np.mod(shaft + error, 360.0)})
    assert found.to_dict()["sweep"]["wild_rows"] == [17]
    assert found.causes == ()
