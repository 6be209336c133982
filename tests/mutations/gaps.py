"""Mutations of the joint fit of several air gaps: its fits, what it says of none that holds, its intervals."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_GAPS = "diagnosis/factors/air_gaps.py"
_GAP_TESTS = "tests/diagnosis/factors/test_air_gaps.py"
_JOINED = "tests/diagnosis/test_several_recordings.py"

GAPS: tuple[Mutation, ...] = (
    Mutation(
        "joining.noise_is_an_offset",
        "diagnosis/joining.py",
        "if abs(old) <= _BEYOND_NOISE * old_sd or abs(new) <= _BEYOND_NOISE * new_sd:",
        "if old == 0.0:",
        (f"{_JOINED}::test_an_offset_that_is_not_there_has_no_ratio",),
    ),
    Mutation(
        "joining.any_ratio_is_a_gaps",
        "diagnosis/joining.py",
        "made = 1.0 / _LARGEST_RATIO < ratio < _LARGEST_RATIO",
        "made = ratio > 0.0",
        (f"{_JOINED}::test_an_offset_that_is_not_there_has_no_ratio",),
    ),
    Mutation(
        "air_gaps.misfit_passes",
        _GAPS,
        "return not self.holds or self.unchecked",
        "return self.unchecked",
        (f"{_GAP_TESTS}::test_what_nothing_explains_is_said_to_fit_nothing",),
        short=True,
    ),
    Mutation(
        "air_gaps.tilt_before_the_sensor",
        "diagnosis/factors/gap_fits.py",
        "if name in BESIDE_SENSOR:",
        "if name in ():",
        (f"{_GAP_TESTS}::test_more_causes_never_fit_worse_than_some_of_them",),
    ),
    Mutation(
        "air_gaps.a_local_minimum_stays",
        "diagnosis/factors/gap_fits.py",
        "self[causes].chi2 > simpler.chi2 + SAME_CHI2",
        "False",
        (f"{_GAP_TESTS}::test_more_causes_never_fit_worse_than_some_of_them",),
    ),
    Mutation(
        "air_gaps.the_bound_forgets_what_is_named",
        _GAPS,
        "joined((*one, cause), self.full_2) for one",
        'joined(("voltage", cause), self.full_2) for one',
        (f"{_GAP_TESTS}::test_more_causes_never_fit_worse_than_some_of_them",),
    ),
    Mutation(
        "air_gaps.the_products_interval_is_of_first_order",
        "diagnosis/factors/displacement.py",
        "scale * low / most, scale * high / least",
        "scale * low, scale * high",
        ("tests/diagnosis/factors/test_displacement.py::test_the_interval_of_a_product_holds_what_its_law_neglects",),
    ),
    Mutation(
        "air_gaps.as_many_causes_as_gaps",
        _GAPS,
        "return not self.holds or self.unchecked",
        "return not self.holds",
        (f"{_GAP_TESTS}::test_a_fourth_gap_tells_a_tilt_beside_the_electronics",),
    ),
)
