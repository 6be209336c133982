"""Mutations of what makes long records cheap: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_LEAST_SQUARES = "tests/diagnosis/error_model/test_least_squares.py"
_WHOLE = "tests/diagnosis/discovery/test_whole_record.py"

LONG: tuple[Mutation, ...] = tuple(
    Mutation(f"long.{name}", file, old, new, (test,))
    for name, file, old, new, test in (
        (
            "a_curvature_is_kept_however_long_the_step",
            "diagnosis/error_model/least_squares.py",
            "_ALIKE = 1e-6",
            "_ALIKE = np.inf",
            f"{_LEAST_SQUARES}::test_the_interval_is_that_of_the_curvature_where_the_descent_ends",
        ),
        (
            "sums_without_the_fourth_harmonic",
            "diagnosis/error_model/moments.py",
            "range(5, out.shape[-2], 2)",
            "range(5, out.shape[-2] - 2, 2)",
            f"{_LEAST_SQUARES}::test_the_form_is_the_sums_over_the_features",
        ),
        (
            "angles_beyond_the_turn_stay_there",
            "twin/angles.py",
            "np.remainder(shifted, TAU, out=shifted, where=beyond)",
            "pass",
            "tests/twin/test_angles.py::test_many_angles_are_wrapped_as_few_are",
        ),
        (
            "columns_that_are_nearly_one_are_taken_for_independent",
            "twin/least_squares.py",
            "_CLEAR = 1e-6",
            "_CLEAR = -1.0",
            "tests/twin/test_least_squares.py",
        ),
        (
            "a_block_begins_without_a_turn_ahead_of_it",
            "diagnosis/discovery/whole_record.py",
            "lead = int(np.ceil(sweep.part(np.arange(min(count, _BLOCK))).motion().points_per_turn))",
            "lead = 0",
            f"{_WHOLE}::test_blocks_do_not_show",
        ),
        (
            "wild_readings_are_part_of_the_means",
            "diagnosis/discovery/whole_record.py",
            "np.abs(left) <= _FAR * sigma",
            "np.abs(left) <= np.inf",
            f"{_WHOLE}::test_wild_readings_are_no_part_of_the_means",
        ),
        (
            "stairs_are_taken_for_blurred",
            "diagnosis/discovery/whole_record.py",
            "typical < FEWEST_TURNS or stairs_left(found.bits, sigma) > sigma / np.sqrt(typical)",
            "typical < FEWEST_TURNS",
            f"{_WHOLE}::test_no_means_where_they_would_say_nothing",
        ),
        (
            "the_means_are_those_of_the_twin",
            "diagnosis/discovery/whole_record.py",
            "expected + mean(self.left)",
            "expected",
            f"{_WHOLE}::test_the_means_show_what_the_noise_of_the_searched_part_hides",
        ),
    )
)
