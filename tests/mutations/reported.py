"""Mutations of what the reported cases called for: told by them, or by the tests of the part."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_CASES = "tests/reported_cases/test_reported_cases.py"
_HARD = f"{_CASES}::test_a_draw_that_was_hard_is_answered_rightly"
_SELECTION = "tests/diagnosis/discovery/proof/test_selection.py"
_WATCH = "tests/diagnosis/discovery/test_watch.py"

_COUNTS = "tests/twin/test_whole_counts.py"

REPORTED = (
    Mutation(
        "reference_quantisation.the_way_tells_the_rounding",
        "twin/reference/reference_quantisation.py",
        "return recorded.off",
        "return np.zeros(len(motion))",
        (f"{_CASES}::test_a_sweep_of_the_kind_is_answered_rightly[coarse_reference]",),
    ),
    Mutation(
        "motor_field.drag_draws_a_current",
        "twin/magnet/motor_field.py",
        "krpm, field = motion.speed_rad_s / KRPM,",
        "krpm, field = 0.0 * motion.speed_rad_s,",
        (f"{_CASES}::test_a_sweep_of_the_kind_is_answered_rightly[field_of_drag]",),
    ),
    Mutation(
        "motor_field.the_current_turns_with_the_shaft",
        "twin/magnet/motor_field.py",
        '"two currents|two speeds|both directions"',
        '"two currents|two speeds"',
        ("tests/diagnosis/discovery/test_seam_and_current.py::test_a_field_of_drag_turns_its_sign_with_the_direction",),
    ),
    Mutation(
        "stale_frames.a_count_is_a_movement",
        "twin/link/stale_frames.py",
        "np.maximum(move - TAU / motion.whole_counts.counts_per_turn, 0.0)",
        "move",
        (
            "tests/diagnosis/discovery/stages/test_repeated_frames.py"
            "::test_two_counts_of_a_coarse_reference_may_be_a_movement_of_one",
        ),
    ),
    Mutation(
        "whole_counts.decimals_of_a_radian",
        "twin/whole_counts.py",
        "if decimal is not None and decimal * _MOST_COUNTS > TAU:",
        "if False:",
        (
            f"{_COUNTS}::test_decimals_of_a_radian_are_counts_of_which_a_turn_has_no_whole_number",
            f"{_CASES}::test_a_sweep_of_the_kind_is_answered_rightly[printed]",
        ),
    ),
    Mutation(
        "whole_counts.decimals_spread_a_count",
        "twin/whole_counts.py",
        "spread = np.sinc(decimal) * np.exp(",
        "spread = np.exp(",
        (f"{_COUNTS}::test_an_encoder_of_which_few_decimals_are_printed_is_told_by_its_counts",),
    ),
    Mutation(
        "quantisation.each_turn_from_its_own_zero",
        "twin/link/output_quantisation.py",
        "np.where(_is_whole(count), 0.0, np.floor(signal / TAU) * TAU)",
        "0.0",
        (
            "tests/diagnosis/discovery/marks/test_quantisation.py"
            "::test_hundredths_of_a_radian_are_a_grid_from_each_turns_zero",
        ),
    ),
    Mutation(
        "whole_counts.stretches_overlap",
        "twin/whole_counts.py",
        "first += max(many // 2, 1)",
        "first += max(many, 1)",
        (f"{_COUNTS}::test_a_slow_wow_is_followed",),
    ),
    Mutation(
        "whole_counts.stops_are_read_several_times",
        "twin/whole_counts.py",
        "((False, counts), (True, counts[_stops(counts)]))",
        "((False, counts),)",
        (f"{_COUNTS}::test_an_even_way_tells_where_between_two_counts_each_reading_was",),
    ),
    Mutation(
        "motion.a_part_knows_what_the_whole_told",
        "twin/motion.py",
        "found.__dict__.update(recorded_rad=self.recorded_rad[rows], whole_counts=whole)",
        "pass",
        (f"{_COUNTS}::test_a_part_of_the_rows_knows_what_all_of_them_told",),
    ),
    Mutation(
        "variance.far_off_together_is_loud",
        "diagnosis/discovery/stages/variance.py",
        "bursts(fit) if rough is not None and rough.log_p < limit else None",
        "bursts(fit)",
        (
            "tests/diagnosis/discovery/stages/test_variance.py::test_what_is_off_together_is_no_louder",
            f"{_HARD}[seam-6]",
        ),
    ),
    Mutation(
        "selection.what_the_zero_does_too_is_seen",
        "diagnosis/discovery/proof/selection.py",
        "projected(columns[strength], columns[~own])",
        "columns[strength]",
        (f"{_SELECTION}::test_a_step_is_seen_by_the_rows_on_its_shorter_side[12-0.0]", f"{_HARD}[slips-46]"),
    ),
    Mutation(
        "index_slip.its_own_jump_is_a_change_of_speed",
        "twin/reference/index_slip.py",
        "return float(np.median(steps)) if steps.size else 0.0",
        "return float(np.mean(motion.speed_rad_s[rows]))",
        (f"{_HARD}[slips-37]",),
    ),
    Mutation(
        "quantisation.a_tables_index_tells_of_a_set",
        "diagnosis/discovery/marks/quantisation.py",
        "if np.ptp(np.diff(different, append=different[0] + cells)) <= 2:",
        "if False:",
        (f"{_HARD}[table_of_firmware-4]",),
    ),
    Mutation(
        "details.a_radius_is_freed_in_angles",
        "twin/magnet/magnet_harmonic.py",
        'told_by=frozenset({"vx"}),',
        "",
        (
            "tests/diagnosis/discovery/search/test_details.py"
            "::test_a_detail_that_the_channels_tell_is_left_alone_in_angles",
        ),
    ),
    Mutation(
        "as_read.signs_of_the_computed_angle",
        "diagnosis/report/as_read.py",
        'if output_sense < 0 and effect.acts_on == "angle" else values',
        "if False else values",
        ("tests/diagnosis/report/test_as_read.py::test_a_bump_of_the_error_is_a_bump",),
    ),
    Mutation(
        "watch.the_budget_is_looked_at_between_stages_alone",
        "diagnosis/discovery/watch.py",
        "        watch.end_if_spent()\n\n    try:",
        "        del number\n\n    try:",
        (f"{_WATCH}::test_a_budget_ends_a_stage_that_says_nothing",),
    ),
    Mutation(
        "watch.a_tick_sets_the_timer_anew",
        "diagnosis/discovery/watch.py",
        "        signal.signal(signal.SIGPROF, signal.SIG_IGN)\n",
        "",
        (f"{_WATCH}::test_a_tick_as_the_timer_goes_does_not_set_it_anew",),
    ),
    Mutation(
        "selection.rounding_is_a_share",
        "diagnosis/discovery/proof/selection.py",
        "shown = squares > 1e-12 * np.sum(slopes[strength] ** 2, axis=(1, 2))",
        "shown = squares > 0.0",
        (f"{_SELECTION}::test_what_the_others_do_wholly_is_no_evidence_of_either",),
    ),
    Mutation(
        "watch.the_budget_is_no_end",
        "diagnosis/discovery/watch.py",
        "            raise Stopped\n        self.end_if_spent()",
        "            raise Stopped",
        (f"{_WATCH}::test_a_search_that_has_spent_its_budget_is_finished_and_proven",),
    ),
    Mutation(
        "stuck_bit.edges_as_sharp_as_readings_have_them",
        "diagnosis/discovery/marks/stairs.py",
        "            chain = chain.with_effect(effect.name, **{BLUR: found})\n",
        "            del found\n",
        ("tests/hidden/physics/test_stuck_bit.py::test_the_weight_of_a_stuck_bit_is_within_its_interval",),
    ),
    Mutation(
        "stuck_bit.far_ends_are_passed_over",
        "twin/adc/adc_stuck_bit.py",
        "NEAR = 0.25",
        "NEAR = 1.0",
        ("tests/twin/test_stuck_bit.py::test_the_mean_is_that_over_the_noise",),
    ),
    Mutation(
        "selection.what_needs_more_to_be_assumed_is_named",
        "diagnosis/discovery/proof/selection.py",
        "return other.handicap < own.handicap and likelihood(rival)",
        "return False and likelihood(rival)",
        ("tests/hidden/physics/test_placed.py::test_a_magnet_out_of_place_is_named_before_what_needs_more",),
    ),
    Mutation(
        "selection.a_further_part_is_another_cause",
        "diagnosis/discovery/proof/selection.py",
        "if name in {base_name(key) for key in proof.ordered if key != cause.key}:",
        "if False:",
        (
            "tests/hidden/physics/test_placed.py"
            "::test_a_magnet_out_of_place_is_named_before_what_needs_more[block_raw-1929401729]",
        ),
    ),
    Mutation(
        "mains_pickup.hum_is_a_pure_tone",
        "twin/hall/mains_pickup.py",
        "        multiples=HARMONICS,\n",
        "",
        ("tests/hidden/physics/test_hum.py::test_hum_and_its_harmonics_are_one_cause",),
    ),
    Mutation(
        "adc_inl.lower_bits_make_up_for_all",
        "twin/adc/adc_inl.py",
        "np.clip(left, 0.0, 2.0 ** (1 - last))",
        "left",
        ("tests/twin/test_adc_inl.py::test_weights_that_are_off_do_what_a_successive_approximation_does[2-12.0]",),
    ),
    *of_one_file(
        "diagnosis/discovery/proof/selection.py",
        "tests/diagnosis/discovery/proof/test_conditional.py",
        (
            "selection.neighbours_foretell_nothing",
            "told = [unforeseen(fit, residual) for residual in held] if narrow else held",
            "told = held",
            "::test_what_follows_its_neighbours_gains_nothing[True-False]",
        ),
    ),
    *of_one_file(
        "diagnosis/discovery/proof/conditional.py",
        "tests/diagnosis/discovery/proof/test_conditional.py",
        (
            "conditional.a_row_foretells_itself",
            "pulled / _diagonal(weight, observations.lengths) * observations.scale",
            "pulled * observations.scale",
            "::test_each_row_is_left_out_of_the_noise_that_foretells_it",
        ),
    ),
    *of_one_file(
        "twin/logs/unasked.py",
        "tests/untidy/test_unasked.py",
        (
            "logs.a_sweeps_own_names_are_guessed_at",
            "if guess and (_in_capitals(log.guess.columns) or not _bears_names_of_a_sweep(log.table)):",
            "if guess:",
            "::test_what_goes_against_a_sweeps_own_names_is_refused_and_told",
        ),
        (
            "logs.capitals_are_other_names",
            "_in_capitals(log.guess.columns) or ",
            "",
            "::test_names_in_capitals_are_those_names",
        ),
        (
            "logs.a_statement_is_advised_that_is_refused_itself",
            '            raise SweepError(f"{error} (read as {option})") from None',
            "            raise SweepError(str(self.why)) from None",
            "::test_what_is_wrong_under_the_statement_that_fits_is_told",
        ),
        (
            "logs.a_long_log_is_not_looked_at",
            "most = self.max_bytes if missing else LARGEST_READ_TWICE",
            "most = LARGEST_READ_TWICE",
            "::test_a_long_log_is_read_by_its_guess",
        ),
    ),
    *of_one_file(
        "twin/logs/guess.py",
        "tests/untidy/test_doubtful.py",
        (
            "logs.an_electrical_angle_of_the_shafts_is_a_sensor",
            "if len(found) == 1 and found[0][2].is_one_sensors(",
            "if len(found) > 9 and found[0][2].is_one_sensors(",
            "::test_an_electrical_angle_made_of_the_shafts_is_asked_about",
        ),
    ),
    *of_one_file(
        "twin/logs/names.py",
        "tests/untidy/test_doubtful.py",
        (
            "logs.millimetres_are_an_angle",
            'if unit is not None and quantity not in ("angle", *_BY_QUANTITY) and len(unit.name) > 1:',
            "if False:",
            "::test_what_has_another_unit_is_no_angle",
        ),
        (
            "logs.a_capital_t_is_a_time",
            "return _OF_EITHER.get(name.strip()) or _of_words(name)",
            "return _of_words(name)",
            "::test_a_capital_t_is_no_time_beside_one_that_has_a_unit",
        ),
    ),
    *of_one_file(
        "twin/logs/candidates.py",
        "tests/untidy/test_doubtful.py",
        (
            "logs.a_counter_of_rows_is_a_reference",
            "        if unit.counts and counts_rows(table.values[k], said[k]):",
            "        if False:",
            "::test_a_counter_of_rows_is_asked_about",
        ),
        (
            "logs.a_zero_makes_another_sensor",
            "copied = any(is_one_sensors(a, b, one.units) for one in fitting)",
            "copied = any(is_copy(a, b, one.units) for one in fitting)",
            "::test_one_sensor_that_stands_twice_is_asked_about[another zero]",
        ),
        (
            "logs.no_name_of_a_reference_is_needed",
            "    if not said[one.reference].reference and one.weight != swapped:",
            "    if False:",
            "::test_one_sensor_before_and_behind_its_filter_is_asked_about",
        ),
        (
            "logs.a_sensors_own_counts_are_its_reference",
            "    if copied and one.weight < _NAMED_BOTH:",
            "    if False:",
            "::test_one_sensor_that_stands_twice_is_asked_about",
        ),
    ),
    *of_one_file(
        "twin/logs/angles.py",
        "tests/untidy/test_doubtful.py",
        (
            "logs.what_counts_the_other_way_is_another_sensor",
            "for error in (b - a, b + a))",
            "for error in (b - a,))",
            "::test_one_sensor_that_stands_twice_is_asked_about[the other way]",
        ),
        (
            "logs.a_few_degrees_are_radians",
            "        return kept if whole else [_BOTH_RAD, _BOTH_DEG]",
            "        return kept",
            "::test_a_few_degrees_and_most_of_a_turn_in_radians_are_asked_about",
        ),
        (
            "logs.a_short_span_beside_degrees_is_radians",
            "            own.append(degrees)",
            "            pass",
            "::test_a_short_span_beside_degrees_is_in_degrees",
        ),
    ),
)
