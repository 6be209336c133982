"""Mutations of what stands beside the causes, a motion or an effect that they hide, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file, of_one_test

_D, _T = "diagnosis/discovery", "tests/diagnosis/discovery"
_SECOND = "tests/diagnosis/spin/test_second_inertia.py"
_SWUNG = "tests/twin/test_second_inertia.py"
_BESIDE = "tests/diagnosis/spin/test_causes_beside_motion.py"

BESIDE: tuple[Mutation, ...] = (
    *of_one_file(
        f"{_D}/fitting/open_effects.py",
        _T,
        (
            "open_effects.what_is_told_is_hidden_too",
            "    if left**2 > (1.0 - _TAKEN) * alone**2 or alone == 0.0:\n",
            "    if alone == 0.0:\n",
            "fitting/test_open_effects.py::test_a_harmonic_of_another_order_hides_none",
        ),
        (
            "open_effects.nothing_is_hidden",
            "        if strongest > 0.0:\n",
            "        if False:\n",
            "fitting/test_open_effects.py::test_a_harmonic_of_order_4_hides_a_saturation_and_its_figures_hold_both",
        ),
        (
            "open_effects.what_is_improbable_widens_as_much",
            "    odds = after / before * float(np.exp(0.5 * min(gain, _SURE)))\n",
            "    odds = 1.0\n",
            "fitting/test_open_effects.py::test_what_is_improbable_beside_a_cause_widens_its_interval_by_little",
        ),
    ),
    *of_one_file(
        "diagnosis/report/beside_class.py",
        _T,
        (
            "beside_class.a_cause_is_as_known_as_named",
            "    for each in beside_each(known, found).values():\n",
            "    for each in ():\n",
            "fitting/test_open_effects.py::test_a_harmonic_of_order_4_hides_a_saturation_and_its_figures_hold_both",
        ),
    ),
    *of_one_test(
        "spins",
        "tests/scenarios/test_without_reference.py",
        (
            "logs_for_a_check_are_of_one_device",
            "scenarios/commands/inputs.py",
            "    groups = [sweeps] if together else",
            "    groups = [sweeps] if True else",
            "test_logs_for_a_check_need_not_be_of_one_device",
        ),
        (
            "a_torque_is_a_fault_of_the_correction",
            "scenarios/commands/compensate_judge.py",
            "            (not_told if one.with_torques else larger).append(words)\n",
            "            larger.append(words)\n",
            "test_what_torques_may_do_is_no_fault_of_the_correction",
        ),
        (
            "rows_set_aside_are_not_said",
            "scenarios/commands/correction_sources.py",
            "            if motion.rows_aside\n",
            "            if False\n",
            "test_rows_that_tell_no_turning_are_counted",
        ),
        (
            "nothing_is_said_of_a_check_without_a_reference",
            "scenarios/commands/correction_sources.py",
            ", *checked.motion_lines()]\n",
            "]\n",
            "test_a_correction_is_tried_on_another_log_without_a_reference",
        ),
    ),
    *of_one_test(
        "second_inertia",
        _SECOND,
        (
            "a_rotor_is_always_of_one_piece",
            "diagnosis/spin/smoother.py",
            "undamped().tied() if passes else None\n",
            "undamped().tied() if False else None\n",
            "test_a_coast_tells_the_belt_and_with_it_the_sensor",
        ),
        (
            "a_hum_is_a_resonance",
            "diagnosis/spin/second_inertia.py",
            "    beside = profile.beside_a_wave(found.second)\n",
            "    beside = profile\n",
            "test_the_way_from_one_speed_to_another_of_one_piece_tells_none",
        ),
        (
            "any_gain_will_do",
            "diagnosis/spin/second_inertia.py",
            "if _log_odds(profile, one) > _SURELY]\n",
            "if True]\n",
            "test_the_way_from_one_speed_to_another_of_one_piece_tells_none",
        ),
        (
            "a_swing_passes_for_a_damping",
            "diagnosis/spin/smoother.py",
            "        return replace(self, damped=False).rounds()\n",
            "        return self.rounds()\n",
            "test_a_swing_does_not_pass_for_a_damping",
        ),
        (
            "two_steady_speeds_are_searched",
            "diagnosis/spin/smoother.py",
            "and not two_speeds_alone(found.rates[0])",
            "",
            "test_two_steady_speeds_pass_no_resonance",
        ),
        (
            "a_resonance_needs_no_damping",
            "diagnosis/spin/second_inertia.py",
            "    told = [one for one in within if",
            "    told = [one for one in found if",
            "test_two_hums_of_the_torque_are_no_resonance",
        ),
        (
            "the_way_between_two_speeds_is_forgotten",
            "diagnosis/spin/of_log.py",
            "most_growing=fit.growing, second=fit.second)",
            "most_growing=fit.growing)",
            "test_the_way_from_one_speed_to_another_tells_it",
        ),
        (
            "it_is_known_exactly",
            "diagnosis/spin/torques.py",
            "    if found.second is not None:\n",
            "    if False:\n",
            "test_the_way_from_one_speed_to_another_tells_it",
        ),
        (
            "it_is_not_of_one_piece_for_all_that",
            "diagnosis/report/motion.py",
            "    open_to_it = estimated.second is None and two_speeds_alone(speed)\n",
            "    open_to_it = two_speeds_alone(speed)\n",
            "test_the_answer_says_so",
        ),
    ),
    *of_one_test(
        "second_inertia",
        _SWUNG,
        (
            "a_swing_follows_at_once",
            "twin/second_inertia.py",
            "        out[0] = size[0] / (turning[0] - pole)\n",
            "        return size / (turning - pole)\n",
            "test_a_coast_passes_the_resonance_as_the_equations_of_motion_say",
        ),
        (
            "a_step_is_no_longer_than_a_swing",
            "twin/second_inertia.py",
            "            if last == first + 1:\n",
            "            if False:\n",
            "test_of_one_step_longer_than_any_swing_the_next_is_steady",
        ),
        (
            "a_swing_never_dies_in_one_piece",
            "twin/second_inertia.py",
            "_BLOCK = 20.0\n",
            "_BLOCK = 1e9\n",
            "test_a_swing_that_has_long_died_away_is_worked_out_without_overflow",
        ),
    ),
    *(
        Mutation(name, file, old, new, (test,))
        for name, file, old, new, test in (
            (
                "spins.torques_turn_a_shaft_with_a_reference",
                "diagnosis/spin/torques.py",
                "    return np.where(found.knee_rad > 0.0, moved, 0.0)\n",
                "    return moved\n",
                "tests/diagnosis/spin/test_beside_a_reference.py::test_torques_turn_no_shaft_that_a_reference_tells",
            ),
            (
                "spins.a_coast_slows_by_two_terms",
                "twin/mechanics/torque_ripple.py",
                "    even = (1.0 + 11.0 * x + 8.0 * x**2) / (1.0 + 14.0 * x + 35.0 * x**2)\n",
                "    even = 1.0 - 3.0 * x\n",
                "tests/twin/test_torque_ripple.py::test_the_response_is_that_of_the_equation_of_motion",
            ),
            (
                "spins.the_motion_takes_all_threads",
                "diagnosis/explain.py",
                "    with one_blas_thread(), listening, ended_by_budget(watch):\n",
                "    with listening, ended_by_budget(watch):\n",
                "tests/diagnosis/spin/test_explain.py::test_the_motion_is_a_stage_and_who_stops_there_gets_what_there_is",
            ),
            (
                "spins.no_stage_for_the_motion",
                "diagnosis/spin/of_log.py",
                "        begins(MOTION)\n",
                "        pass\n",
                "tests/diagnosis/spin/test_explain.py::test_the_motion_is_a_stage_and_who_stops_there_gets_what_there_is",
            ),
            (
                "as_read.what_is_as_named_stays_in_the_middle",
                "diagnosis/report/as_read.py",
                'moved(*figure["as_named"])',
                'figure["as_named"]',
                "tests/diagnosis/report/test_as_read.py::test_the_interval_as_named_turns_with_the_figure",
            ),
            (
                "spins.two_speeds_tell_an_order_that_follows_them",
                "twin/motion.py",
                "        if not two_speeds_alone(self.speed_rad_s):\n",
                "        if True:\n",
                "tests/diagnosis/spin/test_search.py"
                "::test_what_follows_the_speed_takes_a_third_one_beside_torques[speeds0]",
            ),
            (
                "spins.two_logs_tell_an_order_that_follows_the_speed",
                "twin/motion.py",
                '            "three speeds": not two_speeds_alone(self.speed_rad_s),\n',
                '            "three speeds": True,\n',
                "tests/diagnosis/spin/test_search.py"
                "::test_what_follows_the_speed_takes_a_third_one_beside_torques[speeds0]",
            ),
            (
                "spins.one_pass_of_an_angle_tells",
                "diagnosis/spin/of_log.py",
                "turns < max(1.0, 2.0 * passed)",
                "turns < 1.0",
                "tests/diagnosis/spin/test_explain.py::test_what_is_no_spin_is_refused_with_the_reason",
            ),
            (
                "spins.torques_scatter_about_what_was_found",
                "diagnosis/discovery/fitting/joint_fit.py",
                " + observations.torques\n",
                "\n",
                "tests/diagnosis/spin/test_search.py"
                "::test_what_a_torque_may_be_scatters_about_none_and_not_about_what_was_found",
            ),
            (
                "spins.the_motion_is_as_free_against_any_noise",
                "diagnosis/discovery/stages/motion_freedom.py",
                "    if not 0.0 < noise_rad < (1.0 - _CHANGED) * estimated.noise_rad:\n",
                "    if True:\n",
                f"{_BESIDE}::test_a_motion_is_as_free_as_before_against_the_noise_that_causes_leave",
            ),
            (
                "spins.a_quieter_motion_is_as_stiff",
                "twin/estimated_motion.py",
                "self.knee_rad * (self.noise_rad / noise_rad) ** (2.0 / SPECTRAL_SLOPE)",
                "self.knee_rad",
                f"{_BESIDE}::test_a_motion_is_as_free_as_before_against_the_noise_that_causes_leave",
            ),
            (
                "spins.edges_of_stairs_tell_of_no_shaft",
                "diagnosis/discovery/stages/final_fit.py",
                "on_average(with_slopes(fit))",
                "with_slopes(fit)",
                f"{_BESIDE}::test_stairs_behind_an_estimated_motion_tell_on_average",
            ),
            (
                "spins.intervals_are_those_of_the_edges",
                "diagnosis/discovery/fitting/intervals.py",
                "(fit.weighting.slopes or fit.by_average)",
                "fit.weighting.slopes",
                f"{_BESIDE}::test_intervals_behind_such_stairs_are_those_of_the_average",
            ),
        )
    ),
)
