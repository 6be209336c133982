"""Mutations written by hand: each mechanism that somebody might take out without noticing."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_SWARM = "diagnosis/error_model/swarm.py"
_SWARM_TESTS = "tests/diagnosis/error_model/test_swarm.py"
_BAND = "diagnosis/error_model/error_band.py"
_DESIGN = "tests/scenarios/test_design.py"
_GAPS = "diagnosis/factors/air_gaps.py"
_MIRROR = "diagnosis/factors/mirror.py"
_MIRROR_TESTS = "tests/diagnosis/factors/test_mirror.py"
_GAP_TESTS = "tests/diagnosis/factors/test_air_gaps.py"

ERROR_MODEL: tuple[Mutation, ...] = (
    Mutation(
        "descents.all_agree",
        "diagnosis/error_model/descents.py",
        "np.all(cost - least <= apart, axis=1) & np.all(",
        "np.all(cost < np.inf, axis=1) | np.all(",
        ("tests/diagnosis/error_model/test_fit.py::test_the_swarm_searches_where_descents_do_not_agree",),
    ),
    Mutation(
        "descents.a_step_below_rounding_goes_on",
        "diagnosis/error_model/least_squares.py",
        "np.maximum(_SETTLED * here.cost / max(count - 6, 1), rounding)",
        "_SETTLED * here.cost / max(count - 6, 1)",
        ("tests/diagnosis/error_model/test_fit.py::test_a_descent_ends_where_the_forms_digits_end",),
    ),
    Mutation(
        "swarm.discard",
        _SWARM,
        "            now[out] = np.inf\n",
        "",
        (f"{_SWARM_TESTS}::test_a_discarded_particle_counts_for_nothing",),
        short=True,
    ),
    Mutation(
        "swarm.discard_without_a_particle_inside",
        _SWARM,
        "out = outside(points) & known",
        "out = outside(points)",
        (f"{_SWARM_TESTS}::test_a_discarded_particle_counts_for_nothing",),
    ),
    Mutation(
        "swarm.own_pull",
        _SWARM,
        "    swarm.velocity += pulls[0] * (swarm.own - swarm.place)\n",
        "",
        (f"{_SWARM_TESTS}::test_particles_move_by_equation_8",),
        short=True,
    ),
    Mutation(
        "swarm.best_pull",
        _SWARM,
        "    swarm.velocity += pulls[1] * (swarm.best - swarm.place)\n",
        "",
        (f"{_SWARM_TESTS}::test_particles_move_by_equation_8",),
    ),
    Mutation(
        "swarm.inertia",
        _SWARM,
        "swarm.velocity *= inertia_now",
        "swarm.velocity *= settings.inertia_max",
        (f"{_SWARM_TESTS}::test_particles_move_by_equation_8",),
    ),
    Mutation(
        "error_band.adc",
        _BAND,
        "quantisation = np.sqrt(2.0) * FULL_SCALE / 2.0**adc_bits if adc_bits else 0.0",
        "quantisation = 0.0",
        (f"{_SWARM_TESTS}::test_delta_e_is_the_largest_deviation_of_a_simulated_sweep",),
        short=True,
    ),
    Mutation(
        "error_band.one_channel",
        _BAND,
        "np.sqrt(2.0) * FULL_SCALE / 2.0**adc_bits",
        "FULL_SCALE / 2.0**adc_bits",
        (f"{_SWARM_TESTS}::test_delta_e_is_the_largest_deviation_of_a_simulated_sweep",),
    ),
    Mutation(
        "error_band.reference",
        _BAND,
        '"reference": reference, "noise": noise',
        '"reference": 0.0, "noise": noise',
        (f"{_SWARM_TESTS}::test_delta_e_is_the_largest_deviation_of_a_simulated_sweep",),
    ),
    Mutation(
        "error_band.noise",
        _BAND,
        '"reference": reference, "noise": noise',
        '"reference": reference, "noise": 0.0',
        (f"{_SWARM_TESTS}::test_delta_e_is_the_largest_deviation_of_a_simulated_sweep",),
    ),
)

FACTORS: tuple[Mutation, ...] = (
    Mutation(
        "band_check.counts_nothing",
        "diagnosis/factors/band_check.py",
        "np.count_nonzero(apart > band_rad)",
        "np.count_nonzero(apart > np.pi)",
        ("tests/diagnosis/factors/test_band_check.py::test_what_the_model_lacks_leaves_the_band_and_is_counted",),
    ),
    Mutation(
        "findings.no_band_reaches_the_swarm",
        "diagnosis/factors/findings.py",
        "senses=given, robust=robust, settings=swarm, band_rad=band_rad",
        "senses=given, robust=robust, settings=swarm",
        ("tests/diagnosis/factors/test_band_check.py::test_a_device_keeps_its_own_band_and_particles_are_discarded",),
    ),
    Mutation(
        "compensate.signs_told_as_certain",
        "diagnosis/report/temperature_text.py",
        'if not answer["senses"]["decided"]:',
        "if False:",
        (
            "tests/diagnosis/correction/test_over_temperature.py::"
            "test_factors_that_the_mirror_solution_turns_are_told_as_open",
        ),
    ),
    Mutation(
        "compensate.nothing_of_order_3_beside",
        "diagnosis/correction/calibration.py",
        "ORDERS = np.arange(3, 33)",
        "ORDERS = np.arange(4, 33)",
        ("tests/diagnosis/correction/test_compensation.py::test_either_mirror_solution_makes_the_same_correction",),
    ),
    Mutation(
        "air_gaps.first_set_that_fits",
        _GAPS,
        "    fewest = min(len(joined(*pair)) for pair in held)\n",
        "    held = [min(held, key=lambda pair: fitted[pair].chi2)]\n    fewest = len(joined(*held[0]))\n",
        (f"{_GAP_TESTS}::test_two_causes_that_the_gaps_cannot_part_are_given_together_with_the_gap_that_would",),
    ),
    Mutation(
        "air_gaps.an_upright_magnet",
        "diagnosis/factors/gap_model.py",
        '        "magnet_tilt_y_deg": lean.real,\n',
        "",
        (f"{_GAP_TESTS}::test_expected_factors_are_those_of_magpylibs_field",),
    ),
    Mutation(
        "air_gaps.no_upright_field",
        "diagnosis/factors/gap_model.py",
        "offset = causes.voltage / scale + upright",
        "offset = causes.voltage / scale",
        (f"{_GAP_TESTS}::test_a_tilted_sensor_senses_the_upright_field",),
    ),
    Mutation(
        "air_gaps.only_where_a_displacement_is_clear",
        "diagnosis/factors/gap_fits.py",
        'off_axis = self.sees_sensor or (_stands_out(sensor, "sensor") and worse < CLEAR_CHI2)',
        "off_axis = self.sees_sensor",
        (f"{_GAP_TESTS}::test_a_tilt_is_looked_for_where_narrow_gaps_hardly_tell_electronics_from_a_displacement",),
    ),
    Mutation(
        "air_gaps.order_3_of_the_field_is_quadratic",
        "diagnosis/factors/gap_fit.py",
        "for sweep in self.sweeps]) - told.quad[0])",
        "for sweep in self.sweeps]))",
        (f"{_GAP_TESTS}::test_causes_are_named_and_displacements_come_back",),
    ),
    Mutation(
        "air_gaps.parted_by_any_gap",
        _GAPS,
        "if again.chi2 - second.chi2 > _PARTED_SIGMA**2:",
        "if True:",
        (f"{_GAP_TESTS}::test_two_causes_that_the_gaps_cannot_part_are_given_together_with_the_gap_that_would",),
    ),
    Mutation(
        "air_gaps.quadratic_grows_twice",
        _GAPS,
        '"grows with the field": field_mT}',
        '"grows with the field": field_mT**2}',
        (f"{_GAP_TESTS}::test_the_quadratic_term_has_a_law_or_none",),
    ),
    Mutation(
        "air_gaps.voltage_keeps_its_share",
        "diagnosis/factors/gap_model.py",
        "offset = causes.voltage / scale",
        "offset = causes.voltage / 100.0",
        (f"{_GAP_TESTS}::test_expected_factors_are_those_of_magpylibs_field",),
    ),
    Mutation(
        "air_gaps.gaps_known_exactly",
        "diagnosis/factors/gap_fit.py",
        "(stated - gaps[:, : stated.size]) / self.mounting.gap_error_mm)",
        "(stated - gaps[:, : stated.size]) / 1e-6)",
        (f"{_GAP_TESTS}::test_causes_are_named_and_displacements_come_back",),
    ),
    Mutation(
        "air_gaps.senses_not_shared",
        "diagnosis/factors/findings.py",
        "item.mirror.other if decided * item.fit.senses.output < 0 and item.mirror.other is not None else item.fit",
        "item.fit",
        (f"{_GAP_TESTS}::test_sweeps_that_decide_between_the_mirror_solutions_decide_for_the_others",),
    ),
    Mutation(
        "mechanical.another_magnet",
        "diagnosis/factors/mechanical.py",
        "field = coefficients(magnet, np.full(_NODES, gap_mm), **{name: value})",
        "field = coefficients(Magnet(), np.full(_NODES, gap_mm), **{name: value})",
        ("tests/diagnosis/factors/test_mounting.py::test_equivalents_are_counted_for_the_magnet_given",),
    ),
    Mutation(
        "mechanical.gap_known_exactly",
        "diagnosis/factors/mechanical.py",
        "reach = Z95 * place.gap_error_mm",
        "reach = 1e-9 * place.gap_error_mm",
        (
            "tests/diagnosis/factors/test_mounting.py::test_the_interval_of_a_displacement_holds_what_the_gap_leaves_open",
        ),
    ),
    Mutation(
        "mirror.any_odds_decide",
        _MIRROR,
        "if odds > DECIDED_LOG_ODDS else",
        "if odds > 0.0 else",
        (f"{_MIRROR_TESTS}::test_the_sign_is_right_or_both_are_given",),
        short=True,
    ),
    Mutation(
        "mirror.structure_counts_as_noise",
        _MIRROR,
        "return min(white, 0.5",
        "return max(white, 0.5",
        (f"{_MIRROR_TESTS}::test_other_structure_of_order_3_does_not_decide",),
    ),
    Mutation(
        "mirror.readings_count_instead_of_angles",
        _MIRROR,
        "excess = (fit.senses.sigma * fit.standard_errors[0] / counted.standard_errors[0]) ** 2",
        "excess = fit.senses.sigma**2",
        (f"{_MIRROR_TESTS}::test_repeated_readings_count_once",),
    ),
    Mutation(
        "mirror.first_by_chance",
        "diagnosis/factors/findings.py",
        "(fit, other) if fit.senses.output > 0 else (other, fit)",
        "(fit, other)",
        (f"{_MIRROR_TESTS}::test_the_sign_is_right_or_both_are_given",),
    ),
    Mutation(
        "control_charts.run_length_not_shared",
        "diagnosis/factors/series.py",
        "limit_for(run_length * len(courses))",
        "limit_for(run_length)",
        ("tests/diagnosis/factors/test_control_chart.py::test_charts_of_a_series_share_its_run_length",),
        short=True,
    ),
)

TWIN: tuple[Mutation, ...] = (
    Mutation(
        "assembly.stray_field_follows_the_magnet",
        "twin/magnet/assembly.py",
        "- stray[axis]) * warm + stray[axis]",
        ") * warm",
        ("tests/twin/test_magnet_field.py::test_a_stray_field_does_not_warm_up_with_the_magnet",),
        short=True,
    ),
    Mutation(
        "design.stray_field_follows_the_magnet",
        "scenarios/studies/design/field.py",
        "out = (out - stray[:, :2]) * warm[:, None] + stray[:, :2]",
        "out = out * warm[:, None]",
        (f"{_DESIGN}::test_designs_are_driven_as_one_assembly_is",),
    ),
    Mutation(
        "design.saturation_grows_with_the_field",
        "twin/concentrator/saturation.py",
        "field_power=exponent_of",
        "field_power=1.0",
        (f"{_DESIGN}::test_a_causes_error_goes_with_its_power_of_the_field",),
        short=True,
    ),
    Mutation(
        "motion.steps_between_steady_speeds_are_no_varying_speed",
        "twin/motion.py",
        "float(np.median(size)) > 0.02 * float(np.max(size))",
        "float(np.max(size)) > 0.0",
        ("tests/twin/test_acceleration.py::test_steady_speeds_with_steps_between_them_are_no_varying_speed",),
    ),
    Mutation(
        "motion.acceleration_weighs_its_steps",
        "twin/motion.py",
        "before * right + after * left, both",
        "before * left + after * right, both",
        ("tests/twin/test_acceleration.py::test_acceleration_of_a_parabola_is_exact_between_uneven_readings",),
    ),
    Mutation(
        "air_gap.codes_reach_as_far_at_every_gap",
        "twin/adc/adc_quantisation.py",
        "    reach = range_of(values)\n",
        "    reach = FULL_SCALE\n",
        ("tests/twin/test_air_gap.py::test_as_built_the_converter_keeps_its_range_in_volts",),
    ),
    Mutation(
        "air_gap.percentages_stay",
        "twin/effect.py",
        "values[name] * self.field_factor(name, values, **ratios)",
        "values[name]",
        ("tests/twin/test_air_gap.py::test_expected_errors_at_each_gap_are_those_of_first_principles",),
    ),
    Mutation(
        "design.quadratic_term_keeps_its_share",
        "twin/hall/quadratic_nonlinearity.py",
        "field_power=1.0",
        "field_power=0.0",
        (f"{_DESIGN}::test_a_causes_error_goes_with_its_power_of_the_field",),
    ),
)

_LINEAR = "diagnosis/discovery/fitting/linearised_chain.py"
_DERIVATIVE = "tests/diagnosis/discovery/fitting/test_derivatives.py::test_derivative"
_WITHIN = "tests/diagnosis/discovery/fitting/test_step_within.py"
_STAIRS = "tests/diagnosis/discovery/fitting/test_blurred_stairs.py"

FITTING: tuple[Mutation, ...] = (
    Mutation(
        "joint_fit.every_trial_has_its_jacobian",
        "diagnosis/discovery/fitting/joint_fit.py",
        "    r = fit.whitened_residual()\n",
        "    r, _ = fit.whitened()\n",
        ("tests/diagnosis/discovery/fitting/test_joint_fit.py::test_a_step_taken_back_costs_no_derivatives",),
    ),
    Mutation(
        "bounded_step.others_go_as_if_no_bound_were_there",
        "diagnosis/discovery/fitting/bounded_step.py",
        "        step, free = within, free & ~beyond\n",
        "        return within\n",
        (f"{_WITHIN}::test_at_a_bound_the_others_make_up_for_what_takes_place",),
    ),
    Mutation(
        "blurred_stairs.no_blur",
        "diagnosis/discovery/fitting/blurred_stairs.py",
        "density = np.exp(-0.5 * (order * blur) ** 2)",
        "density = np.ones(order.size)",
        (f"{_STAIRS}::test_the_mean_is_smooth",),
    ),
    Mutation(
        "linearised_chain.ideal_field_in_place_of_the_magnet",
        _LINEAR,
        "    if chain.magnet is None:\n",
        "    if True:\n",
        (f"{_DERIVATIVE}[zero.zero_deg-misplaced_magnet]",),
        short=True,
    ),
    Mutation(
        "linearised_chain.sensor_sense_left_out",
        _LINEAR,
        'self.chain.sensor_sense if step.key == "after shaft"',
        '1 if step.key == "after shaft"',
        (f"{_DERIVATIVE}[backlash.half_width_deg-behind_others]",),
        short=True,
    ),
    Mutation(
        "linearised_chain.reference_leads",
        _LINEAR,
        "return -start * (moved if",
        "return start * (moved if",
        (f"{_DERIVATIVE}[index_slip.step_deg-alone]",),
        short=True,
    ),
    Mutation(
        "effect.amplitude_keeps_its_phase_in_the_mirror",
        "twin/effect.py",
        "found[phases[0]] = phase_deg - np.copysign(180.0, phase_deg)",
        "found[phases[0]] = phase_deg",
        ("tests/twin/test_mirror.py::test_an_amplitude_stays_one",),
        short=True,
    ),
    Mutation(
        "placement.stray_field_not_mirrored",
        "twin/magnet/placement.py",
        '"magnet_tilt_x_deg", "stray_y_mT")',
        '"magnet_tilt_x_deg")',
        ("tests/twin/test_mirror.py::test_all_effects_at_once",),
        short=True,
    ),
)

BY_HAND: tuple[Mutation, ...] = (*ERROR_MODEL, *FACTORS, *TWIN, *FITTING)
