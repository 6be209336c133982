"""Mutations of what scripts rely on: what is failed on, how an answer is made again, since when a factor drifts."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

SCRIPTS: tuple[Mutation, ...] = (
    *of_one_file(
        "scenarios/commands/fail_on.py",
        "tests/scenarios/test_fail_on.py",
        (
            "fail_on.rivals_do_not_count",
            "found.setdefault(rival, f\"cannot be told from {cause['name']}\")",
            "pass",
            "::test_what_an_explanation_holds",
        ),
        (
            "fail_on.an_unknown_word_passes",
            "if word not in listed:",
            "if False:",
            "::test_explain[sweep5-asked5-2]",
        ),
        (
            "fail_on.an_open_end_is_a_bound",
            'bool(parameter["at_bound"]) or None in ends',
            'bool(parameter["at_bound"])',
            "::test_what_diagnoses_hold",
        ),
    ),
    *of_one_file(
        "scenarios/commands/compensate.py",
        "tests/scenarios/test_fail_on.py",
        (
            "compensate.check_never_fails",
            "fails=bool(checked_on or words)",
            "fails=bool(words)",
            "::test_a_correction_that_makes_the_error_larger",
        ),
    ),
    *of_one_file(
        "scenarios/cli/reproduce.py",
        "tests/diagnosis/report/test_provenance.py",
        (
            "reproduce.folders_are_left_out",
            "shown_path(str(item)) for item in",
            "shown_path(str(item).rpartition('/')[2]) for item in",
            "::test_files_of_one_name_and_patterns_are_told_as_they_were_typed",
        ),
        (
            "reproduce.outputs_are_told",
            "in (OUTPUTS, RUNNING)",
            "in (RUNNING,)",
            "::test_outputs_and_the_way_it_is_run_are_no_part_of_the_command",
        ),
    ),
    *of_one_file(
        "diagnosis/report/provenance.py",
        "tests/diagnosis/report/test_provenance.py",
        (
            "provenance.the_day_of_the_epoch_is_not_taken",
            "given = os.environ.get(EPOCH)",
            "given = None",
            "::test_the_day_is_that_of_source_date_epoch",
        ),
    ),
    *of_one_file(
        "diagnosis/factors/change_point.py",
        "tests/diagnosis/factors/test_change_point.py",
        (
            "change_point.ramps_are_steps",
            'for shape in ("step", "ramp")',
            'for shape in ("step",)',
            "::test_interval_holds_the_change[ramp-8.0]",
        ),
        (
            "change_point.interval_of_half",
            "LEVEL = 0.95",
            "LEVEL = 0.5",
            "::test_interval_holds_the_change[step-2.0]",
        ),
    ),
    *of_one_file(
        "diagnosis/factors/series.py",
        "tests/scenarios/test_fail_on.py",
        (
            "series.directions_together",
            "if all(min(np.count_nonzero(way > 0), np.count_nonzero(way < 0)) >= FEWEST_ROWS for way in ways):",
            "if False:",
            "::test_monitor",
        ),
    ),
    *of_one_file(
        "twin/presets/__init__.py",
        "tests/twin/test_simulate.py",
        (
            "presets.hide_a_file_of_their_name",
            "if Path(name).is_file():",
            "if False:",
            "::test_a_file_that_bears_a_presets_name_is_not_passed_over",
        ),
    ),
)
