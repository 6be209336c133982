"""Mutations of the stages, of what they hand on and of the policy: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_D, _T = "diagnosis/discovery", "tests/diagnosis/discovery"

STAGES: tuple[Mutation, ...] = (
    *of_one_file(
        f"{_D}/settings.py",
        _T,
        (
            "settings.places_do_not_share_the_policy",
            "self.false_alarm_probability / FOOTPRINTS",
            "self.false_alarm_probability",
            "stages/test_repeated_frames.py::test_the_limit_is_a_quarter_of_the_policy",
        ),
        (
            "settings.effects_do_not_share_the_policy",
            "self.footprint_log_p - float(np.log(max(effects, 1)))",
            "self.footprint_log_p",
            "stages/test_quantisation.py::test_chance_is_shared_by_the_levels_that_are_tried",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/spread_check.py",
        _T,
        (
            "spread_check.nothing_is_taken_back",
            "if not gone:",
            "if True:",
            "stages/test_spread_check.py::test_what_the_proven_causes_do_not_leave_goes_and_the_rows_are_alike",
        ),
        (
            "spread_check.all_is_taken_back",
            "if effect.name not in improbable",
            "if True",
            "stages/test_spread_check.py::test_what_the_readings_bear_out_stays",
        ),
    ),
    *of_one_file(
        f"{_D}/state.py",
        _T,
        (
            "until_still.asked_again_of_what_it_left",
            "if left.get(place) is not state:",
            "if True:",
            "test_state.py::test_the_loop_ends_when_all_is_still_or_the_rounds_are_over",
        ),
        (
            "until_still.ends_after_a_round",
            "range(state.settings.most_rounds)",
            "range(1)",
            "test_pipeline.py::test_the_loop_may_be_cut_short",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/repeated_frames.py",
        _T,
        (
            "repeated_frames.asked_once",
            "range(state.settings.most_rounds)",
            "range(1)",
            "stages/test_repeated_frames.py::test_long_runs_pull_the_fit_until_they_are_masked",
        ),
    ),
    *of_one_file(
        f"{_D}/watch.py",
        _T,
        (
            "watch.a_stopped_search_loses_what_it_holds",
            "found = self._as_it_stands()",
            "found = state",
            "test_watch.py::test_what_a_stopped_search_holds_is_finished_and_proven",
        ),
        (
            "watch.an_ignored_interrupt_stops",
            "before in (signal.SIG_IGN, None)",
            "before is None",
            "test_watch.py::test_the_handler_is_put_back_and_an_ignored_interrupt_stays_ignored",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/changes.py",
        _T,
        (
            "changes.what_has_not_moved_stays_free",
            "return set_back(state.fit, [one for one in state.own if one not in free], state.given)",
            "return set_back(state.fit, [one for one in state.own if one not in state.own], state.given)",
            "stages/test_changes.py::test_what_has_changed_is_named_and_the_rest_stays",
        ),
        (
            "changes.the_other_way_round_is_the_same_device",
            "other = another_device(full, told.free, found) or counts_otherwise",
            "other = another_device(full, told.free, found)",
            "stages/test_changes.py::test_what_has_changed_is_named_and_the_rest_stays",
        ),
        (
            "changes.no_magnet_is_ever_moved",
            "if (found or state.keys or together) and not counts_otherwise:",
            "if False:",
            "stages/test_changes.py::test_a_magnet_that_was_moved_is_named_by_the_number_of_its_placement",
        ),
    ),
    *of_one_file(
        "diagnosis/mountings.py",
        "tests/diagnosis",
        (
            "mountings.a_turn_is_known_from_statements_alone",
            "turned = far and _alike(setups, fits, sweeps, place) and _turned(fits, sweeps, place)",
            "turned = False",
            "test_several_recordings.py::test_a_turned_sensor_parts_the_reference_from_the_sensor",
        ),
        (
            "mountings.a_zero_that_has_moved_is_always_a_turn",
            "turned = far and _alike(setups, fits, sweeps, place) and _turned(fits, sweeps, place)",
            "turned = far",
            "test_several_recordings.py::test_a_zero_that_has_moved_is_the_references_where_nothing_tells_otherwise",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/own_parameters.py",
        _T,
        (
            "own_parameters.events_of_another_recording_stay",
            "fit = _borne_out(fit, key)",
            "pass",
            "stages/test_changes.py::test_a_slip_of_another_recording_is_gone_from_the_twin",
        ),
    ),
    *of_one_file(
        f"{_D}/proof/changes.py",
        _T,
        (
            "changes.one_after_the_other_only",
            "_ALL_SETS = 3",
            "_ALL_SETS = 0",
            "proof/test_changes.py::test_two_that_hide_one_another_are_found_together",
        ),
        (
            "changes.three_of_many_are_another_device",
            "return moved >= _FEWEST_MOVED and 2 * moved > asked",
            "return False",
            "stages/test_changes.py::test_what_has_changed_is_named_and_the_rest_stays",
        ),
        (
            "changes.the_twin_is_exact",
            "both = a @ np.linalg.pinv(a + b, rcond=1e-12, hermitian=True) @ b",
            "both = a",
            "proof/test_changes.py::test_a_difference_is_known_as_well_as_both_of_its_sides_allow",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/held_out_selection.py",
        _T,
        (
            "held_out_selection.draws_from_the_generator_handed_in",
            "rng = deepcopy(state.rng)",
            "rng = state.rng",
            "stages/test_every_stage.py::test_a_stage_is_pure[held_out_selection-in doubt]",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/ringing.py",
        _T,
        (
            "ringing.off",
            "    if found is None:",
            "    if True:",
            "stages/test_ringing.py::test_a_bracket_that_rings_is_no_cause",
        ),
        (
            "ringing.numbers_cost_nothing",
            "likelihood(rung) + 0.5 * fewer * np.log(fit.rows)",
            "likelihood(rung) + 15.0",
            "stages/test_ringing.py::test_other_noise_does_not_ring",
        ),
        (
            "ringing.lines_stay",
            "np.all(within_band(noise, columns[np.any(columns, axis=1)], fit.observations.lengths) > 0.5)",
            "False",
            "stages/test_ringing.py::test_several_lines_of_one_band_make_way_for_it",
        ),
        (
            "ringing.every_cause_goes",
            "np.all(within_band(noise, columns[np.any(columns, axis=1)], fit.observations.lengths) > 0.5)",
            "True",
            "stages/test_ringing.py::test_several_lines_of_one_band_make_way_for_it",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/repeated_frames.py",
        _T,
        (
            "repeated_frames.not_masked",
            "after.with_(without_rows(solve(anew.fit), after.touched))",
            "after",
            "stages/test_repeated_frames.py::test_every_repeated_frame_is_named_and_masked",
        ),
        (
            "repeated_frames.named_again",
            "anew = given_back(state, effect)",
            "anew = state",
            "stages/test_repeated_frames.py::test_readings_that_the_fit_has_come_to_tell_are_given_back",
        ),
        (
            "repeated_frames.anothers_readings_given_back",
            " & ~_rows(others, state.touched.size)",
            "",
            "stages/test_repeated_frames.py::test_a_reading_that_another_finding_claims_too_stays_with_that",
        ),
        (
            "repeated_frames.earlier_claims_forgotten",
            "touched=state.touched | mask",
            "touched=mask",
            "stages/test_repeated_frames.py::test_rows_of_an_earlier_claim_stay_touched",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/variance.py",
        _T,
        (
            "variance.asked_after_a_search",
            "    if state.looked_at or several:\n",
            "    if several:\n",
            "stages/test_variance.py::test_once_a_search_has_been_made_what_it_leaves_is_judged_instead",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/spread.py",
        _T,
        (
            "spread.judged_again",
            '    if state.found("spread"):\n        return state\n',
            "",
            "stages/test_spread.py::test_it_is_judged_once",
        ),
        (
            "spread.scale_without_a_cause_stays",
            "        if np.all(fit.observations.scale == fit.observations.level):\n            return state\n",
            "        return state\n",
            "stages/test_spread.py::test_a_scale_that_no_cause_carries_goes",
        ),
        (
            "spread.no_family_to_pay_for",
            "effect_log_p(family)",
            "effect_log_p(1)",
            "stages/test_spread.py::test_what_is_named",
        ),
        (
            "spread.no_doubt_beside_a_shape_without_a_name",
            " - (odds if any(map(unnamed, state.keys)) else 0.0)",
            "",
            "stages/test_spread.py::test_what_is_named",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/stepwise.py",
        _T,
        (
            "stepwise.radius_never_trusted",
            "        found = trusting(state.fit, state.searched, state.step, kept_out, tell)\n",
            "        pass\n",
            "stages/test_stepwise.py::test_what_the_radius_shows_is_taken_for_causes_first",
        ),
        (
            "stepwise.stopped_it_trusts_the_radius",
            "radius_trusted=False",
            "radius_trusted=True",
            "test_watch.py::test_what_rests_on_a_trusted_radius_does_not_stand_when_stopped",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/grid_cause.py",
        _T,
        (
            "grid_cause.beside_another_set",
            ' or state.found("values")',
            "",
            "stages/test_grid_cause.py::test_no_rounding_beside_another_finite_set",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/final_fit.py",
        _T,
        (
            "final_fit.baseline_keeps_the_causes_stairs",
            "baseline.chain.without(*stairs)",
            "baseline.chain",
            "stages/test_final_fit.py::test_the_baseline_is_the_error_model_without_any_cause",
        ),
        (
            "final_fit.edges_without_slopes",
            "with_slopes(fit)",
            "fit",
            "stages/test_final_fit.py::test_the_weight_of_a_stuck_bit_is_that_of_the_optimum",
        ),
    ),
    *of_one_file(
        f"{_D}/stages/answer.py",
        _T,
        (
            "answer.a_merged_entry_gains_what_the_next_does",
            "present = frozenset(itertools.chain.from_iterable(predicted[:count]))",
            "present = frozenset(itertools.chain.from_iterable(predicted[:count + 1]))",
            "stages/test_answer.py::test_of_stairs_what_knowing_them_gains",
        ),
        (
            "answer.figures_of_averages",
            "[of_readings(rms_deg(residual, observations.usable), observations) for residual in held]",
            "[rms_deg(residual, observations.usable) for residual in held]",
            "stages/test_answer.py::test_figures_are_those_of_single_readings",
        ),
    ),
    *of_one_file(
        f"{_D}/marks/row_numbers.py",
        "tests/diagnosis/report",
        (
            "row_numbers.rejected_rows_are_counted",
            " - sum(1 for rejected in sweep.rejected if rejected < number)",
            "",
            "test_answer.py::test_a_noisy_stretch_is_told_by_the_rows_of_the_file",
        ),
    ),
    *of_one_file(
        "diagnosis/report/fitted_rows.py",
        "tests/diagnosis/report",
        (
            "fitted_rows.share_of_rows_set_aside",
            "return rows if rows.any() else np.ones_like(rows)",
            "return np.ones_like(rows)",
            "test_agreement.py::test_the_cases_show_what_they_are_for",
        ),
    ),
)
