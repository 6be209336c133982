"""Mutations of the checks of a set-up: each rule off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

_CHECKS = "tests/diagnosis/setup/test_checks.py"
_FAULTS = "tests/setup_faults/test_setup_faults.py"

SETUPS: tuple[Mutation, ...] = (
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
            "    if np.ptp(way) > 0.0:",
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
)
