"""Mutations of the factors over temperature: laws, words, and the correction that follows them."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_LAWS = "tests/diagnosis/thermal/test_laws.py"
_CORRECTION = "tests/diagnosis/correction/test_over_temperature.py"

THERMAL: tuple[Mutation, ...] = (
    *of_one_file(
        "diagnosis/thermal/laws.py",
        _LAWS,
        (
            "thermal.nothing_seen_is_immune",
            "& (drifts < FAMILY_LEVEL) & (power > 0)",
            "& (power > 0)",
            "::test_nothing_seen_is_no_proof_of_immunity",
        ),
        (
            "thermal.each_test_has_the_level_to_itself",
            "if chance[k] >= FAMILY_LEVEL:",
            "if chance[k] >= 100.0 * FAMILY_LEVEL:",
            "::test_a_steady_sensor_is_not_called_sensitive",
        ),
        (
            "thermal.laws_count_from_zero_C",
            "away = span.middle_c - FROM_C",
            "away = span.middle_c",
            "::test_two_factors_sensitive_and_the_others_immune",
        ),
        (
            "thermal.the_margin_is_three_times_the_floor",
            "stdtr(found.freedom[k], (moved - floor) / error)",
            "stdtr(found.freedom[k], (moved - 3.0 * floor) / error)",
            "::test_a_drift_by_the_noise_floor_is_not_called_immune",
        ),
    ),
    *of_one_file(
        "diagnosis/thermal/evidence.py",
        _LAWS,
        (
            "thermal.neighbours_do_not_go_together",
            "widening = np.maximum(by_factor, 1.0)",
            "widening = np.ones(6)",
            "::test_a_steady_sensor_is_not_called_sensitive[coloured]",
        ),
        (
            "thermal.scatter_does_not_widen",
            "scatters = spare > 0",
            "scatters = spare < 0",
            "::test_scatter_about_any_law_widens_the_interval",
        ),
    ),
    *of_one_file(
        "diagnosis/thermal/over_temperature.py",
        _LAWS,
        (
            "thermal.structure_is_noise",
            "highest = min(_HIGHEST_ORDER,",
            "highest = min(0,",
            "::test_structure_that_is_the_same_at_every_temperature_is_no_noise",
        ),
        (
            "thermal.a_reference_set_anew_is_a_drift",
            "if not forced and not _scatter(model, left):",
            "if not forced:",
            "::test_a_reference_set_anew_at_each_turn_leaves_the_zero_untold[0.05]",
        ),
        (
            "thermal.gross_errors_stay",
            "aligned.part(~gross)",
            "aligned",
            "::test_gross_errors_are_left_out",
        ),
    ),
    *of_one_file(
        "diagnosis/thermal/recording.py",
        _LAWS,
        (
            "thermal.far_zeros_stay_apart",
            "if np.max(np.abs(away)) > _REMADE_RAD else self",
            "if False else self",
            "::test_a_reference_set_anew_at_each_turn_leaves_the_zero_untold[180.0]",
        ),
    ),
    *of_one_file(
        "diagnosis/thermal/levels.py",
        _LAWS,
        (
            "thermal.part_of_a_turn_makes_a_level",
            "and widest_gap_rad(reference_rad) < _WIDEST_GAP_RAD",
            "and True",
            "::test_a_temperature_that_moves_with_the_angle_tells_nothing",
        ),
        (
            "thermal.close_levels_support_a_power",
            "if np.sqrt(np.mean(left**2)) < _LEFT_OF_A_POWER:",
            "if False:",
            "::test_two_close_levels_of_three_support_no_second_power",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/calibration.py",
        _CORRECTION,
        (
            "thermal.the_correction_is_that_of_25_C",
            "powers = self.span.powers(self.span.clipped(temperature_c),",
            "powers = self.span.powers(self.span.clipped(25.0),",
            "::test_error_at_each_temperature_and_between_them[-40.0]",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/compensation.py",
        _CORRECTION,
        (
            "thermal.it_runs_on_beyond_the_span",
            "away = np.clip(np.asarray(temperature_c, dtype=np.float64), self.low_c, self.high_c) - FROM_C",
            "away = np.asarray(temperature_c, dtype=np.float64) - FROM_C",
            "::test_beyond_the_measured_temperatures_it_stays_what_it_is_there",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/compensation_c.py",
        _CORRECTION,
        (
            "thermal.the_header_does_not_clip",
            "mC = mC > {guard_base}_HIGHEST_MC ? {guard_base}_HIGHEST_MC : mC;",
            "",
            "::test_compiled_header_is_the_python_correction[measured]",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/cross_validation.py",
        _CORRECTION,
        (
            "thermal.the_held_out_temperature_is_not_held_out",
            "correct(level != k)",
            "correct(np.ones(level.size, dtype=bool))",
            "::test_held_out_blocks_and_a_held_out_temperature",
        ),
    ),
    *of_one_file(
        "scenarios/commands/compensate_judge.py",
        "tests/scenarios/test_over_temperature.py",
        (
            "thermal.worse_at_one_temperature_is_hidden",
            "judged += [whole, *_by_level(whole)]",
            "judged += [whole]",
            "::test_a_correction_that_is_worse_at_one_temperature_is_not_hidden_in_the_mean",
        ),
    ),
)
