"""Mutations of what a search spares: each rule off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_JOINT_FIT = "tests/diagnosis/discovery/fitting/test_joint_fit.py"
_SEARCH = "tests/diagnosis/discovery/search"

SPARED: tuple[Mutation, ...] = tuple(
    Mutation(f"spared.{name}", f"diagnosis/discovery/{file}", old, new, (test,))
    for name, file, old, new, test in (
        (
            "an_unexplained_radius_is_searched_again",
            "search/iterate.py",
            "        if not promising(fit):\n            break\n",
            "",
            f"{_SEARCH}/test_iterate.py::test_a_radius_that_the_first_round_leaves_unexplained_is_not_searched_again",
        ),
        (
            "shapes_are_asked_by_every_search",
            "search/stepwise.py",
            " if set(held) != set(keys) else []",
            "",
            f"{_SEARCH}/test_exchange.py::test_a_search_that_changes_nothing_asks_no_shape_that_was_handed_in_to_it",
        ),
        (
            "details_are_fitted_that_promise_little",
            "search/freed.py",
            "level * fit.settings.rival_share",
            "0.0",
            f"{_SEARCH}/test_details.py::test_only_a_detail_that_promises_a_share_of_the_level_is_fitted",
        ),
        (
            "a_step_that_promises_nothing_is_tried_shorter",
            "fitting/joint_fit.py",
            "            if promised < least_gain * sigma**2:",
            "            if False:",
            f"{_JOINT_FIT}::test_a_step_that_promises_nothing_is_not_tried_shorter",
        ),
        (
            "all_columns_are_found_at_once",
            "fitting/columns.py",
            "for place in places) if key not in known",
            "for place in range(len(self.moved))) if key not in known",
            f"{_JOINT_FIT}::test_only_those_columns_are_found_that_are_asked_for",
        ),
        (
            "rivals_are_left_rough",
            "search/rivals.py",
            "    trial, _ = fitted()\n",
            "",
            f"{_SEARCH}/test_rivals.py::test_only_who_may_be_as_good_is_fitted_to_the_end",
        ),
        (
            "every_rival_is_fitted_to_the_end",
            "search/rivals.py",
            "    if gained(trial) <= gain - _same(fit, trial) - LEFT_OFF:",
            "    if False:",
            f"{_SEARCH}/test_rivals.py::test_only_who_may_be_as_good_is_fitted_to_the_end",
        ),
        (
            "a_cause_is_looked_at_twice_in_its_place",
            "search/exchange.py",
            ", known=removal.own)",
            ")",
            f"{_SEARCH}/test_exchange.py::test_a_cause_is_looked_at_in_its_own_place_once",
        ),
        (
            "plausible_noises_are_found_anew_for_each_rival",
            "fitting/noise/plausible.py",
            "@lru_cache(maxsize=4)\ndef plausible_members",
            "def plausible_members",
            "tests/diagnosis/discovery/fitting/test_plausible.py::test_a_fit_is_asked_for_its_plausible_members_once",
        ),
        (
            "plans_are_solved_for_to_the_end",
            "further/power.py",
            ", least_gain=_LEAST_SHARE * other.freedom",
            "",
            "tests/diagnosis/discovery/further/test_power.py::test_a_plan_is_solved_for_as_closely_as_it_is_told",
        ),
    )
)
