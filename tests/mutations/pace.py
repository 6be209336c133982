"""Mutations of the speed by the reference over time: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_TEST = "tests/twin/test_pace.py"

_OF_PACE: tuple[Mutation, ...] = tuple(
    Mutation(f"pace.{name}", "twin/pace.py", old, new, (f"{_TEST}::{test}",))
    for name, old, new, test in (
        (
            "one_speed_a_stretch",
            "    return best if np.ptp(size)",
            "    return None if np.ptp(size)",
            "test_a_coast_has_no_one_speed",
        ),
        (
            "windows_stay_narrow",
            "least > _SURE",
            "least > 9.9",
            "test_stamps_that_jitter_tell_the_speed",
        ),
        (
            "a_reading_at_a_change_has_the_new_pace",
            "new = slice(min(a, 1), None)",
            "new = slice(None)",
            "test_where_the_pace_changes_a_reading_has_the_one_by_which_it_was_reached",
        ),
        (
            "pauses_count",
            "    ticks = _without_pauses(ticks)\n",
            "",
            "test_a_pause_between_readings_is_no_slow_shaft",
        ),
        (
            "a_clock_set_back_counts",
            "np.where(step < 0.0, usual, step)",
            "step",
            "test_a_clock_that_is_set_back_goes_on",
        ),
        (
            "stamps_are_exact",
            "jitters = _of_stamps(ticks)",
            "jitters = False",
            "test_stamps_that_jitter_tell_the_speed",
        ),
        (
            "medians_of_coarse_stamps",
            "_mean_pace(ticks, a, b) if jitters else np.median(rate[a:b])",
            "np.median(rate[a:b])",
            "test_coarse_stamps_leave_an_even_speed_unbiased",
        ),
        (
            "repeated_stamps_are_stops",
            "if np.mean(same) < 0.5 or ",
            "if True or ",
            "test_stamps_farther_apart_than_a_stop_are_those_of_a_moving_shaft_that_moves_between_them",
        ),
        (
            "repeated_readings_are_a_moving_shaft",
            " or np.median(moved[same]) < 0.5 * np.mean(moved)",
            "",
            "test_readings_far_apart_are_taken_at_standstill",
        ),
    )
)

PACE: tuple[Mutation, ...] = (
    *_OF_PACE,
    Mutation(
        "pace.the_end_counts_five_times",
        "twin/running_median.py",
        'mode="reflect"',
        'mode="edge"',
        (f"{_TEST}::test_a_first_stamp_of_few_readings_is_no_speed_of_its_own",),
    ),
)
