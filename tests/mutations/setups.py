"""Mutations of the checks of a set-up: each rule off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_CHECKS = "tests/diagnosis/setup/test_checks.py"
_DRIFTS = "tests/diagnosis/setup/test_drift_and_word.py"
_RIVALS = "tests/diagnosis/setup/test_rival_readings.py"
_SEVERAL = "tests/diagnosis/setup/test_several_readings.py"
_FAULTS = "tests/setup_faults/test_setup_faults.py"

SETUPS: tuple[Mutation, ...] = (
    *of_one_file(
        "diagnosis/setup/ratio_search.py",
        _RIVALS,
        (
            "setup.what_swings_goes_round",
            "    return same - other > float(norm.isf(FALSE_ALARM)) * float(np.sqrt(left / rows))",
            "    return True",
            "::test_what_swings_at_no_order_of_the_turn_is_no_magnet_on_the_shaft",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/closure.py",
        _CHECKS,
        (
            "setup.one_slip_is_told",
            "    steps = sorted(step for step in steps if told(*step))",
            "    steps = steps[:1]",
            "::test_every_slip_is_told_with_its_row_and_the_rows_of_no_other",
        ),
    ),
    *of_one_file(
        "twin/following.py",
        _CHECKS,
        (
            "setup.what_falls_back_at_once_swings",
            "_JUMPS = 0.6",
            "_JUMPS = 1.6",
            "::test_a_reading_that_falls_back_at_once_does_not_swing",
        ),
    ),
    *of_one_file(
        "twin/sweep_checks.py",
        "tests/diagnosis/setup/test_command.py",
        (
            "setup.a_refusal_has_no_reason",
            "    if swing is not None:",
            "    if swing is None and False:",
            "::test_a_refusal_carries_the_reason",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/ratio.py",
        _CHECKS,
        (
            "setup.a_slip_is_a_slope",
            "    elif not _is_a_slope(relation):",
            "    elif False:",
            "::test_a_slip_is_no_wrong_number_of_counts",
        ),
        (
            "setup.either_sense_is_one",
            "    if relation is None or relation.ratio >= 0.0 or units(record) is not None:",
            "    if relation is not None:",
            "::test_the_other_way_round_is_a_note",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/instant.py",
        _CHECKS,
        (
            "setup.no_two_speeds_differ",
            "_TWO_SPEEDS = 0.2",
            "_TWO_SPEEDS = 2.0",
            "::test_a_late_reading_is_told_from_play_by_its_speeds",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/step_change.py",
        _CHECKS,
        (
            "setup.play_is_a_slip",
            "    if both_ways:",
            "    if False:",
            "::test_a_zero_that_steps_where_the_shaft_turns_round_is_no_open_turn",
        ),
        (
            "setup.a_burst_is_a_slip",
            "_SOON_ROWS, _SOON = 20, 0.03",
            "_SOON_ROWS, _SOON = 0, 0.0",
            "::test_a_stretch_that_is_off_is_no_open_turn",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/roles.py",
        _CHECKS,
        (
            "setup.a_table_is_a_swap",
            "    if evidence is None and not _is_table(record) and",
            "    if evidence is None and",
            "::test_a_table_on_the_sensors_axis_is_no_swap",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/channels.py",
        _CHECKS,
        (
            "setup.an_output_sense_is_a_swap",
            "    if abs(float(wrap_deg(zero - 90.0))) > _QUARTER_DEG:",
            "    if False:",
            "::test_a_sensor_that_counts_against_its_channels_has_not_swapped_them",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/clock.py",
        _CHECKS,
        (
            "setup.stops_have_a_clock",
            "_DENSE_S = 0.02",
            "_DENSE_S = 20.0",
            "::test_stamps_of_stops_may_be_coarse",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/field.py",
        _CHECKS,
        (
            "setup.what_comes_again_clips",
            "np.sum((values[1:] == end) & (values[:-1] == end))",
            "8 * np.sum(values == end)",
            "::test_angles_that_come_again_clip_no_channel",
        ),
        (
            "setup.wild_readings_are_noise",
            "noise_floor(np.where(relation.fit.kept, relation.fit.left, 0.0))",
            "noise_floor(relation.fit.left)",
            "::test_a_wild_reading_or_two_are_no_weak_magnet",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/sampling.py",
        _CHECKS,
        (
            "setup.every_line_is_an_alias",
            "return order % 4 != 0 if",
            "return True if",
            "::test_an_alias_is_thought_of_where_there_is_one_near",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/link.py",
        _CHECKS,
        (
            "setup.rejected_rows_are_lost",
            "    apart = np.diff(record.numbers[known])",
            "    apart = np.ones(known.size - 1)",
            "::test_rows_that_were_rejected_are_no_lost_frames",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/of_log.py",
        _FAULTS,
        (
            "setup.what_is_mended_is_not_told",
            "    return read if found is None else replace(read, findings=(replace(found, columns=read.read_as),))",
            "    return read",
            "::test_a_fault_is_named[electrical reading]",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/typing_error.py",
        _FAULTS,
        (
            "setup.no_row_is_worse_than_others",
            "    worst = int(np.argmax(score))",
            "    worst = int(np.argmin(score))",
            "::test_a_fault_is_named[mistyped]",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/step_change.py",
        _CHECKS,
        (
            "setup.steps_are_sought_at_one_end",
            "    return int(np.argmax(gain))",
            "    return int(np.argmin(gain)) + _FEWEST",
            "::test_a_slip_is_no_wrong_number_of_counts",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/checks.py",
        _DRIFTS,
        (
            "setup.words_have_no_fault",
            "    of_words, record = without_faults_of_word(record)",
            "    of_words = without_faults_of_word(record)[0]",
            "::test_a_stuck_bit_is_told_and_makes_no_other_order[5]",
        ),
        (
            "setup.words_are_told_twice",
            "if finding.kind not in OF_WORD)",
            "if finding.kind)",
            "::test_explain_names_faults_of_the_word_as_causes_alone",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/closure.py",
        _DRIFTS,
        (
            "setup.a_drift_is_a_step",
            ", beside=_drifts(record))",
            ", beside=())",
            "::test_what_goes_with_the_current_is_no_open_turn",
        ),
        (
            "setup.a_fast_drift_is_a_step",
            " and found.is_sudden(place)",
            "",
            "::test_a_zero_that_drifts_is_no_open_turn[within a hundred rows]",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/ratio.py",
        _DRIFTS,
        (
            "setup.a_factor_is_the_references",
            "    return find(words) is not None",
            "    return False",
            "::test_a_reading_with_a_wrong_factor_is_multiplied_itself",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/several_readings.py",
        _SEVERAL,
        (
            "setup.one_reading_is_enough",
            "    rest = [checked(one.record, one.findings) for one in read.otherwise]",
            "    rest = [first]",
            "::test_every_statement_that_fits_is_listed_and_none_is_taken[two angles, the sensor first]",
        ),
    ),
    *of_one_file(
        "diagnosis/setup/of_log.py",
        _SEVERAL,
        (
            "setup.names_choose_a_reading",
            "        if two.fit:",
            "        if False:",
            "::test_every_statement_that_fits_is_listed_and_none_is_taken[corrections beside a reading]",
        ),
    ),
    *of_one_file(
        "twin/logs/unasked.py",
        _SEVERAL,
        (
            "logs.a_comment_is_a_header",
            "        if table.entries and ",
            "        if False and ",
            "::test_explain_of_a_table_says_what_it_is_and_how_many_statements_fit",
        ),
    ),
    *of_one_file(
        "twin/logs/names.py",
        "tests/untidy/test_guess.py",
        (
            "logs.small_and_large_letters_are_two_words",
            "    if behind and unit_of(behind[2]):",
            "    if behind and None:",
            "::test_a_current_is_read_in_the_unit_of_its_name[current_mA-1000.0]",
        ),
    ),
)
