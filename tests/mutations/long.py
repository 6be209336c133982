"""Mutations of what makes long records cheap: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_LEAST_SQUARES = "tests/diagnosis/error_model/test_least_squares.py"

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
    )
)
