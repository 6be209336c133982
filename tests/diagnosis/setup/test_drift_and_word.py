"""Steps of the zero beside drifts, faults of the word taken off, and which column a wrong number of counts is in."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.setup.checks import checked, checked_sweep
from diagnosis.setup.finding import Finding
from diagnosis.setup.record import Record
from tests.diagnosis.setup.test_checks import TURN_DEG, kinds, reading
from twin.angles import Array
from twin.sweep import Sweep

ROWS = np.arange(4 * 360)
SHAFT_DEG = ROWS * 1.0
ALONG = ROWS / ROWS.size
BITS = 12


def word_of(angle_deg: Array) -> Array:
    return np.round(angle_deg % 360.0 * 2**BITS / 360.0).astype(np.int64) % 2**BITS


def degrees_of(word: Array) -> Array:
    return word * 360.0 / 2**BITS


def findings(reference_deg: Array, measured_deg: Array) -> tuple[Finding, ...]:
    columns = {"reference_deg": reference_deg, "measured_deg": measured_deg}
    return checked(Record("record", columns, np.arange(1, reference_deg.size + 1))).findings


@pytest.mark.parametrize("way", ["saturating", "order 1", "to and fro", "within a hundred rows"])
def test_a_zero_that_drifts_is_no_open_turn(way: str) -> None:
    """A warming of 3 deg in the first third, an order 1 that grows by 2 deg, waves of 1 deg, 2 deg at one place."""
    drift = {
        "saturating": 3.0 * (1.0 - np.exp(-3.0 * ALONG)),
        "order 1": 2.0 * ALONG * np.cos(np.radians(SHAFT_DEG)),
        "to and fro": np.sin(2.0 * np.pi * 4.5 * ALONG),
        "within a hundred rows": 2.0 / (1.0 + np.exp(-(ROWS - 700) / 20.0)),
    }[way]
    found = kinds(reference_deg=SHAFT_DEG % 360.0, measured_deg=(reading(SHAFT_DEG) + drift) % 360.0)
    assert found == []


@pytest.mark.parametrize("drift_deg", [0.0, 3.0])
def test_a_slip_is_told_beside_a_drift(drift_deg: float) -> None:
    """Of the reference, whose turns then are not even, or of the magnet."""
    step, drift = 1.0 * (ROWS >= 700), drift_deg * (1.0 - np.exp(-3.0 * ALONG))
    of_reference = findings((SHAFT_DEG - step) % 360.0, (reading(SHAFT_DEG) + drift) % 360.0)
    of_magnet = findings(SHAFT_DEG % 360.0, (reading(SHAFT_DEG) + step + drift) % 360.0)
    for (found,) in (of_reference, of_magnet):
        assert (found.kind, found.rows) == ("turn_not_closed", (701,))


def test_what_goes_with_the_current_is_no_open_turn() -> None:
    """A field of the motor: 0.1 deg an ampere, of a current that is switched from 5 to 15 A and back."""
    current = 5.0 + 10.0 * ((ROWS >= 500) & (ROWS < 1100)) + 0.05 * np.random.default_rng(4).standard_normal(ROWS.size)
    columns = {"reference_deg": SHAFT_DEG % 360.0, "measured_deg": (reading(SHAFT_DEG) + 0.1 * current) % 360.0}
    assert kinds(**columns) == ["turn_not_closed"]
    assert kinds(**columns, current_a=current) == []


def test_rows_of_an_error_code_are_told_and_left_out() -> None:
    """Of 12 words 0 two stand in a row: neither a step of the zero, nor any other fault."""
    word = word_of(reading())
    lost = np.array([20, 39, 68, 92, 120, 121, 122, 149, 180, 200, 240, 260])
    word[lost] = 0
    (found,) = findings(TURN_DEG, degrees_of(word))
    assert (found.kind, found.level, found.rows) == ("error_code", "fault", tuple(lost + 1))


@pytest.mark.parametrize("bit", [4, 5, BITS - 1])
def test_a_stuck_bit_is_told_and_makes_no_other_order(bit: int) -> None:
    """Its sawtooth has as many teeth in a turn as the bit has periods: no line of the shaft, nor an alias of one."""
    word = word_of(reading(np.arange(0.0, 720.0, 2.0))) | (1 << bit)
    (found,) = findings(np.arange(0.0, 720.0, 2.0), degrees_of(word))
    assert found.kind == "word_bit"
    assert f"bit {bit} of the {BITS}-bit word is stuck at 1" in found.evidence


def test_a_range_that_is_never_read_is_told() -> None:
    angle = reading(np.arange(0.0, 720.0, 1.0))
    word = word_of(np.where(angle < 4.0, 359.9, np.where(angle < 8.0, 8.0, angle)))
    (found,) = findings(np.arange(0.0, 720.0, 1.0), degrees_of(word))
    assert found.kind == "dead_zone"


def test_a_reading_that_stands_still_once_over_a_quarter_of_a_turn_is_frozen() -> None:
    """Words of one turn: no other reading lies within the stretch, as in a dead zone, which holds in every turn."""
    shaft = np.arange(0.0, 360.0, 2.0)
    word = word_of(reading(shaft))
    word[40:85] = word[40]
    assert [finding.kind for finding in findings(shaft, degrees_of(word))] == ["frozen"]


def test_explain_names_faults_of_the_word_as_causes_alone() -> None:
    word = word_of(reading()) | (1 << 5)
    assert checked_sweep(Sweep(TURN_DEG, degrees_of(word))) == ()


def test_a_reading_with_a_wrong_factor_is_multiplied_itself() -> None:
    """Counts times 0.087 for 360/4096: what the word 0 begins anew shows, and a reference cannot do."""
    shaft = np.arange(0.0, 360.0, 5.0)
    (found,) = findings(shaft, word_of(reading(shaft) - 20.0) * 0.087)
    assert (found.kind, found.columns) == (
        "wrong_counts",
        f"reference_deg=reference_deg, measured_deg=measured_deg*{found.columns.rpartition('*')[2]}",
    )
    # Orders 1 to 4 and the noise of 0.03 deg in 72 rows leave a slope that is known to a few parts in 10,000.
    assert float(found.columns.rpartition("*")[2]) == pytest.approx(360.0 / 4096.0 / 0.087, abs=1e-3)


def test_a_reference_with_a_wrong_factor_is_multiplied_itself() -> None:
    (found,) = findings(TURN_DEG * 4096.0 / 4000.0, reading())
    assert found.columns.startswith("reference_deg=reference_deg*0.976")


@pytest.mark.parametrize("rows", [5, 12, 25, 40])
def test_a_zero_that_slides_over_some_rows_is_no_slip(rows: int) -> None:
    assert "turn_not_closed" not in _kinds_of_zero(rows)


@pytest.mark.parametrize("rows", [0.1, 1.0, 2.0])
def test_a_slip_from_one_row_to_the_next_is_told(rows: float) -> None:
    assert "turn_not_closed" in _kinds_of_zero(rows)


def _kinds_of_zero(rows: float) -> list[str]:
    """What is found in four turns in which the zero goes by 3 deg within so many rows."""
    turn = np.radians(SHAFT_DEG)
    error = 0.8 * np.cos(turn - 0.7) + 0.3 * np.cos(2.0 * turn) + 3.0 * np.clip((ROWS - 800) / rows, 0.0, 1.0)
    error += 0.05 * np.random.default_rng(3).normal(size=ROWS.size)
    return [finding.kind for finding in findings(SHAFT_DEG % 360.0, (SHAFT_DEG + error) % 360.0)]
