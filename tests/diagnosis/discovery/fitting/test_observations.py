"""Averaged and long recordings: the figures stay those of single readings, the row numbers those of the file."""

from __future__ import annotations

import numpy as np

from diagnosis import explain
from diagnosis.discovery.fitting.observations import MOST_ROWS, collect
from diagnosis.discovery.fitting.subsample import LONGEST, STRETCHES, searched_part
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
