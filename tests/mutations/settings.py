"""Mutations made from the settings: each default halved and doubled, and the test that has to notice.

A budget that is doubled costs time and changes no answer that is not at the edge: it is halved alone. So is the length
of a spike, because the median of nine neighbours shows none that is longer than four. What the settings refuse is left
out.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields

from diagnosis.discovery.settings import DiscoverySettings
from tests.mutations.mutation import ROOT, Mutation

_FILE = "diagnosis/discovery/settings.py"
_D = "tests/diagnosis/discovery"
_VALUES = f"{_D}/test_settings.py::test_a_value_is_what_the_words_beside_it_say"

NOTICED_BY: dict[str, tuple[str, ...]] = {
    "false_alarm_probability": (
        f"{_D}/stages/test_quantisation.py::test_chance_is_shared_by_the_levels_that_are_tried",
    ),
    "beyond_doubt_log_p": (f"{_D}/stages/test_variance.py::test_what_is_beyond_doubt_weighs_the_rows",),
    "no_simulation_log_p": (f"{_D}/proof/test_selection.py::test_only_what_leaves_a_doubt_is_calibrated",),
    "unnamed_log_odds": (f"{_D}/stages/test_stepwise.py::test_what_stands_out_is_found",),
    "swap_log_odds": (f"{_D}/search/test_exchange.py::test_what_becomes_of_the_causes_held",),
    "colour_log_odds": (f"{_D}/fitting/test_plausible.py::test_members_within_reach_of_the_best_are_plausible",),
    "stairs_log_odds": (f"{_D}/search/test_likelihood_ratio.py::test_what_an_effect_has_to_gain_beyond_others",),
    "aliased_shapes": (f"{_D}/search/test_likelihood_ratio.py::test_among_many_places_stairs_pass_for_one",),
    "sigma_apart": (
        f"{_D}/search/test_rivals.py::test_as_good_is_within_three_sigma_and_beside_coarse_stairs_within_six",
    ),
    "sigma_enough": (f"{_VALUES}[sigma_enough]",),
    "stairs_sigma_factor": (
        f"{_D}/search/test_rivals.py::test_as_good_is_within_three_sigma_and_beside_coarse_stairs_within_six",
    ),
    "most_causes": (f"{_VALUES}[most_causes]",),
    "most_together": (
        f"{_D}/search/test_forward_step.py::"
        "test_causes_that_pass_for_coloured_noise_to_one_another_are_found_together[three]",
    ),
    "most_in_place": (
        f"{_D}/search/test_exchange.py::test_named_causes_take_the_place_of_a_shape_that_they_explain[half and half]",
    ),
    "most_rounds": (f"{_D}/search/test_iterate.py::test_a_search_that_never_ends_ends_after_its_rounds",),
    "most_contenders": (
        f"{_D}/search/test_forward_step.py::test_the_exact_fit_decides_among_those_near_the_best[as many as may be]",
    ),
    "most_rivals": (
        f"{_D}/search/test_exchange.py::test_no_more_rivals_are_tried_than_may_be_but_zeros_of_the_turns_are",
    ),
    "contender_nats": (f"{_D}/search/test_forward_step.py::test_the_exact_fit_decides_among_those_near_the_best",),
    "contender_share": (f"{_D}/search/test_forward_step.py::test_of_strong_causes_the_reach_is_a_share_of_the_score",),
    "fair_share": (f"{_D}/search/test_forward_step.py::test_who_explains_a_fair_share_is_remembered",),
    "rival_share": (f"{_D}/search/test_rivals.py::test_only_who_gains_a_share_to_first_order_is_fitted",),
    "seen_share": (f"{_VALUES}[seen_share]",),
    "whole_order_turns": (f"{_D}/search/test_periodogram.py::test_below_two_turns_whole_orders_alone_are_tried",),
    "radius_left": (f"{_D}/search/test_iterate.py::test_more_than_its_noise_is_left_of_the_radius",),
    "smallest_rms_deg": (f"{_D}/stages/test_stepwise.py::test_below_a_files_last_digit_nothing_is_searched",),
    "spike_sigma": (f"{_D}/stages/test_row_masks.py::test_which_rows_are_masked",),
    "spike_sigma_few": (f"{_D}/stages/test_row_masks.py::test_which_rows_are_masked",),
    "spike_few": (f"{_D}/stages/test_row_masks.py::test_which_rows_are_masked",),
    "longest_spike": (f"{_D}/stages/test_row_masks.py::test_which_rows_are_masked",),
    "fallen_out": (f"{_D}/stages/test_row_masks.py::test_channels_that_fall_out_are_masked",),
    "fewest_words": (f"{_D}/stages/test_observe.py::test_few_words_say_nothing_of_the_grid",),
    "stairs_in_noise": (
        f"{_D}/stages/test_quantisation.py::test_the_grid_is_modelled_where_it_is_not_small_against_the_noise",
    ),
    "stairs_cause_share": (f"{_D}/stages/test_grid_cause.py::test_rounding_is_a_cause_from_half_of_the_noise_on",),
    "set_share": (
        f"{_D}/marks/test_quantisation.py::test_chance_is_the_share_of_the_words_to_the_power_of_the_readings",
    ),
    "set_missed": (
        f"{_D}/marks/test_quantisation.py::test_chance_is_the_share_of_the_words_to_the_power_of_the_readings",
    ),
    "burst_ratio": (f"{_D}/marks/test_spread.py::test_a_stretch_is_louder_from_a_ratio_of_the_variances_on",),
    "noise_reach": (f"{_D}/fitting/test_plausible.py::test_members_within_reach_of_the_best_are_plausible",),
    "noise_turns": (f"{_D}/fitting/test_plausible.py::test_below_three_and_a_half_turns_any_may_be",),
    "folds": (f"{_D}/proof/test_cross_validation.py::test_blocks_are_dealt_out_in_turn",),
    "blocks_a_turn": (f"{_D}/proof/test_cross_validation.py::test_blocks_are_dealt_out_in_turn",),
    "heldout_slack": (f"{_D}/proof/test_selection.py::test_which_cause_stays",),
    "heldout_seen": (f"{_D}/proof/test_selection.py::test_rows_are_held_out_singly_where_a_block_as_a_whole_is_lost",),
    "shared_ratio": ("tests/diagnosis/test_several_recordings.py::test_recordings_of_two_devices_are_told",),
    "fewest_checked": (f"{_D}/stages/test_predictive_check.py::test_of_too_few_readings_nothing_is_said",),
    "predictive_sweeps": (f"{_D}/stages/test_predictive_check.py::test_a_missing_cause_is_seen",),
    "fewest_simulated": (f"{_D}/proof/test_selection.py::test_as_many_sweeps_are_simulated_as_there_is_room_for",),
    "most_simulated": (f"{_D}/proof/test_selection.py::test_as_many_sweeps_are_simulated_as_there_is_room_for",),
}
"""For each setting the tests of which at least one fails where its default is another."""


def settings() -> tuple[Mutation, ...]:
    """Two mutations for each setting; one where twice as much is noticed by no answer."""
    return tuple(mutation for one in fields(DiscoverySettings) for mutation in _of(one.name, one.default))


def halved_alone(name: str) -> bool:
    """Whether twice as much of a setting is noticed by no answer."""
    return name.startswith("most_") or name in ("fewest_simulated", "longest_spike")


def _of(name: str, default: float) -> Iterator[Mutation]:
    whole = isinstance(default, int)
    for word, factor in (("halved", 0.5), ("doubled", 2.0)):
        value = max(round(factor * default), 1) if whole else factor * default
        if (factor > 1.0 and halved_alone(name)) or _refused(name, value):
            continue
        # The range that stands behind the default stays as it is.
        line = f"    {name}: {'int' if whole else 'float'} = {_kind(name)}("
        yield Mutation(
            f"settings.{name}_{word}",
            _FILE,
            f"{line}{_written(default)}",
            f"{line}{value!r}",
            NOTICED_BY[name],
        )


def _refused(name: str, value: float) -> bool:
    """Whether no settings have this value: a program with such a default ends when it is imported."""
    try:
        DiscoverySettings(**{name: value})
    except ValueError:
        return True
    return False


def _kind(name: str) -> str:
    """The function that declares a setting: default and range."""
    found = re.search(rf"^    {name}: \w+ = (\w+)\(", (ROOT / _FILE).read_text(encoding="utf-8"), re.MULTILINE)
    assert found is not None, f"{name} is declared in another way"
    return found[1]


def _written(value: float) -> str:
    """The number as the source has it."""
    return "6e-5" if value == 6e-5 else repr(value)
