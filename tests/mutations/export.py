"""Mutations of tables for drives: axis, sign, words and fit of each, and what is told beside them."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_TARGETS = "tests/diagnosis/correction/test_targets.py"
_EXPORT = "tests/scenarios/test_export.py"
_FOLDER = "diagnosis/correction/targets"

EXPORT: tuple[Mutation, ...] = (
    *of_one_file(
        "diagnosis/correction/straight_lines.py",
        _TARGETS,
        (
            "export.samples_of_the_curve_are_the_entries",
            "    return values + worst * _smallest_worst(lines, left / worst, interval, nodes.intervals)",
            "    return curve(nodes.at_rad)",
            "::test_of_floats_none_is_better[12-0]",
        ),
        (
            "export.least_squares_are_the_smallest_worst",
            '    if least == "rms" or worst < _NOT_WORTH_IT_RAD:',
            "    if True:",
            "::test_least_squares_are_better_in_the_mean_and_worse_at_the_worst",
        ),
        (
            "export.whole_numbers_are_rounded_floats",
            "    return tried[np.arange(len(nodes)), chosen]",
            "    return tried[np.arange(len(nodes)), np.full_like(chosen, _CANDIDATES // 2)]",
            "::test_of_few_whole_numbers_all_are_tried",
        ),
        (
            "export.free_points_stay_even",
            "        if found < worst * (1.0 - _SLACK):",
            "        if worst == np.inf:",
            "::test_of_free_points_none_is_better[1]",
        ),
    ),
    *of_one_file(
        f"{_FOLDER}/simplefoc.py",
        _TARGETS,
        (
            "export.simplefoc_adds",
            "        return cls(-best_values(",
            "        return cls(best_values(",
            "::test_a_table_gives_the_shaft_angle_of_its_device[0]",
        ),
        (
            "export.simplefoc_holds_no_line",
            "(np.float32(1.0) - share) * first + share * second",
            "first",
            "::test_simplefoc_takes_the_offset_off",
        ),
    ),
    *of_one_file(
        f"{_FOLDER}/moteus.py",
        _TARGETS,
        (
            "export.moteus_of_floats_stands_at_the_edges_of_bins",
            "        place = np.mod(ratio * _BINS - 0.5, _BINS)",
            "        place = np.mod(ratio * _BINS, _BINS)",
            "::test_moteus_of_floats_stands_on_the_middles_of_its_bins",
        ),
        (
            "export.moteus_counts_in_parts_of_128",
            "        part = self.entry.astype(np.float32) * (self.scale / np.float32(_LARGEST))",
            "        part = self.entry.astype(np.float32) * (self.scale / np.float32(128))",
            "::test_moteus_adds_a_part_of_the_scale",
        ),
    ),
    *of_one_file(
        f"{_FOLDER}/klipper.py",
        _TARGETS,
        (
            "export.klipper_begins_at_any_phase",
            "int(number[0]) // 4 * 4 if _ascends(number) else int(number[-1]) // 4 * 4",
            "int(number[0]) if _ascends(number) else int(number[-1])",
            "::test_klipper_solves_the_table_that_was_meant[1]",
        ),
        (
            "export.klipper_takes_a_turn_that_its_steps_do_not_tell",
            "        if rank < _BUCKETS:",
            "        if False:",
            "::test_klipper_refuses_a_turn_that_its_steps_do_not_tell",
        ),
        (
            "export.klipper_forgets_its_sense",
            "        number = wanted.slope * (lowest",
            "        number = (lowest",
            "::test_klipper_solves_the_table_that_was_meant[0]",
        ),
    ),
    *of_one_file(
        f"{_FOLDER}/magalpha.py",
        _TARGETS,
        (
            "export.magalpha_writes_no_two_complement",
            "rows([str(value) for value in self.step % 256], 8)",
            "rows([str(abs(value)) for value in self.step], 8)",
            "::test_a_file_is_read_back_as_what_was_fitted[magalpha:32]",
        ),
        (
            "export.magalpha_takes_what_no_register_holds",
            "        if largest > _LARGEST * _STEP_RAD:",
            "        if False:",
            "::test_magalpha_refuses_what_no_register_holds",
        ),
    ),
    *of_one_file(
        f"{_FOLDER}/c_table.py",
        _TARGETS,
        (
            "export.c_cuts_what_python_rounds",
            "((int64_t)131073 << (15u + {upper}_SHIFT))",
            "((int64_t)65536 << (16u + {upper}_SHIFT))",
            "::test_compiled_c_is_the_python_on_all_words[target0-64-0]",
        ),
    ),
    *of_one_file(
        f"{_FOLDER}/autosar.py",
        _TARGETS,
        (
            "export.a_quotient_is_floored_where_c_cuts_it",
            "        added = self.y[k] + np.sign(product) * (np.abs(product) // run)",
            "        added = self.y[k] + product // run",
            "::test_compiled_c_is_the_python_on_all_words[target2-24-0]",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/left_of_readings.py",
        _EXPORT,
        (
            "export.noise_counts_as_direction",
            "    square = float(np.nanmean(half**2) - np.mean(noise))",
            "    square = float(4.0 * np.nanmean(half**2))",
            "::test_direction_of_a_sweep_is_told_apart_from_its_noise",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/as_read.py",
        "tests/scenarios/test_words_as_read.py",
        (
            "export.words_are_judged_as_told_back",
            "[radians(one.read.measured_deg) for one in sweeps]",
            "[radians(one.sweep.measured_deg) for one in sweeps]",
            "::test_a_table_is_judged_on_the_words_that_the_drive_reads[word_bit]",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/left_of_readings.py",
        "tests/scenarios/test_words_as_read.py",
        (
            "export.what_follows_a_current_counts_as_noise",
            "    rest = scatter - noise",
            "    rest = 0.0",
            "::test_noise_is_told_apart_from_what_follows_a_current",
        ),
        (
            "export.what_held_out_readings_err_more_is_left_without_a_reason",
            "    if held <= _LEFT_OVER * own:",
            "    if held <= 10.0 * own:",
            "::test_what_is_left_adds_up_to_the_error_on_held_out_readings",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/targets/target.py",
        "tests/scenarios/test_words_as_read.py",
        (
            "export.the_zero_of_a_plain_table_has_the_other_sign",
            "        zero = np.degrees(-wanted.zero_rad)",
            "        zero = np.degrees(wanted.zero_rad)",
            "::test_a_plain_table_is_applied_as_its_sentence_says[1]",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/not_removed.py",
        _EXPORT,
        (
            "export.speed_is_told_at_half_the_speed",
            "np.full(GRID, _SPEED_RPM * RPM)",
            "np.full(GRID, 0.5 * _SPEED_RPM * RPM)",
            "::test_of_a_twin_tells_what_no_table_removes",
        ),
        (
            "export.causes_that_stay_are_left_out",
            "            causes.setdefault(kind, []).append(key)",
            "            causes.setdefault(kind, [])",
            "::test_of_a_twin_tells_what_no_table_removes",
        ),
    ),
    *of_one_file(
        "scenarios/commands/export_made.py",
        _EXPORT,
        (
            "export.a_table_for_another_temperature",
            "    wanted = Wanted.of(source.correction, wish.temperature_c)",
            "    wanted = Wanted.of(source.correction)",
            "::test_of_sweeps_at_two_temperatures_a_table_is_made_for_one",
        ),
    ),
    *of_one_file(
        "diagnosis/correction/cross_validation.py",
        "tests/diagnosis/correction/test_compensation.py",
        (
            "folds.an_angle_is_held_out_of_all_turns",
            "_DEALT[block] if count == FOLDS else block % max(count, 1)",
            "block % max(count, 1)",
            "::test_no_angle_of_two_turns_is_held_out_twice[False]",
        ),
    ),
)
