"""Mutations of what is made of a log without a reference: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_SMOOTHER = "tests/diagnosis/spin/test_smoother.py"
_SEARCH = "tests/diagnosis/spin/test_search.py"
_STRETCHES = "tests/diagnosis/spin/test_stretches.py"
_MOTION = "tests/twin/test_estimated_motion.py"
_EXPLAIN = "tests/diagnosis/spin/test_explain.py"
_LEVELS = "tests/diagnosis/discovery/stages/test_recording_levels.py"
_SIDES = "tests/diagnosis/discovery/search/test_one_sided.py"
_BENCH = "tests/scenarios/bench/test_spin.py"
_FRAMES = "tests/diagnosis/discovery/stages/test_repeated_frames.py"

SPINS: tuple[Mutation, ...] = tuple(
    Mutation(name, file, old, new, (test,))
    for name, file, old, new, test in (
        (
            "spins.torques_are_the_sensors",
            "diagnosis/spin/smoother.py",
            "    if several_speeds(found.rates[0]):\n",
            "    if False:\n",
            f"{_SMOOTHER}::test_a_coast_tells_the_sensor_from_a_torque_of_the_same_order",
        ),
        (
            "spins.a_wave_in_time_is_motion",
            "diagnosis/spin/problem.py",
            "least = 2.0 * PENALISED",
            "least = -9.0 * PENALISED",
            f"{_SMOOTHER}::test_a_wave_in_time_is_no_motion",
        ),
        (
            "spins.a_late_channel_is_a_torque",
            "diagnosis/spin/smoother.py",
            "    if third_speed and _late_channel_told(reduced, variance, usual_rad_s):\n",
            "    if False:\n",
            f"{_SMOOTHER}::test_an_error_that_grows_with_the_speed_is_no_torque",
        ),
        (
            "spins.a_torque_is_a_late_channel",
            "diagnosis/spin/smoother.py",
            "        if likelier > _SURELY:\n",
            "        if True:\n",
            f"{_SMOOTHER}::test_a_torque_at_two_speeds_is_no_channel_read_late",
        ),
        (
            "spins.three_speeds_take_the_rotor_for_one_piece",
            "diagnosis/report/motion.py",
            "if two_speeds_alone(speed) else []",
            "if True else []",
            f"{_EXPLAIN}::test_what_two_speeds_tell_takes_the_rotor_for_one_piece",
        ),
        (
            "spins.a_reading_each_second_is_told_of_as_any",
            "diagnosis/report/motion.py",
            '    if motion["reading_every_s"] > STOP_AND_MEASURE_S:\n',
            "    if False:\n",
            f"{_EXPLAIN}::test_a_reading_each_second_may_be_one_each_millisecond[1000.0]",
        ),
        (
            "spins.a_high_order_is_no_torque",
            "diagnosis/report/motion.py",
            "        open_orders += _orders_beyond(fit, keys)\n",
            "        pass\n",
            f"{_EXPLAIN}::test_a_cogging_of_a_higher_order_than_is_looked_for_may_be_a_torque_too",
        ),
        (
            "spins.two_speeds_tell_what_grows",
            "diagnosis/spin/smoother.py",
            "not two_speeds_alone(speed_rad_s)",
            "True",
            f"{_SMOOTHER}::test_what_grows_with_the_speed_takes_a_third_one",
        ),
        (
            "spins.what_grows_does_so_by_half_at_the_median",
            "diagnosis/spin/smoother.py",
            "float(np.sqrt(np.mean(speed_rad_s**2)))",
            "usual_rad_s",
            f"{_SMOOTHER}::test_what_is_not_told_to_grow_is_taken_to_by_about_half_in_the_mean_square",
        ),
        (
            "spins.a_shaft_is_undamped",
            "diagnosis/spin/smoother.py",
            "        if self.log_penalty is None or self.terms is None or",
            "        if True or",
            f"{_SMOOTHER}::test_how_a_shaft_goes_over_to_a_speed_tells_how_it_answers_to_a_torque",
        ),
        (
            "spins.a_jerk_is_as_rough_as_any",
            "diagnosis/spin/damping.py",
            "bare.holding(evened(stiffness, even.rough @ pilot), even.damping_per_s)",
            "even",
            f"{_SMOOTHER}::test_how_a_shaft_goes_over_to_a_speed_tells_how_it_answers_to_a_torque",
        ),
        (
            "spins.the_damping_is_known",
            "diagnosis/spin/torques.py",
            "found.damping_sd_per_s * damped[None]",
            "0.0 * damped[None]",
            f"{_SMOOTHER}::test_a_torque_is_as_well_known_as_the_damping",
        ),
        (
            "spins.a_torque_is_weak",
            "diagnosis/spin/smoother.py",
            "readings=self.readings - self._beyond_first_order(),",
            "readings=self.readings,",
            f"{_SMOOTHER}::test_a_strong_torque_is_no_error_of_twice_its_order",
        ),
        (
            "spins.the_double_of_a_tooth_is_no_torque",
            "diagnosis/report/motion.py",
            "        if effect.comb is not None:\n",
            "        if False:\n",
            f"{_EXPLAIN}::test_a_cogging_and_its_double_may_be_a_torque_too",
        ),
        (
            "spins.all_logs_are_one",
            "diagnosis/spin/of_log.py",
            "    own = None if len(logs) == 1 else ",
            "    own = None if logs else ",
            f"{_SMOOTHER}::test_each_of_two_logs_has_a_noise_and_a_motion_of_its_own",
        ),
        (
            "spins.dry_friction_stays",
            "diagnosis/spin/smoother.py",
            "if both_ways else []",
            "if False else []",
            f"{_SMOOTHER}::test_dry_friction_reverses_with_the_direction",
        ),
        (
            "spins.candidates_are_not_whitened",
            "diagnosis/discovery/search/screening.py",
            "observables_to_cosine(fit.observations, without_nuisance(fit.observations, columns))",
            "observables_to_cosine(fit.observations, columns)",
            f"{_SEARCH}::test_a_candidate_gains_to_first_order_what_it_gains_in_the_fit",
        ),
        (
            "spins.no_torque_widens_an_interval",
            "diagnosis/discovery/fitting/intervals.py",
            "if (free.key, free.name) not in found or by_torques == 0.0:",
            "if True:",
            f"{_EXPLAIN}::test_what_a_torque_may_have_done_is_in_the_intervals",
        ),
        (
            "spins.what_grows_at_most_is_forgotten",
            "diagnosis/spin/smoother.py",
            "np.minimum(half, most_growing)",
            "half",
            f"{_SMOOTHER}::test_what_is_known_to_grow_no_more_leaves_an_error_better_known",
        ),
        (
            "spins.a_cogging_grows_with_the_speed",
            "diagnosis/spin/smoother.py",
            "np.clip(np.max(half[:_OF_RUN_OUT]), np.minimum(1e-9, beyond), beyond)",
            "beyond",
            f"{_EXPLAIN}::test_at_two_speeds_a_cogging_does_not_grow[not seen]",
        ),
        (
            "spins.turns_tell_no_more_than_one",
            "twin/magnet/magnet_harmonic.py",
            "2 * order < motion.angles_in_a_turn",
            "2 * order < motion.points_per_turn",
            "tests/twin/test_magnet_harmonic.py::test_turns_at_other_angles_tell_finer_structure",
        ),
        (
            "spins.no_ringing_without_a_reference",
            "diagnosis/discovery/fitting/noise/ringing.py",
            "if len(fit.observations.lengths) > 1 and fit.observations.motion.estimated is None:",
            "if len(fit.observations.lengths) > 1 or fit.observations.motion.estimated is not None:",
            "tests/diagnosis/discovery/stages/test_ringing.py"
            "::test_without_a_reference_a_bearing_that_rings_is_no_cause",
        ),
        (
            "spins.every_wave_is_of_a_usb",
            "diagnosis/report/motion.py",
            "usb = abs(frequency - USB_FRAMES_HZ) < resolved",
            "usb = True",
            f"{_EXPLAIN}::test_a_wave_in_time_may_be_times_that_are_told_wrong",
        ),
        (
            "spins.a_wave_in_time_stands_in_the_factors",
            "diagnosis/discovery/result.py",
            ' and (e.line is None or e.line.clock != "time")',
            "",
            f"{_EXPLAIN}::test_at_one_speed_a_ripple_of_the_reference_is_two_waves_in_time",
        ),
        (
            "spins.lines_are_matched_to_torques",
            "diagnosis/discovery/search/screening.py",
            "weighted if observations.loose is None else observations.loose.whitened(weighted)",
            "weighted",
            f"{_SEARCH}::test_lines_are_matched_to_what_torques_do_not_make",
        ),
        (
            "spins.figures_count_the_motion",
            "diagnosis/discovery/fitting/coefficients.py",
            "np.where(np.isfinite(angles), left - moved, np.nan)",
            "angles",
            f"{_SEARCH}::test_residuals_are_without_what_the_shaft_may_have_done",
        ),
        (
            "spins.behind_a_rounding_no_torque",
            "diagnosis/report/motion.py",
            "fit.chain.without(*rounding)",
            "fit.chain",
            "tests/diagnosis/spin/test_explain.py::test_behind_a_rounding_too_a_cause_may_be_a_torque",
        ),
        (
            "spins.readings_far_off_count",
            "diagnosis/spin/smoother.py",
            "_FAR_OUT = 6.0",
            "_FAR_OUT = 1e9",
            f"{_SMOOTHER}::test_readings_far_off_are_left_out",
        ),
        (
            "spins.a_jerk_counts",
            "diagnosis/spin/of_log.py",
            "_FREE = 3.0",
            "_FREE = 1e9",
            f"{_SMOOTHER}::test_a_jerk_is_set_aside",
        ),
        (
            "spins.each_log_alone",
            "diagnosis/spin/speeds.py",
            "return bool(fast - slow > LEAST_SPEEDS * fast)",
            "return False",
            f"{_SMOOTHER}::test_two_logs_of_one_speed_each_tell_together_what_neither_tells",
        ),
        (
            "spins.a_swing_within_a_turn_is_a_second_speed",
            "diagnosis/spin/smoother.py",
            "    if several_speeds(found.rates[0]):\n",
            "    if _several_speeds(np.diff(readings_rad) / np.diff(time_s)):\n",
            f"{_SMOOTHER}::test_a_torque_that_speeds_the_shaft_up_and_slows_it_down_makes_no_second_speed",
        ),
        (
            "spins.a_shaft_that_stands_repeats_a_frame",
            "twin/link/stale_frames.py",
            "move = np.minimum(move, _moved_about(measured, repeat))",
            "pass",
            f"{_FRAMES}::test_without_a_reference_a_shaft_that_a_torque_holds_sends_no_frame_again",
        ),
        (
            "spins.a_current_makes_no_torque",
            "diagnosis/report/motion.py",
            'if any(need.startswith("two currents") for effect in effects.values() for need in effect.needs):',
            "if False:",
            f"{_EXPLAIN}::test_what_grows_with_the_current_may_be_the_torque_that_the_current_makes",
        ),
        (
            "spins.a_repeated_frame_may_be_a_torque",
            "diagnosis/report/motion.py",
            'if not open_orders or not any(effect.footprint in ("mean", "values") for effect in effects.values()):',
            "if not open_orders or not keys:",
            f"{_EXPLAIN}::test_a_frame_that_is_sent_again_is_no_torque",
        ),
        (
            "spins.a_search_cut_short_is_silent_on_torques",
            "diagnosis/report/as_well.py",
            "return may_be_torque(found, cause)",
            "return []",
            f"{_EXPLAIN}::test_a_search_that_was_cut_short_says_too_what_may_be_a_torque",
        ),
        (
            "spins.levels_by_a_median_of_steps",
            "diagnosis/discovery/stages/recording_levels.py",
            "bounded_rms(np.diff(one, 2))",
            "np.median(np.abs(np.diff(one, 2)))",
            f"{_LEVELS}::test_noise_near_a_step_of_the_word_makes_no_recording_louder",
        ),
        (
            "spins.one_side_is_a_ripple",
            "diagnosis/discovery/search/screening.py",
            "gains = np.where(one_sided(base, effect, effect.line, shapes), 0.0, gains)",
            "pass",
            f"{_SIDES}::test_a_wave_on_one_side_is_no_ripple",
        ),
        (
            "spins.a_side_that_nobody_sees_is_there",
            "diagnosis/discovery/search/screening.py",
            "beside = np.maximum(together - np.max(gain, axis=0) ** 2, 0.0)",
            "beside = together",
            f"{_SIDES}::test_a_side_that_the_shafts_own_motion_hides_leaves_a_wave_without_a_name",
        ),
        (
            "spins.rows_out_of_use_keep_their_torque",
            "diagnosis/spin/torques.py",
            "np.where(self._usable, of_used, along @ self._columns)",
            "of_used",
            f"{_SMOOTHER}::test_rows_out_of_use_lose_what_the_others_tell",
        ),
        (
            "spins.a_reading_far_off_counts_a_turn",
            "diagnosis/spin/stretches.py",
            "step = expected + wrap(step - expected)",
            "pass",
            f"{_STRETCHES}::test_a_reading_far_off_counts_no_turn",
        ),
        (
            "spins.a_gap_is_bridged",
            "diagnosis/spin/stretches.py",
            "_GAP = 20.0",
            "_GAP = 1e9",
            f"{_STRETCHES}::test_after_a_gap_a_stretch_begins_anew",
        ),
        (
            "spins.a_mean_is_as_noisy_as_a_reading",
            "twin/estimated_motion.py",
            "self.noise_rad / float(np.sqrt(np.mean(count)))",
            "self.noise_rad",
            f"{_MOTION}::test_averaged_rows_are_further_apart",
        ),
        (
            "spins.rows_left_out_end_no_stretch",
            "twin/estimated_motion.py",
            "broken = (np.diff(rows) != 1) | (np.diff(self.stretch[rows]) != 0)",
            "broken = np.diff(self.stretch[rows]) != 0",
            f"{_MOTION}::test_a_stretch_ends_where_rows_are_left_out",
        ),
        (
            "spins.the_benchs_shaft_is_held",
            "scenarios/bench/world.py",
            "            if self._let_go:\n",
            "            if False:\n",
            f"{_BENCH}::test_a_coast_is_what_the_encoder_reads_of_a_shaft_that_friction_slows",
        ),
        (
            "spins.the_memory_of_a_run_before",
            "scenarios/bench/hall_node.py",
            '        if not values["Count"]:\n            self._memory = None\n        elif',
            "        if",
            f"{_BENCH}::test_a_bench_that_stays_spins_anew_for_each_run",
        ),
        (
            "spins.the_drive_counts_legs_on",
            "scenarios/bench/nodes.py",
            "        self._leg = None\n",
            "",
            f"{_BENCH}::test_a_bench_that_stays_spins_anew_for_each_run",
        ),
    )
)
