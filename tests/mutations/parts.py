"""Mutations of marks, search, fits and proof: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_D, _T = "diagnosis/discovery", "tests/diagnosis/discovery"

PARTS: tuple[Mutation, ...] = (
    *of_one_file(
        f"{_D}/marks/outliers.py",
        _T,
        (
            "outliers.what_comes_again_is_masked",
            "mask & ~_repeated(away, mask, motion)",
            "mask",
            "stages/test_row_masks.py::test_which_rows_are_masked",
        ),
        (
            "outliers.steps_of_the_grid_are_masked",
            "far_out(residual, settings) + step",
            "far_out(residual, settings)",
            "stages/test_row_masks.py::test_which_rows_are_masked",
        ),
    ),
    *of_one_file(
        f"{_D}/fitting/observations.py",
        _T,
        (
            "observations.short_steps_that_lead_onward_are_no_repeats",
            "short & ~(together & onward[run])",
            "short",
            "fitting/test_observations.py::test_short_steps_that_lead_onward_are_no_repeats",
        ),
    ),
    *of_one_file(
        f"{_D}/marks/row_masks.py",
        _T,
        (
            "row_masks.channels_never_fall_out",
            "(np.abs(radius - np.median(radius)) < settings.fallen_out)",
            "True",
            "stages/test_row_masks.py::test_channels_that_fall_out_are_masked",
        ),
        (
            "row_masks.loud_rows_stand_alone",
            "fit.residual[0] / scale",
            "fit.residual[0]",
            "stages/test_row_masks.py::test_a_loud_row_stands_alone_among_rows_as_loud",
        ),
        (
            "row_masks.claimed_rows_come_back",
            " & ~rows_of(fit.observations, also)",
            "",
            "stages/test_row_masks.py::test_which_rows_are_masked",
        ),
    ),
    *of_one_file(
        f"{_D}/marks/sequence.py",
        _T,
        (
            "sequence.no_family_to_pay_for",
            "effect_log_p(family)",
            "effect_log_p(1)",
            "stages/test_repeated_frames.py::test_a_claim_is_believed_by_its_probability",
        ),
        (
            "sequence.rows_belong_to_several_effects",
            "np.where(spoken_for, 0.0, raw_residual(fit, sweep))",
            "raw_residual(fit, sweep)",
            "stages/test_flipped_bits.py::test_the_words_that_were_hit_are_named",
        ),
    ),
    *of_one_file(
        f"{_D}/marks/quantisation.py",
        _T,
        (
            "quantisation.readings_outside_cost_nothing",
            " + missed * -np.log(settings.set_missed)",
            "",
            "marks/test_quantisation.py::test_chance_is_the_share_of_the_words_to_the_power_of_the_readings",
        ),
        (
            "quantisation.levels_cost_nothing",
            " + np.log(len(tried) * len(CELLS_OFF))",
            "",
            "stages/test_quantisation.py::test_chance_is_shared_by_the_levels_that_are_tried",
        ),
        (
            "quantisation.no_family_to_pay_for",
            "if values and log_p < settings.effect_log_p(family)",
            "if values and log_p < settings.footprint_log_p",
            "stages/test_quantisation.py::test_chance_is_shared_by_the_levels_that_are_tried",
        ),
        (
            "quantisation.correlated_squares_count_in_full",
            "fit.rows / float(np.mean(spectrum**2))",
            "float(fit.rows)",
            "stages/test_grid_cause.py::test_stairs_are_seen_by_fewer_readings_in_correlated_noise",
        ),
        (
            "quantisation.every_reading_counts",
            "distinct = different.size",
            "distinct = words.size",
            "marks/test_quantisation.py::test_readings_of_one_word_count_once",
        ),
    ),
    *of_one_file(
        f"{_D}/marks/spread.py",
        _T,
        (
            "spread.tails_taken_for_unevenness",
            "return max(float(np.var(square / np.mean(square))) / 2.0, 1.0)",
            "return 1.0",
            "marks/test_spread.py",
        ),
        (
            "spread.looks_of_a_stretch_cost_nothing",
            " + float(np.log(max(stretch.looks, 1)))",
            "",
            "marks/test_spread.py::test_even_noise_has_a_loud_stretch_hardly_ever",
        ),
        (
            "spread.judged_behind_the_scale",
            "    loud = fit.observations.scale / fit.observations.level\n",
            "    loud = 1.0\n",
            "marks/test_spread.py::test_what_the_rows_scale_has_taken_out_is_put_back",
        ),
        (
            "spread.six_times_the_mean_is_far_out",
            "near = np.minimum(square, _FARTHEST * profile * float(np.mean(near / profile)))",
            "pass",
            "marks/test_spread.py::test_few_readings_at_the_highest_speed_tell_it_in_full",
        ),
        (
            "spread.a_filter_shares_nothing",
            " * both.inflation(float(np.mean(weights**2)) / white**2)",
            "",
            "marks/test_spread.py::test_beside_coloured_noise_an_uncertain_instant_is_as_large_as_it_is",
        ),
        (
            "spread.the_fit_takes_nothing",
            "(left + taken)",
            "(left)",
            "marks/test_spread.py::test_what_the_fit_has_taken_of_a_row_is_put_back",
        ),
        (
            "spread.white_noise_passes_a_filter_unchanged",
            "white = float(np.mean(weights))",
            "white = 1.0",
            "marks/test_spread.py::test_beside_coloured_noise_an_uncertain_instant_is_as_large_as_it_is",
        ),
    ),
    *of_one_file(
        f"{_D}/search/exchange.py",
        _T,
        (
            "exchange.nothing_is_removed",
            "    idle = paying is None and removal.log_p + handicap(removal.effect, fit) > level\n",
            "    idle = False\n",
            "search/test_exchange.py::test_what_becomes_of_the_causes_held",
        ),
        (
            "exchange.nothing_is_exchanged",
            "        if lost_by < 0.0:\n",
            "        if False:\n",
            "search/test_exchange.py::test_what_becomes_of_the_causes_held",
        ),
        (
            "exchange.zeros_of_the_turns_are_not_tried",
            ', *(c for c in ranked[most:] if c.effect.roles("per turn"))',
            "",
            "search/test_exchange.py::test_no_more_rivals_are_tried_than_may_be_but_zeros_of_the_turns_are",
        ),
        (
            "exchange.any_share_is_fair",
            "fair = min(np.diff(gains)) > fit.settings.fair_share * gains[-1]",
            "fair = True",
            "search/test_exchange.py::test_named_causes_take_the_place_of_a_shape_that_they_explain",
        ),
        (
            "exchange.coarse_stairs_ask_no_more",
            "threshold = min(threshold, -fit.settings.stairs_log_odds)",
            "pass",
            "search/test_exchange.py::test_beside_coarse_stairs_only_what_is_beyond_doubt_counts",
        ),
    ),
    *of_one_file(
        f"{_D}/search/forward_step.py",
        _T,
        (
            "forward_step.first_order_decides",
            "[: settings.most_contenders]",
            "[:1]",
            "search/test_forward_step.py::test_the_exact_fit_decides_among_those_near_the_best",
        ),
        (
            "forward_step.stuck_bits_are_not_found_afresh",
            '        if effect.line is None or effect.line.clock != "channels":\n',
            "        if True:\n",
            "search/test_forward_step.py::test_a_stuck_bit_is_found_afresh_once_the_rest_is_known",
        ),
        (
            "forward_step.multiples_are_not_looked_for",
            "    found += multiples(base, effects, keys)\n",
            "",
            "search/test_forward_step.py::test_multiples_of_a_line_are_among_the_candidates",
        ),
        (
            "forward_step.everyone_is_a_contender",
            "if c.gain > fit.settings.fair_share * chosen.gain}",
            "}",
            "search/test_forward_step.py::test_who_explains_a_fair_share_is_remembered",
        ),
    ),
    *of_one_file(
        f"{_D}/search/rivals.py",
        _T,
        (
            "rivals.not_held_against_the_cause",
            "return trial if gained(trial) > gain - _same(fit, trial) else None",
            "return trial",
            "search/test_rivals.py::test_as_good_is_within_three_sigma_and_beside_coarse_stairs_within_six",
        ),
        (
            "rivals.what_an_angle_never_names_is_none",
            "if other.acts_in(provides) and not",
            "if False and not",
            "search/test_rivals.py::test_which_causes_cannot_be_told_apart[harmonic of order 3]",
        ),
        (
            "rivals.factors_may_be_of_any_size",
            "usual = with_usual_factors(fit)",
            "usual = fit",
            "search/test_rivals.py::test_which_causes_cannot_be_told_apart[saturation in a turn]",
        ),
        (
            "rivals.more_usual_factors_are_enough",
            "if _reads_as_well(rival, fit)",
            "if True",
            "stages/test_rival_fits.py::test_a_displaced_magnet_is_in_the_class_of_the_order_that_it_makes",
        ),
        (
            "rivals.details_are_none",
            "for names in effect.stand_aside:",
            "for names in ():",
            "search/test_rivals.py::test_a_detail_that_no_search_sets_is_a_rival_by_itself",
        ),
        (
            "rivals.left_short_of_their_optimum",
            "iterations=TO_THE_END",
            "iterations=12",
            "stages/test_rival_fits.py::test_a_displaced_magnet_is_in_the_class_of_the_order_that_it_makes",
        ),
    ),
    *of_one_file(
        f"{_D}/search/likelihood_ratio.py",
        _T,
        (
            "likelihood.weights_may_be_off_by_anything",
            "and fit.free[k].name in effect.drawn]",
            "and fit.free[k].turn is not None]",
            "search/test_likelihood_ratio.py::test_a_converters_weights_pay_for_the_room_that_they_have",
        ),
    ),
    *of_one_file(
        f"{_D}/search/screening.py",
        _T,
        (
            "screening.draws_are_sizes_like_any",
            "    if drawn := effect.drawn_of(terms):",
            "    if drawn := 0:",
            "search/test_likelihood_ratio.py::test_to_first_order_draws_pay_half_the_log_of_their_evidence",
        ),
    ),
    *of_one_file(
        f"{_D}/search/every_start.py",
        _T,
        (
            "every_start.one_is_enough",
            "    return (own, *(fit for fit in fits if likelihood(fit) > least))",
            "    return (own,)",
            "stages/test_rival_fits.py::test_every_fit_is_as_good_and_its_open_shape_is_held_somewhere_else",
        ),
        (
            "every_start.worse_ones_too",
            "if likelihood(fit) > least",
            "if True",
            "stages/test_rival_fits.py::test_every_fit_is_as_good_and_its_open_shape_is_held_somewhere_else",
        ),
        (
            "every_start.of_what_the_sweep_shows_too",
            "    if effect.visible_in(motion.provides):",
            "    if False:",
            "stages/test_rival_fits.py::test_of_what_the_sweep_shows_by_itself_there_is_the_one_fit",
        ),
    ),
    *of_one_file(
        f"{_D}/search/iterate.py",
        _T,
        (
            "iterate.an_unexplained_radius_is_trusted",
            "return found if _radius_explained(found.fit) else None",
            "return found",
            "search/test_iterate.py::test_all_that_the_radius_does_has_to_be_the_work_of_causes",
        ),
        (
            "iterate.ends_with_the_first_round",
            "        if found.keys == before and np.array_equal(",
            "        if True or np.array_equal(",
            "search/test_iterate.py::test_rows_that_stand_alone_only_once_the_causes_are_known_are_masked",
        ),
    ),
    *of_one_file(
        f"{_D}/search/likelihood_ratio.py",
        _T,
        (
            "likelihood_ratio.looks_cost_nothing",
            "log_probability(np.array(gain), terms, dof)) + float(np.log(looks))",
            "log_probability(np.array(gain), terms, dof))",
            "search/test_likelihood_ratio.py::test_the_probability_is_that_of_an_f_test_at_the_best_of_so_many_looks",
        ),
        (
            "likelihood_ratio.each_turn_costs_a_coefficient",
            "return terms - effect.drawn_of(terms) or 1",
            "return terms",
            "search/test_likelihood_ratio.py::test_zeros_of_the_turns_cost_the_one_scatter_that_they_are_drawn_with",
        ),
    ),
    *of_one_file(
        f"{_D}/fitting/initial_fit.py",
        _T,
        (
            "initial_fit.turns_have_one_zero",
            "    if each_turn and turns > 1:\n",
            "    if False:\n",
            "stages/test_initial_fit.py::test_of_a_given_twin_the_zeros_alone_are_free",
        ),
    ),
    *of_one_file(
        f"{_D}/fitting/noise/plausible.py",
        _T,
        (
            "plausible.structure_passes_for_colour",
            "_Aside.of(to_cosine(observations, locked_shapes(observations.motion)), family)",
            "_Aside.of(np.zeros((0, len(observations))), family)",
            "fitting/test_plausible.py::test_structure_that_repeats_with_the_angle_is_no_colour",
        ),
    ),
    *of_one_file(
        f"{_D}/proof/selection.py",
        _T,
        (
            "selection.narrow_shapes_are_held_out_as_a_whole",
            "    if narrow:",
            "    if not narrow:",
            "proof/test_selection.py::test_rows_are_held_out_singly_where_a_block_as_a_whole_is_lost",
        ),
        (
            "selection.stairs_are_not_looked_behind",
            "    if fit.weighting.member == 0 or grid is None or grid.name not in fit.chain.values:\n",
            "    if True:\n",
            "proof/test_selection.py::test_in_coloured_noise_a_cause_must_stand_without_the_outputs_stairs_too",
        ),
        (
            "selection.the_kindest_view_judges",
            "    return max((judge(view",
            "    return min((judge(view",
            "proof/test_selection.py::test_the_least_favourable_view_judges",
        ),
    ),
    *of_one_file(
        "diagnosis/discovery/further/another_recording.py",
        "tests/diagnosis/discovery/further",
        (
            "further.the_sensor_stays_as_it_was",
            "setups[0].turned_deg - setups[one].turned_deg",
            "0.0",
            "test_second_recording.py::test_an_error_of_the_sensor_in_two_mountings_by_hand",
        ),
        (
            "further.as_quiet_in_the_weaker_field",
            "seen[0] * float(factor)",
            "seen[0]",
            "test_power.py::test_a_second_air_gap_parts_a_coercive_field_from_a_play",
        ),
    ),
    *of_one_file(
        "diagnosis/discovery/search/rivals.py",
        "tests/diagnosis/discovery/further",
        (
            "rivals.shapes_that_follow_the_noise_part_them",
            "    return float(chdtri(1 + more, chdtrc(1, usual))) if more else usual",
            "    return usual",
            "test_second_recording.py::test_shapes_that_follow_the_noise_do_not_part_what_one_sweep_cannot",
        ),
    ),
)
