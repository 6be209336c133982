"""Mutations of what several lines have in common: each mechanism off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_SEARCH = "tests/diagnosis/discovery/search/test_parts.py"
_FALLING = "tests/diagnosis/discovery/search/test_falling_lines.py"
_BESIDE = "tests/diagnosis/discovery/test_magnet_beside_the_shaft.py"
_SERIES = "tests/diagnosis/discovery/search/test_series_of_lines.py"
_SEAM = "tests/diagnosis/discovery/test_seam_and_current.py"
_FORMS = "tests/diagnosis/discovery/test_forms.py"
_STAGES = "tests/diagnosis/discovery/stages/test_one_source.py"

PERIODS: tuple[Mutation, ...] = tuple(
    Mutation(name, file, old, new, (test,))
    for name, file, old, new, test in (
        (
            "periods.one_line_is_enough_for_a_sensor_of_several",
            "diagnosis/discovery/search/screening.py",
            "gains = np.where(borne_out(base, effect, shapes, gains, looks=looks), gains, 0.0)",
            "pass",
            f"{_SEARCH}::test_a_screening_passes_over_periods_of_which_only_one_line_shows",
        ),
        (
            "periods.a_part_that_has_gone_is_not_missed",
            "diagnosis/discovery/search/exchange.py",
            " or lacks_a_part(fit, key, fit.settings.footprint_log_p)",
            "",
            f"{_SEARCH}::test_one_that_was_taken_before_the_rest_was_known_gives_way",
        ),
        (
            "periods.a_motor_by_two_of_a_magnets_orders",
            "twin/magnet/motor_poles.py",
            "fewest = 4 if slots % poles == 0 else 2 if bare else 3",
            "fewest = 2",
            f"{_STAGES}::test_the_lines_of_a_motor_are_one_cause_and_others_stay[two orders of a magnet]",
        ),
        (
            "periods.a_motor_that_cannot_be_wound",
            "twin/magnet/motor_poles.py",
            "slots % (PHASES * gcd(slots, poles // 2)) == 0",
            "slots % PHASES == 0",
            f"{_STAGES}::test_a_motor_is_one_that_can_be_wound_and_makes_most_of_the_lines",
        ),
        (
            "periods.lines_of_a_motor_stay_apart",
            "diagnosis/discovery/stages/one_source.py",
            "return state.with_(joint, keys",
            "state.with_(joint, keys",
            f"{_STAGES}::test_the_lines_of_a_motor_are_one_cause_and_others_stay[slots, poles and their doubles]",
        ),
        (
            "periods.a_magnet_has_no_lines_between",
            "diagnosis/discovery/stages/one_source.py",
            "        if effect.comb is not None and effect.comb.falling:\n",
            "        if False:\n",
            f"{_FALLING}::test_lines_with_others_between_them_are_a_magnets",
        ),
        (
            "periods.known_ones_are_asked_for",
            "diagnosis/discovery/search/falling_lines.py",
            "not chosen or ",
            "",
            f"{_FALLING}::test_lines_with_others_between_them_are_a_magnets",
        ),
        (
            "periods.a_magnet_may_lack_no_order",
            "diagnosis/discovery/search/falling_lines.py",
            "_ABSENT = 0.5\n",
            "_ABSENT = 1e-9\n",
            f"{_FALLING}::test_which_lines_belong_together",
        ),
        (
            "periods.a_magnets_lines_are_none_of_the_radius",
            "twin/magnet/magnet_harmonic.py",
            'RADIUS_RATIOS if "vx" in motion.provides else RADIUS_RATIOS[:1]',
            "RADIUS_RATIOS[:1]",
            f"{_BESIDE}::test_a_wave_of_the_radius_that_belongs_to_a_line_of_the_angle_is_the_magnets[2031927089]",
        ),
        (
            "periods.what_changes_the_radius_may_be_mechanics",
            "diagnosis/report/as_well.py",
            "if not more_than_turned and ",
            "if ",
            f"{_BESIDE}::test_a_wave_of_the_radius_that_belongs_to_a_line_of_the_angle_is_the_magnets[2]",
        ),
        (
            "periods.any_quadratic_term_is_as_likely",
            "twin/hall/quadratic_nonlinearity.py",
            "            prior_sd=FAR_PERCENT,\n",
            "",
            f"{_FALLING}::test_orders_3_and_6_beside_the_quadratic_term_too",
        ),
        (
            "periods.no_line_is_the_next_of_a_series",
            "diagnosis/discovery/stages/one_source.py",
            "state if following is None else",
            "state if True else",
            f"{_SERIES}::test_the_next_multiple_is_of_the_series",
        ),
        (
            "periods.two_lines_are_a_series",
            "diagnosis/discovery/search/series_of_lines.py",
            "_LEAST = 3\n",
            "_LEAST = 1\n",
            f"{_SERIES}::test_others_stay",
        ),
        (
            "periods.any_larger_line_is_the_next",
            "diagnosis/discovery/search/series_of_lines.py",
            'if near and _of(fit, key, "amplitude_deg") < _of(fit, last, "amplitude_deg"):',
            "if near:",
            f"{_SERIES}::test_others_stay",
        ),
        (
            "periods.a_line_without_a_name_where_one_is",
            "diagnosis/discovery/search/forward_step.py",
            "[one for one in found if not _where_a_line_is(one, base.fit, taken)]",
            "found",
            "tests/diagnosis/discovery/search/test_iterate.py::"
            "test_all_that_the_radius_does_has_to_be_the_work_of_causes",
        ),
        (
            "periods.a_motor_takes_a_bodys_lines",
            "diagnosis/discovery/stages/one_source.py",
            "        if _of_a_body(state, covered):\n",
            "        if False:\n",
            f"{_FALLING}::test_lines_that_a_motor_would_make_are_a_magnets_that_has_those_between_them",
        ),
        (
            "periods.lines_of_a_motor_are_entries_of_their_own",
            "twin/catalogue.py",
            "return found_together(effect) or ",
            "return ",
            f"{_STAGES}::test_the_answer_names_the_motor_once_with_its_lines",
        ),
        (
            "periods.both_ends_are_cut_off_or_none",
            "twin/adc/clipping.py",
            "return [*found, *(_shape",
            "return [*found] or [*(_shape",
            f"{_FORMS}::test_a_range_may_cut_off_nearly_all_or_one_end_alone[0.64-ends1]",
        ),
        (
            "periods.levels_are_asked_to_first_order",
            "diagnosis/discovery/search/forward_step.py",
            "return [*other, *level]",
            "return other",
            "tests/diagnosis/discovery/search/test_forward_step.py"
            "::test_a_level_that_explains_a_share_is_fitted_beside_those_that_come_first",
        ),
        (
            "periods.a_turn_always_closes",
            "twin/empirical/__init__.py",
            "    UNNAMED_SEAM,\n    UNNAMED_BURST",
            "    UNNAMED_BURST",
            f"{_SEAM}::test_a_turn_that_drifts_has_a_seam[137.0]",
        ),
        (
            "periods.no_current_changes",
            "twin/motion.py",
            "> LEAST_CURRENTS * np.max(np.abs(self.current_a))",
            "> 1e9",
            f"{_SEAM}::test_what_follows_the_motors_current_is_named[motor_field]",
        ),
        (
            "periods.mechanics_make_no_lines",
            "diagnosis/report/as_well.py",
            "if effect.comb is not None and effect.comb.also is not None:",
            "if False:",
            "tests/diagnosis/report/test_as_well.py::test_mechanics_may_stand_behind_a_line_of_an_angle_alone",
        ),
        (
            "periods.channels_leave_the_magnet",
            "diagnosis/discovery/search/lines.py",
            "if fit.observations.observables == 1:\n        return False",
            "if fit.observations.observables == 2:\n        return True",
            "tests/diagnosis/report/test_as_well.py::test_a_line_that_leaves_the_radius_alone_may_be_that_of_mechanics",
        ),
        (
            "periods.no_magnet_changes_the_radius",
            "diagnosis/discovery/search/lines.py",
            "    return gain > fit.settings.same_fit(coarse=fit.weighting.coarse)",
            "    return False",
            "tests/diagnosis/report/test_as_well.py::test_a_line_that_the_radius_has_too_is_the_magnets",
        ),
    )
)
