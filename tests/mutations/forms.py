"""Mutations of what keeps one physical cause under one name: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_PROFILE = "tests/diagnosis/discovery/fitting/test_profile.py"
_FORMS = "tests/diagnosis/discovery/test_forms.py"
_LISTED = "tests/diagnosis/discovery/stages/test_listed.py"
_DETAILS = "tests/diagnosis/discovery/search/test_details.py"

FORMS: tuple[Mutation, ...] = tuple(
    Mutation(name, file, old, new, (test,))
    for name, file, old, new, test in (
        (
            "forms.steep_structure_has_no_scatter",
            "diagnosis/discovery/marks/outliers.py",
            "max(robust_rms(local_residual(residual)), LEFT_BY_MEDIAN * rms_of_second_differences(residual))",
            "robust_rms(local_residual(residual))",
            "tests/diagnosis/discovery/stages/test_row_masks.py"
            "::test_structure_that_rises_by_more_than_the_noise_masks_no_row",
        ),
        (
            "forms.saturation_is_always_cubic",
            "twin/concentrator/saturation.py",
            'fitted_shapes=("exponent",)',
            "fitted_shapes=()",
            f"{_FORMS}::test_any_curve_that_falls_behind_is_one_saturation",
        ),
        (
            "forms.a_stop_counts_as_recorded",
            "twin/motion.py",
            "way = as_reached(shaft, way_of(shaft, direction, speed_rad_s))",
            "way = way_of(shaft, direction, speed_rad_s)",
            f"{_FORMS}::test_a_stack_of_plays_is_one_hysteresis",
        ),
        (
            "forms.every_likelihood_is_a_parabola",
            "diagnosis/discovery/fitting/profile.py",
            "CURVED = 0.05",
            "CURVED = np.inf",
            f"{_PROFILE}::test_a_weak_amplitude_and_its_phase",
        ),
        (
            "forms.a_profile_fits_nothing_beside",
            "diagnosis/discovery/fitting/joint_fit.py",
            "left = projected(*self.whitened())",
            "left, _ = self.whitened()",
            f"{_PROFILE}::test_a_weak_amplitude_and_its_phase",
        ),
        (
            "forms.strengths_pass_through_zero_without_a_phase",
            "diagnosis/discovery/fitting/free_parameters.py",
            ' and param.lower == 0.0 and bool(effect.roles("phase"))',
            " and param.lower == 0.0",
            "tests/diagnosis/discovery/fitting/test_joint_fit.py::test_a_strength_without_a_phase_ends_at_its_bound",
        ),
        (
            "forms.a_reference_slips_once",
            "twin/reference/index_slip.py",
            "    repeatable=True,\n",
            "",
            f"{_FORMS}::test_a_reference_that_loses_counts_several_times_slips",
        ),
        (
            "forms.a_ripple_is_a_sine",
            "twin/adc/reference_ripple.py",
            ", multiples=(2, 3, 4, 5)",
            "",
            f"{_FORMS}::test_a_ripple_with_harmonics_is_one_reference_ripple",
        ),
        (
            "forms.a_drive_has_any_order",
            "diagnosis/discovery/search/forward_step.py",
            " and not of_one_source(effect)",
            "",
            f"{_FORMS}::test_a_drive_has_one_order_and_its_multiples",
        ),
        (
            "forms.no_channel_is_cut_off_by_a_third",
            "twin/adc/clipping.py",
            "*np.geomspace(3.0, 35.0, 12), *np.arange(40.0, 84.0, 2.0), ",
            "84.0, ",
            f"{_FORMS}::test_a_range_may_cut_off_nearly_all_or_one_end_alone[0.15-ends0]",
        ),
        (
            "forms.no_search_sets_an_s",
            "diagnosis/discovery/search/forward_step.py",
            "for form in (effect, *effect.sought_alone)",
            "for form in (effect,)",
            f"{_FORMS}::test_a_curve_that_runs_ahead_is_an_s_of_the_converter[0.02-True]",
        ),
        (
            "forms.the_range_of_an_s_is_known",
            "twin/effect.py",
            "replace(form, fitted_shapes=self.fitted_shapes) for form in forms",
            "form for form in forms",
            f"{_FORMS}::test_a_curve_that_runs_ahead_is_an_s_of_the_converter[0.02-True]",
        ),
        (
            "forms.an_s_bends_either_way",
            "twin/adc/adc_inl.py",
            "sought=(-LARGEST_S_LSB, 0.0)",
            "sought=(-LARGEST_S_LSB, LARGEST_S_LSB)",
            "tests/twin/test_adc_inl.py::test_an_s_that_a_saturation_may_be_is_not_sought",
        ),
        (
            "forms.a_stuck_bit_has_one_wave",
            "diagnosis/discovery/search/periodogram.py",
            "for phase, form in effect.line.waves:",
            "for phase, form in effect.line.waves[:2]:",
            f"{_FORMS}::test_a_bit_stuck_inside_the_approximation_is_a_stuck_bit",
        ),
        (
            "forms.a_bump_ends_at_its_bound",
            "diagnosis/discovery/search/likelihood_ratio.py",
            "return bool(effect.kind) and not all(inside)",
            "return False",
            f"{_FORMS}::test_a_field_that_bends_beside_the_shaft_is_no_bump",
        ),
        (
            "forms.offsets_do_not_creep",
            "twin/empirical/__init__.py",
            "    UNNAMED_CREEP,\n    UNNAMED_BUMP",
            "    UNNAMED_BUMP",
            f"{_FORMS}::test_an_offset_that_creeps_after_switching_on_is_seen",
        ),
        (
            "forms.a_twist_leaves_the_errors_where_they_are",
            "twin/empirical/orders.py",
            'acts_on="shaft"',
            'acts_on="angle"',
            f"{_FORMS}::test_a_shaft_that_drag_twists_is_one_thing",
        ),
        (
            "forms.no_flanks",
            "twin/empirical/__init__.py",
            "    UNNAMED_FLANKS,\n    UNNAMED_SEAM",
            "    UNNAMED_SEAM",
            f"{_FORMS}::test_a_play_under_weight_is_one_thing",
        ),
        (
            "forms.an_axis_returns_in_a_straight_line",
            "twin/concentrator/hysteresis.py",
            "** np.asarray(fall)",
            "** 1.0",
            "tests/twin/test_lag_of_axes.py::test_is_what_plays_of_all_radii_up_to_one_do",
        ),
        (
            "forms.plays_forget_where_they_were",
            "twin/concentrator/hysteresis.py",
            "        held = states[..., -1]",
            "        held = at[-1] - rising * width + np.zeros_like(weight)",
            "tests/twin/test_lag_of_axes.py::test_is_what_plays_of_all_radii_up_to_one_do",
        ),
        (
            "forms.a_shape_before_a_cause_in_detail",
            "diagnosis/discovery/search/forward_step.py",
            "    trials += _in_the_place_of_a_shape(fit, ranked, near, threshold)\n",
            "",
            f"{_FORMS}::test_an_offset_behind_the_oven_is_one_drift",
        ),
        (
            "forms.the_sensor_is_as_warm_as_the_oven",
            "twin/hall/body_temperature.py",
            "motion.temperature_c - NOMINAL_C + _behind(motion, np.asarray(lag_s, dtype=np.float64))",
            "motion.temperature_c - NOMINAL_C",
            f"{_FORMS}::test_an_offset_behind_the_oven_is_one_drift",
        ),
        (
            "forms.a_detail_alone_is_nothing",
            "diagnosis/discovery/fitting/intervals.py",
            "for name in effect.acts_by if name in free",
            "for name in effect.acts_by if name in free and not effect.params[name].detail",
            f"{_LISTED}::test_a_detail_may_be_all_that_there_is_of_a_cause",
        ),
        (
            "forms.a_detail_counts_twice",
            "diagnosis/discovery/fitting/intervals.py",
            "for name in effect.acts_by if name in free",
            "for name in (*effect.acts_by, *(n for n, p in effect.params.items() if p.detail)) if name in free",
            f"{_LISTED}::test_a_detail_that_acts_through_a_strength_does_not_count_beside_it",
        ),
        (
            "forms.a_shape_acts_only_through_a_strength",
            "twin/effect.py",
            "if param.role in acting or param.by_itself",
            "if param.role in acting",
            "tests/twin/test_by_itself.py::test_a_stage_that_is_off_acts_alone",
        ),
        (
            "exchange.asked_again_in_the_same_fit",
            "diagnosis/discovery/search/exchange.py",
            "if stood is not None and stood.seen_in is fit:",
            "if False:",
            "tests/diagnosis/discovery/search/test_exchange.py"
            "::test_a_cause_that_stood_its_ground_is_not_asked_again_in_the_same_fit",
        ),
        (
            "exchange.every_examination_is_by_exact_fits",
            "diagnosis/discovery/search/exchange.py",
            "if paying is not None and paying.beats_still(",
            "if False and paying is not None and paying.beats_still(",
            "tests/diagnosis/discovery/search/test_exchange.py"
            "::test_what_stood_by_far_stands_without_another_fit_while_no_lead_changes",
        ),
        (
            "standing.a_rival_may_draw_as_near_as_it_likes",
            "diagnosis/discovery/search/standing.py",
            "if drawn_nearer >= removal.fit.settings.rival_share * contest.lost_by:",
            "if False:",
            "tests/diagnosis/discovery/search/test_exchange.py"
            "::test_what_stood_is_asked_again_once_a_rival_has_drawn_nearer",
        ),
        (
            "forward_step.the_last_digits_choose",
            "diagnosis/discovery/search/forward_step.py",
            "key=lambda one: trials[one].candidate.effect.stage in _AROUND_THE_SENSOR",
            "key=judged.__getitem__",
            "tests/diagnosis/discovery/search/test_forward_step.py"
            "::test_of_causes_that_do_the_same_the_sensors_own_leads",
        ),
        (
            "tidy.a_tidy_fit_is_evaluated_again",
            "diagnosis/discovery/search/likelihood_ratio.py",
            "held_anew(fit) if chain is fit.chain else evaluate(",
            "evaluate(",
            "tests/diagnosis/discovery/fitting/test_tidy.py::test_a_fit_that_is_tidy_is_not_evaluated_again",
        ),
        (
            "standing.any_order_is_the_same_rival",
            "diagnosis/discovery/search/standing.py",
            "(float(round(value * span)) if span > 0.0 else value,)",
            "()",
            "tests/diagnosis/discovery/search/test_standing.py::test_another_order_or_frequency_is_another_rival",
        ),
        (
            "standing.a_cause_may_pay_as_little_as_it_likes",
            "diagnosis/discovery/search/standing.py",
            "now is not None and now - self.log_p < fit.settings.rival_share * room",
            "now is not None",
            "tests/diagnosis/discovery/search/test_exchange.py::test_what_stood_is_asked_again_once_it_pays_less",
        ),
        (
            "forms.no_detail_is_freed",
            "diagnosis/discovery/search/exchange.py",
            "detailed(retuned(fit, held), held, plan.threshold, plan.effects)",
            "retuned(fit, held)",
            f"{_FORMS}::test_plays_on_each_axis_are_one_hysteresis",
        ),
        (
            "forms.a_detail_before_another_cause",
            "diagnosis/discovery/search/details.py",
            "return plain if _by_another_cause(plain, effects, keys, min(level, surely))",
            "return plain if np.inf",
            f"{_DETAILS}::test_a_detail_stays_at_its_null_where_another_cause_does_it",
        ),
        (
            "forms.details_cost_nothing",
            "diagnosis/discovery/search/details.py",
            "    if log_p >= level:\n        return plain\n",
            "",
            f"{_DETAILS}::test_a_detail_that_says_nothing_goes_back_to_its_null",
        ),
        (
            "forms.nothing_is_done_behind",
            "diagnosis/discovery/fitting/linearised_chain.py",
            "changed = changed + self._changed(one, old, new, batch, None)",
            "pass",
            f"{_FORMS}::test_a_tracking_loop_is_one_latency",
        ),
    )
)
