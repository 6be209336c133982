"""Mutations of the discovery: each mechanism of the search and of the proof off, and each stage left out."""

from __future__ import annotations

import re

from tests.mutations.mutation import ROOT, Mutation

_TESTS = "tests/diagnosis/discovery"
_STEPWISE = f"{_TESTS}/stages/test_stepwise.py::test_two_causes_that_pass_for_something_else_are_found"
_SELECTION = f"{_TESTS}/proof/test_selection.py::test_which_cause_stays"

_MECHANISMS: tuple[Mutation, ...] = (
    Mutation(
        "cross_validation.fits_see_held_out_rows",
        "diagnosis/discovery/proof/cross_validation.py",
        "fit.observations.masked(split.seen)",
        "fit.observations",
        (
            f"{_TESTS}/proof/test_cross_validation.py::test_a_wild_value_in_a_held_out_fold_moves_no_other_reading_of_it",
        ),
        short=True,
    ),
    Mutation(
        "selection.held_out_check_removed",
        "diagnosis/discovery/proof/selection.py",
        "return weighed[-1] < slack * weighed[-2]",
        "return True",
        (_SELECTION,),
        short=True,
    ),
    Mutation(
        "selection.chance_allowed",
        "diagnosis/discovery/proof/selection.py",
        "    if proof.by_chance(cause) > settings.footprint_log_p:\n",
        "    if False:\n",
        (_SELECTION,),
    ),
    Mutation(
        "selection.a_class_by_its_first_member",
        "diagnosis/discovery/proof/selection.py",
        "        return min((own, *(",
        "        return max((own, *(",
        (f"{_TESTS}/proof/test_selection.py::test_a_class_is_as_unlikely_by_chance_as_its_least_likely_member",),
    ),
    Mutation(
        "order.as_found",
        "diagnosis/discovery/proof/order.py",
        "expected[place]))",
        "0.0))",
        (f"{_TESTS}/proof/test_order.py::test_the_stronger_comes_first_wherever_it_stood",),
    ),
    Mutation(
        "order.without_names_among_them",
        "diagnosis/discovery/proof/order.py",
        "(unnamed(base_name(blocks[place][0])), ",
        "(False, ",
        (f"{_TESTS}/proof/test_order.py::test_what_has_no_name_comes_last_however_strong",),
    ),
    Mutation(
        "order.parameters_cost_nothing",
        "diagnosis/discovery/proof/order.py",
        "max(freedom - sum(strengths[place]), 1) ** 2",
        "1.0",
        (f"{_TESTS}/proof/test_order.py::test_of_two_that_do_the_same_the_one_of_fewer_parameters_comes_first",),
    ),
    Mutation(
        "joint_fit.zeros_draw_themselves_to_nothing",
        "diagnosis/discovery/fitting/joint_fit.py",
        "    return spread / float(np.sqrt(share)) if share > 1e-9 else spread\n",
        "    return spread\n",
        (f"{_TESTS}/fitting/test_turns_zeros.py::test_they_are_the_same_from_afar",),
    ),
    Mutation(
        "as_well.no_fault_of_the_words_has_a_rival",
        "diagnosis/report/as_well.py",
        "    if also is not None and also.where(",
        "    if False and also.where(",
        (
            "tests/diagnosis/report/test_as_well.py::test_one_turn_from_the_word_0_may_have_drifted",
            "tests/diagnosis/report/test_as_well.py::test_a_word_that_holds_once_may_be_a_frame_repeated",
        ),
    ),
    Mutation(
        "motor_field.turns_with_the_sensor",
        "twin/magnet/motor_field.py",
        "add(signal, *along_axes(bx / field, by / field, motion))",
        "add(signal, bx / field, by / field)",
        ("tests/twin/test_each_recording.py::test_a_motor_that_stays_where_it_is_is_seen_from_another_side",),
    ),
    Mutation(
        "sequence.loud_rows_repeat_frames",
        "diagnosis/discovery/marks/sequence.py",
        "    scale = fit.observations.scale[fit.observations.group]\n",
        "    scale = np.ones(fit.observations.group.size)\n",
        (f"{_TESTS}/stages/test_repeated_frames.py::test_loud_noise_may_cancel_the_movement",),
    ),
    Mutation(
        "radius_nuisance.masked_rows_keep_the_scale",
        "diagnosis/discovery/fitting/nuisance.py",
        "np.linalg.pinv(factors.T) @ everywhere",
        "np.linalg.pinv(factors.T) @ (everywhere * observations.usable)",
        (f"{_TESTS}/stages/test_row_masks.py::test_a_row_that_is_in_its_place_comes_back",),
    ),
    Mutation(
        "spread.speed_is_an_angle",
        "twin/found_by.py",
        "isinstance(spread, OverSpeed)",
        "False",
        (f"{_TESTS}/marks/test_spread.py::test_an_uncertain_instant_scatters_by_the_speed",),
    ),
    Mutation(
        "selection.slack_for_all",
        "diagnosis/discovery/proof/selection.py",
        "settings.heldout_slack if cause.log_p < settings.beyond_doubt_log_p else 1.0",
        "settings.heldout_slack",
        (_SELECTION,),
    ),
    Mutation(
        "sense_check.off",
        "diagnosis/discovery/stages/sense_check.py",
        "    if likelihood(other) - plan.threshold * len(state.keys) <= here:\n",
        "    if True:\n",
        (f"{_TESTS}/stages/test_sense_check.py::test_what_fits_better_by_the_odds_is_taken",),
        short=True,
    ),
    Mutation(
        "sense_check.nothing_left_out",
        "diagnosis/discovery/stages/sense_check.py",
        "        if score[idlest] <= plan.threshold:\n",
        "        if True:\n",
        (
            f"{_TESTS}/stages/test_sense_check.py::"
            "test_a_cause_that_stood_in_for_the_quadratic_term_is_left_out_in_the_other_sense",
        ),
    ),
    Mutation(
        "listed.intervals_not_asked",
        "diagnosis/discovery/stages/listed.py",
        "    if may_be_nothing:\n",
        "    if False:\n",
        (f"{_TESTS}/stages/test_listed.py::test_a_cause_that_may_be_nothing_is_dropped_and_the_rest_fitted_anew",),
    ),
    Mutation(
        "listed.grid_not_asked",
        "diagnosis/discovery/stages/listed.py",
        " or find(key, state.fit.chain.effects).output_grid",
        "",
        (
            f"{_TESTS}/stages/test_listed.py::test_a_grid_with_which_held_out_readings_are_no_nearer_does_not_limit_them",
        ),
    ),
    Mutation(
        "listed.gain_not_asked",
        "diagnosis/discovery/stages/listed.py",
        "cause.after_deg >= cause.before_deg",
        "False",
        (f"{_TESTS}/stages/test_listed.py::test_a_cause_without_held_out_gain_is_dropped",),
    ),
    Mutation(
        "verdict.misfits_pass",
        "diagnosis/discovery/result.py",
        "without_name or bool(self.misfits)",
        "without_name",
        (f"{_TESTS}/proof/test_lack_of_fit.py::test_angles_that_are_off_are_told_with_place_and_size",),
    ),
    Mutation(
        "search.several_in_place_of_one_off",
        "diagnosis/discovery/search/stepwise.py",
        "        fit, held = in_its_place(fit, key, held, plan)\n",
        "        pass\n",
        (f"{_STEPWISE}[a drift without a name]",),
        short=True,
    ),
    Mutation(
        "search.joint_additions_off",
        "diagnosis/discovery/search/stepwise.py",
        " or best_together(fit, base, offered, held, level)",
        "",
        (f"{_STEPWISE}[coloured noise]",),
        short=True,
    ),
    Mutation(
        "search.re_tuning_off",
        "diagnosis/discovery/search/forward_step.py",
        "settle(retuned(step.fit, keys))",
        "settle(step.fit)",
        (f"{_STEPWISE}[edges that were shifted]",),
        short=True,
    ),
)


