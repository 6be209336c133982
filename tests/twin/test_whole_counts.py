"""Counts of a reference: their number, where the shaft stood between them, and when nothing tells."""

from __future__ import annotations

import numpy as np
import pytest

from twin.angles import Array
from twin.motion import Motion
from twin.whole_counts import counts_of_a_turn, whole_counts

THERE = np.linspace(0.0, 720.0, 360, endpoint=False) + 12.3


def read(shaft_deg: Array, counts: int, *, decimals: int = 9) -> Array:
    """What an encoder of so many counts reads [rad], as a file of so many decimals holds it."""
    return np.asarray(np.radians(np.round(np.round(shaft_deg / 360.0 * counts) * (360.0 / counts), decimals)))


def rounding(shaft_deg: Array, counts: int) -> Array:
    """What it reads too much, in counts."""
    return np.asarray(np.round(shaft_deg / 360.0 * counts) - shaft_deg / 360.0 * counts)


WAYS = {
    "even stops": THERE,
    "both ways": np.concatenate([THERE, THERE[::-1]]),
    "slow": np.arange(3000) * 0.0123,
    "several at a stop": np.repeat(THERE[::2], 5),
    "a gap": np.concatenate([THERE[:100], THERE[150:]]),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("counts", "decimals"), [(4000, 9), (3700, 4), (16_384, 4)])
def test_an_even_way_tells_where_between_two_counts_each_reading_was(way: str, counts: int, decimals: int) -> None:
    shaft = WAYS[way]
    found = whole_counts(read(shaft, counts, decimals=decimals))
    assert found is not None
    assert found.counts_per_turn == counts
    # A line through n roundings of 0.29 counts is known to 0.58 / sqrt(n) at its ends; the shortest runs have 100 rows.
    assert float(np.std(found.off - rounding(shaft, counts))) < 0.58 / np.sqrt(100)


def test_a_slow_wow_is_followed() -> None:
    turns = np.linspace(0.0, 3.1, 2000)
    shaft = 360.0 * turns + 0.05 * np.sin(2.0 * np.pi * turns)
    found = whole_counts(read(shaft, 4000))
    assert found is not None
    # A stretch ends where the wow is half a count off it. At its ends a line leaves twice what it leaves in its middle:
    # laid end to end the stretches leave 0.041, each begun in the middle of the one before 0.020.
    assert float(np.std(found.off - rounding(shaft, 4000))) < 0.03


@pytest.mark.parametrize(
    "shaft",
    [
        THERE - 12.3,  # At 2 deg a step each stop is one of 180 counts.
        np.concatenate([THERE - 12.3, THERE[::-1] - 12.3]),
        np.cumsum(np.random.default_rng(3).uniform(0.3, 5.0, 400)),
    ],
    ids=["at counts", "at counts both ways", "turned by hand"],
)
def test_where_nothing_tells_nothing_is_said(shaft: Array) -> None:
    counts = 180 if shaft[1] - shaft[0] == pytest.approx(2.0) else 4000
    assert whole_counts(read(shaft, counts)) is None


def test_an_angle_of_its_own_is_on_no_counts() -> None:
    assert not list(counts_of_a_turn(np.radians(THERE + np.random.default_rng(1).normal(0.0, 0.01, THERE.size))))
    assert not list(counts_of_a_turn(np.zeros(20)))


@pytest.mark.parametrize(("counts", "decimals"), [(500, 1), (1024, 2), (4096, 2), (4096, 3), (16_384, 3), (3600, 1)])
def test_a_files_last_decimal_is_not_taken_for_a_count(counts: int, decimals: int) -> None:
    shaft = 0.3 + np.arange(700) * 360.0 / 351.0
    found = whole_counts(read(shaft, counts, decimals=decimals))
    assert found is not None
    assert found.counts_per_turn == counts


@pytest.mark.parametrize("wrapped", [True, False])
@pytest.mark.parametrize("decimals", [2, 3, 5])
def test_decimals_of_a_radian_are_counts_of_which_a_turn_has_no_whole_number(decimals: int, wrapped: bool) -> None:
    # One reading of each turn is 0.
    shaft = np.radians(np.arange(-350, 350) * 360.0 / 351.0)
    step = 10.0**-decimals
    read = np.round(np.mod(shaft, 2.0 * np.pi) if wrapped else shaft, decimals)
    found = Motion.from_angle(read).whole_counts
    assert found is not None
    assert found.counts_per_turn == pytest.approx(2.0 * np.pi / step, rel=1e-12)
    truly = (read - (np.mod(shaft, 2.0 * np.pi) if wrapped else shaft)) / step
    # As above, of one run of 700 rows; the parabola of each stretch may take up as much again.
    assert float(np.std(found.off - truly)) < 2.0 * 0.58 / np.sqrt(700)


def test_an_encoder_of_which_few_decimals_are_printed_is_told_by_its_counts() -> None:
    """At a tenth of a degree 0.36 deg are 0.3 or 0.4; none of its readings lies on its counts."""
    found = whole_counts(read(0.3 + np.arange(700) * 360.0 / 351.0, 1000, decimals=1))
    assert found is not None
    assert found.counts_per_turn == 1000


def test_a_shaft_that_speeds_up_is_followed() -> None:
    """What lines leave of its bends would follow the acceleration, as a torsion of the shaft does."""
    time = np.linspace(0.0, 6.0, 3000)
    rate = 2.0 * np.pi * 0.5
    shaft = 6.0 * (500.0 * time - 300.0 * np.cos(rate * time) / rate)
    found = whole_counts(read(shaft, 2048))
    assert found is not None
    left, bend = found.off - rounding(shaft, 2048), np.cos(rate * time)
    # Lines alone: slope 0.2 counts. By chance, as there are 40 stretches and more, 0.11 / sqrt(40) * sqrt(2).
    assert abs(2.0 * float(np.mean(left * bend))) < 3.0 * 0.025


def test_a_part_of_the_rows_knows_what_all_of_them_told() -> None:
    motion = Motion.from_angle(read(THERE, 4000))
    rows = np.flatnonzero(np.random.default_rng(5).random(THERE.size) < 0.5)
    part = motion.part(rows).whole_counts
    assert part is not None
    assert motion.whole_counts is not None
    np.testing.assert_array_equal(part.off, motion.whole_counts.off[rows])


def test_a_motion_found_from_what_was_read_keeps_what_that_told() -> None:
    motion = Motion.from_angle(read(THERE, 4000))
    moved = motion.at(motion.shaft_rad + 1e-4)
    assert moved.whole_counts is motion.whole_counts
    np.testing.assert_array_equal(moved.recorded_rad, motion.shaft_rad)


def test_means_of_readings_know_what_the_readings_told() -> None:
    motion = Motion.from_angle(read(THERE, 4000))
    mean = motion.averaged(np.arange(THERE.size) // 2)
    assert motion.whole_counts is not None
    assert mean.whole_counts is not None
    np.testing.assert_allclose(mean.whole_counts.off, motion.whole_counts.off.reshape(-1, 2).mean(axis=1))
    np.testing.assert_allclose(mean.recorded_rad, motion.shaft_rad.reshape(-1, 2).mean(axis=1))
