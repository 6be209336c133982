"""Faults of the link in the answer: named, taken off the readings ahead of the fit, and part of the extended twin."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from diagnosis import diagnose, explain
from diagnosis.explanation import Explanation
from tests.command_line import halltwin
from tests.hidden.link_faults import Drawn, draw
from twin.baseline import FACTORS
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


@pytest.mark.parametrize("seed", [1, 2, 22])
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


def with_bit_5_held(tmp_path: Path) -> Path:
    """A file of two turns whose 12-bit words have bit 5 at 0, worth 2.8125 deg; the sensor's zero is 41 deg."""
    angle = np.arange(360) * 2.0
    read = angle + 41.0 + 1.2 * np.sin(np.radians(angle)) + 0.03 * np.random.default_rng(2).standard_normal(360)
    words = np.round(read / 360.0 * 4096).astype(np.int64) % 4096
    path = tmp_path / "held.csv"
    Sweep(angle, (words & ~32) * (360.0 / 4096)).write(path)
    return path


def test_what_sends_the_same_words_is_told_with_its_zero(tmp_path: Path) -> None:
    path = with_bit_5_held(tmp_path)
    found = explain(path)
    answer = found.to_dict()
    (cause,) = answer["causes"]
    zero = answer["extended"]["parameters"]["zero_deg"]
    # Orders 1 and 2 of the factors leave little of the mean: a hundredth of a degree.
    assert zero["value"] == pytest.approx(-41.0, abs=0.02)
    (other,) = cause["same_words"]
    assert other["zero_by_deg"] == pytest.approx(32 * 360.0 / 4096)
    # A twin with the other fault and the zero that it then has sends the same words, but for what the factors turn.
    twin, motion = found.extended, found.sweep.motion()
    (factor,) = (one for one in FACTORS if one.name == "zero_deg")
    moved = twin.values[factor.key][factor.param] + other["zero_by_deg"] / factor.scale
    own = {key: dict(twin.values[key]) for key in ("word_bit", factor.key)}
    own["word_bit"]["into"], own[factor.key][factor.param] = 1.0, moved
    beside = twin.with_values(own)
    away = beside.simulate(motion, seed=1).measured_deg - twin.simulate(motion, seed=1).measured_deg
    assert np.median(np.abs((away + 180.0) % 360.0 - 180.0)) < 0.1
    said = " ".join(halltwin("explain", path).out.split())
    assert "bit 5 of the 12-bit word is stuck at 0; the bit is worth 2.8125 deg" in said
    assert "cannot be told from: bit 5 of the 12-bit word is read into bit 6 (added to it)" in said
    assert "the zero would then be about 2.81 deg larger" in said
    assert "level 0" not in said


def test_the_error_of_the_words_as_sent_stands_beside_that_of_the_decoded_ones(tmp_path: Path) -> None:
    path = with_bit_5_held(tmp_path)
    found = explain(path)
    baseline = found.to_dict()["baseline"]
    # Half of the readings lack 2.8125 deg: 1.41 deg RMS about their mean, beside 1.2/sqrt(2) deg of the sensor.
    assert baseline["fitted_error_rms_deg"] == pytest.approx(0.85, abs=0.01)
    assert baseline["as_sent_error_rms_deg"] == pytest.approx(np.hypot(0.85, 1.41), rel=0.05)
    said = " ".join(halltwin("explain", path).out.split())
    assert "error of the decoded readings 0.8" in said
    assert "Before the decoding the words as sent err by 1.6" in said
    pytest.importorskip("matplotlib")
    title = found.plot().axes[0].get_title()
    assert title.startswith("decoded (as sent: 1.6")


def test_a_sweep_with_sound_words_has_no_error_as_sent() -> None:
    assert "as_sent_error_rms_deg" not in explain(draw("clean", seed=1).columns).to_dict()["baseline"]


@pytest.mark.parametrize(
    ("cause", "seed", "words"),
    [
        ("error_code", 4, ("stands in the place of the angle in", "of the readings, in runs of", "on average")),
        ("dead_zone", 27, ("no angle is ever read from", "over a width of", "the lower edge stands for the first")),
    ],
)
def test_a_fault_of_the_words_is_a_sentence(cause: str, seed: int, words: tuple[str, ...], tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    Sweep(**draw(cause, seed=seed).columns).write(path)
    said = " ".join(halltwin("explain", path).out.split())
    for part in words:
        assert part in said
    assert "run rows" not in said
    assert "word bits" not in said
