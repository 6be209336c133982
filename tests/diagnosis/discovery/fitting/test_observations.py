"""Averaged and long recordings: the figures stay those of single readings, the row numbers those of the file."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.fitting.observations import MOST_ROWS, collect
from diagnosis.discovery.fitting.subsample import LONGEST, STRETCHES, searched_part
from diagnosis.discovery.further.measurements import MENU
from tests.several_recordings import played
from twin.angles import Array
from twin.sweep import Sweep

NOISE_DEG = 0.03


def _sweep(n: int, points_per_turn: int, *, seed: int = 1) -> Sweep:
    """Half of the readings forward, half backward, an error of the first order and Gaussian noise."""
    half = n // 2
    steps = np.concatenate([np.arange(half), half - np.arange(n - half)])
    reference = steps * 360.0 / points_per_turn
    noise = NOISE_DEG * np.random.default_rng(seed).standard_normal(n)
    measured = reference + 0.4 * np.sin(np.radians(reference) + 1.0) + noise
    return _read({"reference_deg": reference % 360.0, "measured_deg": measured % 360.0})


def _read(columns: dict[str, Array]) -> Sweep:
    return Sweep.from_columns(columns)


def test_averaged_readings_keep_the_scatter_of_single_ones() -> None:
    sweep = _sweep(8 * MOST_ROWS, 8 * 360)
    observations = collect(sweep)
    assert len(observations) <= 1.05 * MOST_ROWS
    # The shaft moves by 0.6 deg within a block of five: a scatter that counted it would be ten times the noise.
    # A standard deviation of n readings is known to 1 / sqrt(2 n); five times that.
    tolerance = 5.0 / np.sqrt(2.0 * len(sweep))
    assert observations.repeat_rms is not None
    assert (
        abs(np.degrees(observations.repeat_rms) / NOISE_DEG - 1.0) < tolerance + 0.002
    )  # the error's own slope, 0.7 %


def test_every_rms_of_an_averaged_sweep_is_that_of_single_readings() -> None:
    answer = explain(_sweep(3 * MOST_ROWS, 4 * 360)).to_dict()
    assert answer["verdict"] == "adequate"
    for figure in (answer["baseline"]["rms_deg"], answer["extended"]["heldout_rms_deg"], answer["noise_floor_deg"]):
        assert abs(figure / NOISE_DEG - 1.0) < 0.02


def test_a_long_recording_is_searched_in_stretches_without_a_jump_of_the_shaft() -> None:
    sweep = _sweep(10 * LONGEST, 360)
    part = searched_part(sweep)
    # Each stretch gives up as much as half a turn for its beginning to follow on, those about the reversal more.
    assert 0.8 * LONGEST < len(part) <= LONGEST
    assert part.rows == len(sweep)
    assert np.count_nonzero(np.diff(part.numbers) != 1) == STRETCHES - 1
    assert part.numbers[0] == 1
    assert part.numbers[-1] > 0.95 * len(sweep)
    # The one reversal is in it: what follows a reversal tells a lag from a slip.
    reversal = len(sweep) // 2
    assert {reversal - 50, reversal, reversal + 50} <= set(part.numbers.tolist())
    assert {1.0, -1.0} == set(part.motion().direction)
    step = np.abs(np.diff(part.motion().shaft_rad))
    assert np.degrees(step.max()) < 2.0 + 1e-9


def test_short_recordings_are_searched_whole() -> None:
    sweep = _sweep(LONGEST, 360)
    assert searched_part(sweep) is sweep


def test_rows_keep_their_numbers_where_others_were_rejected() -> None:
    sweep = _sweep(1440, 720)
    measured = np.array(sweep.measured_deg)
    measured[[3, 700]] = np.nan
    measured[1000] += 45.0
    read = _read({"reference_deg": sweep.reference_deg, "measured_deg": measured})
    assert list(read.rejected) == [4, 701]
    answer = explain(read).to_dict()
    glitches = [row for cause in answer["causes"] for row in cause.get("rows", [])]
    assert [*glitches, *answer["sweep"]["wild_rows"]] == [1001]


def _stopping(step_deg: float, *, repeats: int, jitter_deg: float, seed: int = 3) -> Array:
    """Angles at which the shaft stops in a turn forward and back, each read several times off a jittering reference."""
    stops = np.arange(0.0, 361.0, step_deg)
    angles = np.repeat(np.concatenate([stops, stops[-2::-1]]), repeats)
    return np.asarray(angles + jitter_deg * np.random.default_rng(seed).standard_normal(angles.size))


@pytest.mark.parametrize("jitter_deg", [0.0, 0.03])
@pytest.mark.parametrize("repeats", [2, 10])
def test_readings_at_a_stop_are_one_row(repeats: int, jitter_deg: float) -> None:
    angles = _stopping(5.0, repeats=repeats, jitter_deg=jitter_deg)
    way = np.repeat([1.0, -1.0], [73 * repeats, 72 * repeats])
    observations = collect(_read({"reference_deg": angles, "measured_deg": angles, "direction": way}))
    assert np.array_equal(observations.group, np.arange(angles.size) // repeats)
    assert observations.repeats is not None


@pytest.mark.parametrize(("fine_deg", "reach_deg"), [(0.05, 1.0), (0.1, 1.0), (0.5, 20.0)])
def test_short_steps_that_lead_onward_are_no_repeats(fine_deg: float, reach_deg: float) -> None:
    """After each of 24 reversals in fine steps, though most steps are shorter than a fifth of the coarse ones."""
    leg = np.arange(fine_deg, reach_deg + 0.5 * fine_deg, fine_deg)
    way = np.concatenate([np.repeat([1.0, -1.0], [73, 72]), np.repeat(np.resize([1.0, -1.0], 24), leg.size)])
    angles = np.concatenate([_stopping(5.0, repeats=1, jitter_deg=0.0), *([leg, reach_deg - leg] * 12)])
    observations = collect(_read({"reference_deg": angles, "measured_deg": angles, "direction": way}))
    assert len(observations) == angles.size
    assert observations.repeats is None


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_play_sampled_finely_after_reversals_is_told_from_a_hysteresis(seed: int) -> None:
    """As the menu of further measurements advises: a play of 0.2 deg is taken up on the way, a hysteresis decays."""
    angles = _stopping(5.0, repeats=1, jitter_deg=0.0)
    way = np.repeat([1.0, -1.0], [73, 72])
    first = _read({"reference_deg": angles, "measured_deg": angles, "direction": way})
    (advised,) = (entry for entry in MENU if entry.name == "denser points after a reversal")
    motion = advised.plan(first.motion())
    assert motion is not None
    shaft = np.degrees(motion.shaft_rad)
    turned = shaft + played(shaft, 0.1)
    measured = turned + 0.4 * np.sin(np.radians(turned) + 1.0)
    measured += NOISE_DEG * np.random.default_rng(seed).standard_normal(shaft.size)
    answer = explain(_read({"reference_deg": shaft, "measured_deg": measured, "direction": motion.direction})).to_dict()
    (cause,) = answer["causes"]
    assert "backlash" in {cause["name"], *cause["indistinguishable_from"]}
    # A standard deviation of n readings is known to 1 / sqrt(2 n); five times that, and what few causes take up.
    assert abs(answer["extended"]["heldout_rms_deg"] / NOISE_DEG - 1.0) < 5.0 / np.sqrt(2.0 * shaft.size)


def test_two_readings_a_step_are_two_angles() -> None:
    """A six-step table: each step is read 5 deg apart, a fifth or a seventh of the way to the next."""
    for steps in (9, 11):
        row = np.arange(2 * steps)
        reference = 360.0 / steps * (row // 2) + 5.0 * (row % 2)
        assert len(collect(_read({"reference_deg": reference, "measured_deg": reference + 1.0}))) == row.size