_WHOLE = frozenset({"observe", "initial_fit", "row_masks", "variance", "listed"})
"""Stages whose absence shows in more than the answer: each has a test of its own among those of the pipeline."""
_SEVERAL = "tests/diagnosis/test_several_recordings.py"
_ELSEWHERE = {
    "recording_levels": f"{_SEVERAL}::test_one_set_of_parameters_explains_both",
    "recordings_alone": f"{_SEVERAL}::test_recordings_of_two_devices_are_told",
    "spread_check": f"{_TESTS}/stages/test_spread_check.py::test_beside_lines_that_the_proof_takes_out_again",
}
"""Stages that do nothing to a single sweep, or only to one that has to be drawn for them."""


def stages_left_out() -> tuple[Mutation, ...]:
    """One mutation for each stage that the pipeline lists."""
    file = "diagnosis/discovery/pipeline.py"
    source = (ROOT / file).read_text(encoding="utf-8")
    listed = source[source.index("\nPIPELINE") :]
    tests = f"{_TESTS}/test_pipeline.py"
    one = f"{tests}::test_without_a_stage_the_answer_is_another"
    return tuple(
        Mutation(
            f"pipeline.{found[1]}_left_out",
            file,
            found[0],
            "",
            (_ELSEWHERE.get(found[1], tests if found[1] in _WHOLE else f"{one}[{found[1]}]"),),
        )
        for found in re.finditer(r"^ +(\w+),  # .*\n", listed, re.MULTILINE)
    )


DISCOVERY: tuple[Mutation, ...] = (*_MECHANISMS, *stages_left_out())
