"""Mutations of how logs and tables are read: each rule off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

LOGS: tuple[Mutation, ...] = (
    *of_one_file(
        "twin/logs/turn_seen.py",
        "tests/untidy/test_alone.py",
        (
            "logs.any_gap_is_that_of_a_turn",
            "    if widest > 0.1 * span:",
            "    if widest > 10.0 * span:",
            "::test_a_turn_that_was_not_gone_through_is_none",
        ),
        (
            "logs.a_failed_transfer_ends_the_turn",
            "(known, *_without_a_word(known))",
            "(known,)",
            "::test_counts_a_turn_are_those_with_which_they_begin_anew",
        ),
    ),
    *of_one_file(
        "twin/logs/alone.py",
        "tests/untidy/test_alone.py",
        (
            "logs.two_angles_are_one_alone",
            "if len(named) > 1 or any(",
            "if any(",
            "::test_a_log_of_two_angles_is_never_one_of_a_sensor_alone",
        ),
        (
            "logs.a_named_unit_is_believed",
            "if not _contradicts(values, own, units):",
            "if True:",
            "::test_a_name_that_the_values_go_against_is_asked_about",
        ),
    ),
    *of_one_file(
        "twin/reading_grid.py",
        "tests/twin/test_reading_grid.py",
        (
            "logs.even_references_make_a_grid",
            "None if even is None or np.ptp(angle) <= 2.0 * _SAME_DEG else abs(even)",
            "None if even is None else abs(even)",
            "::test_readings_that_came_out_are_none",
        ),
        (
            "logs.uneven_readings_make_a_grid",
            "np.max(np.abs(step - even)) > _SAME_DEG",
            "np.median(np.abs(step - even)) > _SAME_DEG",
            "::test_a_sensor_of_few_codes_has_none",
        ),
    ),
    *of_one_file(
        "twin/logs/statement.py",
        "tests/untidy",
        (
            "logs.a_second_column_is_always_added",
            '        return values if self.sign == "+" else -values',
            "        return values",
            "test_tables.py::test_the_sign_of_a_second_column_is_that_of_arithmetic",
        ),
        (
            "logs.a_missing_row_ends_an_unwrapped_angle",
            "    known = np.isfinite(angle_deg)\n",
            "    known = np.full(angle_deg.shape, True)\n",
            "test_guess.py::test_a_missing_cell_of_an_electrical_angle_stays_one",
        ),
        (
            "logs.an_electrical_angle_is_not_divided",
            "unwrapped_deg(values) / self.per",
            "unwrapped_deg(values)",
            "test_guess.py::test_electrical_degrees_are_read_and_said",
        ),
    ),
    *of_one_file(
        "twin/logs/arrays.py",
        "tests/untidy/test_tables.py",
        (
            "logs.comments_stand_in_arrays",
            "    text = _without_comments(text)\n",
            "",
            "::test_a_table_is_read_to_the_angles_that_it_stores",
        ),
        (
            "logs.the_scale_of_moteus_is_not_taken",
            "(values * scale / 127.0,",
            "(values * scale,",
            "::test_a_table_is_read_to_the_angles_that_it_stores[moteus in parts of a scale]",
        ),
        (
            "logs.klippers_own_lines_are_comments",
            "line.removeprefix(_SAVED).strip()",
            "line.strip()",
            "::test_a_table_is_read_to_the_angles_that_it_stores[Klipper]",
        ),
        (
            "logs.a_table_of_zeros_is_one",
            "zero = [name for name, (values, _) in arrays.items() if not np.any(values)]",
            "zero: list[str] = []",
            "::test_what_is_no_table_of_angles_is_refused_with_the_reason",
        ),
    ),
    *of_one_file(
        "twin/logs/firmware.py",
        "tests/untidy/test_tables.py",
        (
            "logs.simplefoc_adds",
            'Rule("SimpleFOC", ERROR, unit="rad")',
            'Rule("SimpleFOC", CORRECTION, unit="rad")',
            "::test_a_table_is_read_to_the_angles_that_it_stores[SimpleFOC]",
        ),
        (
            "logs.entries_of_moteus_stand_at_the_beginning",
            'unit="rev", middle=True',
            'unit="rev"',
            "::test_a_table_is_read_to_the_angles_that_it_stores[moteus]",
        ),
        (
            "logs.klipper_lists_angles",
            'Rule("Klipper", READING',
            'Rule("Klipper", ANGLE',
            "::test_a_table_is_read_to_the_angles_that_it_stores[Klipper]",
        ),
    ),
    *of_one_file(
        "twin/logs/own_tables.py",
        "tests/untidy/test_exports.py",
        (
            "logs.own_tables_count_with_the_shaft",
            "sense * _DEG_PER_TURN",
            "_DEG_PER_TURN",
            "::test_an_exported_table_is_read_back[c-against-left_arm]",
        ),
        (
            "logs.own_tables_begin_at_zero",
            " if zero else ()",
            " if False else ()",
            "::test_an_exported_table_is_read_back[autosar-sweep-halltwin]",
        ),
        (
            "logs.own_tables_need_no_macros",
            '_macro(prefix, "SENSE", constants) in (1.0, -1.0)',
            "True",
            "::test_c_without_its_macros_is_no_table_of_its_own",
        ),
    ),
    *of_one_file(
        "twin/logs/lookups.py",
        "tests/untidy/test_tables.py",
        (
            "logs.the_last_entry_is_one_of_its_own",
            "return entries.size - 1 if closed else entries.size",
            "return entries.size",
            "::test_a_table_is_read_to_the_angles_that_it_stores[an error whose last entry repeats the first]",
        ),
        (
            "logs.any_numbers_are_corrections",
            "    if not said.role and _unlike_next(entries):\n        return\n",
            "",
            "::test_what_is_no_table_of_angles_is_refused_with_the_reason",
        ),
        (
            "logs.torques_are_angles",
            "if not TORQUES.fullmatch(table.names[k]) for",
            "for",
            "::test_what_is_no_table_of_angles_is_refused_with_the_reason",
        ),
    ),
    *of_one_file(
        "twin/logs/errors_listed.py",
        "tests/untidy/test_tables.py",
        (
            "logs.an_axis_is_always_the_sensors",
            '        return ("reference_deg",)',
            '        return ("measured_deg",)',
            "::test_errors_listed_beside_an_angle_are_read[errors of a bench]",
        ),
        (
            "logs.a_part_of_a_turn_is_one",
            " and missed <= _CLOSE_STEPS * typical",
            "",
            "::test_errors_listed_beside_an_angle_are_read[errors without units]",
        ),
    ),
    *of_one_file(
        "twin/logs/ratios.py",
        "tests/untidy",
        (
            "logs.what_leaps_farther_than_a_turn_is_followed",
            " and float(np.max(steps)) <= _TURN_DEG",
            "",
            "test_untidy.py::test_what_is_not_certain_is_refused_with_the_reason_and_what_mends_it[counts under _deg]",
        ),
        (
            "logs.of_counts_any_may_make_the_turn",
            "if one.off_deg <= _CLEARLY * least * one.step_deg + _ALIKE_DEG]",
            "]",
            "test_guess.py::test_of_geared_logs_drawn_at_random_none_is_misread",
        ),
        (
            "logs.a_larger_unit_is_off_by_more",
            "least = min((one.off_deg / one.step_deg for one in kept), default=0.0)",
            "least = min((one.off_deg for one in kept), default=0.0) / max(one.step_deg for one in kept)",
            "test_guess.py::test_radians_twenty_times_and_degrees_of_an_eighteenth_turn_are_asked_back",
        ),
    ),
    *of_one_file(
        "twin/logs/clocks.py",
        "tests/untidy/test_recorders.py",
        (
            "logs.a_gap_is_filled",
            "(restarts(channel.values) | gaps)[after - 1]",
            "restarts(channel.values)[after - 1]",
            "::test_in_a_gap_and_where_an_angle_begins_anew_nothing_is_made_up",
        ),
        (
            "logs.between_two_turns_lies_an_angle",
            "(restarts(channel.values) | gaps)[after - 1]",
            "gaps[after - 1]",
            "::test_where_an_angle_begins_anew_the_cell_is_missing",
        ),
        (
            "logs.the_fastest_clock_is_taken",
            "base = min(",
            "base = max(",
            "::test_in_a_gap_and_where_an_angle_begins_anew_nothing_is_made_up",
        ),
    ),
    *of_one_file(
        "twin/logs/buses.py",
        "tests/untidy/test_recorders.py",
        (
            "logs.any_dbc_of_the_folder_is_taken",
            "    if len(beside) != 1:",
            "    if not beside:",
            "::test_a_bus_log_without_its_dbc_says_what_is_missing[2]",
        ),
    ),
    *of_one_file(
        "twin/logs/angles.py",
        "tests/untidy/test_guess.py",
        (
            "logs.a_wrong_number_of_counts_drifts",
            "any(one.counts for one in pair) and drifts(reference, measured)",
            "False",
            "::test_counts_a_turn_are_found_or_asked_for",
        ),
        (
            "logs.radians_are_no_rivals_of_degrees",
            "    if _BOTH_RAD in fitting and span < _SHORT_DEG:\n        return [_BOTH_DEG, _BOTH_RAD]\n",
            "",
            "::test_geared_radians_or_degrees_of_a_short_span_are_asked_for",
        ),
    ),
    *of_one_file(
        "twin/logs/cells.py",
        "tests/untidy/test_untidy.py",
        (
            "logs.commas_are_never_points",
            'text = cell if comma_parts or "." in cell else cell.replace(",", ".")',
            "text = cell",
            "::test_an_untidy_log_is_read_to_the_same_sweep[semicolons and decimal commas]",
        ),
    ),
    *of_one_file(
        "twin/logs/text.py",
        "tests/untidy/test_untidy.py",
        (
            "logs.a_last_separator_begins_a_cell",
            "    rows, empty = _without_empty_ends(rows)\n",
            "    empty = []\n",
            "::test_lines_that_end_with_the_separator_have_no_further_column",
        ),
        (
            "logs.an_empty_column_is_not_told",
            "for name in empty))",
            "for name in []))",
            "::test_a_last_column_that_nobody_filled_in_is_told",
        ),
    ),
)
