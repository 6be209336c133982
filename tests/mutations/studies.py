"""Mutations of what keeps studies and bench from losing anything: lock, marks, journal, checks beforehand."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_LOCK = "scenarios/commands/file_lock.py"
_FOLDER = "scenarios/studies/study_folder.py"
_JOURNAL = "scenarios/bench/journal.py"
_STUDY_TESTS = "tests/scenarios/test_study_folder.py"
_BENCH_TESTS = "tests/scenarios/bench/test_interruption.py"

STUDIES: tuple[Mutation, ...] = (
    Mutation(
        "lock.held",
        _LOCK,
        "fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)",
        "fcntl.flock(descriptor, fcntl.LOCK_UN)",
        (f"{_STUDY_TESTS}::test_a_second_command_in_the_folder_is_refused_until_the_first_is_gone",),
    ),
    Mutation(
        "study.damaged_chunk",
        _FOLDER,
        "if _digest_or_none(file) != wanted] if",
        "if False] if",
        (f"{_STUDY_TESTS}::test_a_damaged_chunk_is_computed_anew",),
    ),
    Mutation(
        "study.own_temporaries_alone",
        _FOLDER,
        "                if _OWN_UNFINISHED.fullmatch(left.name):\n                    _remove(left)",
        "                _remove(left)",
        (f"{_STUDY_TESTS}::test_only_what_is_surely_left_half_written_is_taken_away",),
    ),
    Mutation(
        "study.hardly_begun",
        _FOLDER,
        "begun = item.name == _DONE and item.is_dir() and not any(item.iterdir())",
        "begun = False",
        (f"{_STUDY_TESTS}::test_a_folder_that_was_hardly_begun_is_gone_on_with",),
    ),
    Mutation(
        "study.nothing_complete",
        _FOLDER,
        "if self._complete() or not self._taken_back(stores):",
        "if True:",
        (f"{_STUDY_TESTS}::test_other_settings_are_taken_up_as_long_as_nothing_is_there",),
    ),
    Mutation(
        "study.listed_alone",
        _FOLDER,
        "        if there - own:\n",
        "        if False:\n",
        (f"{_STUDY_TESTS}::test_nothing_that_no_mark_lists_goes_with_other_settings",),
    ),
    Mutation(
        "study.foreign_chunk",
        _FOLDER,
        "and place not in listed:",
        "and False:",
        (f"{_STUDY_TESTS}::test_lost_marks_are_made_again_and_a_foreign_file_is_not_replaced",),
    ),
    Mutation(
        "study.inside",
        _FOLDER,
        "return listed if inside else {}",
        "return listed",
        (f"{_STUDY_TESTS}::test_a_mark_that_leads_out_of_the_folder_is_none",),
    ),
    Mutation(
        "study.plain_files",
        "twin/regular_file.py",
        'getattr(os, "O_NOFOLLOW", 0) | ',
        "",
        (f"{_STUDY_TESTS}::test_what_is_no_plain_file_is_neither_read_nor_followed",),
    ),
    Mutation(
        "study.forged_chunk",
        "scenarios/studies/chunk_files.py",
        "not part.keys() >= set(required) or not",
        "not",
        (f"{_STUDY_TESTS}::test_a_chunk_that_is_none_while_it_is_used_is_one_line",),
    ),
    Mutation(
        "design.mountable",
        "scenarios/studies/design/run.py",
        "    require_mountable(space, demand.tolerance)\n",
        "",
        ("tests/scenarios/test_design.py::test_a_mistake_in_an_option_is_one_line_and_makes_no_folder",),
    ),
    Mutation(
        "journal.torn_line",
        _JOURNAL,
        "            self._file.truncate(self._size)\n            if not",
        "            if not",
        (f"{_BENCH_TESTS}::test_a_killed_run_goes_on",),
    ),
    Mutation(
        "journal.without_a_reading",
        _JOURNAL,
        "    if not kept.readings:\n        return Kept()\n",
        "",
        (f"{_BENCH_TESTS}::test_a_journal_without_a_reading_blocks_nothing",),
    ),
    Mutation(
        "journal.full_disk",
        _JOURNAL,
        "            if self._file.write(line) != len(line):\n",
        "            if self._file.write(line) < 0:\n",
        (f"{_BENCH_TESTS}::test_a_full_disk_is_one_line_and_room_lets_it_go_on",),
    ),
    Mutation(
        "journal.reversals",
        "scenarios/bench/plan.py",
        "            if step * heading > 0.0:\n",
        "            if heading:\n",
        (f"{_BENCH_TESTS}::test_a_run_that_goes_on_behind_a_reversal_finds_the_field_as_it_was",),
    ),
    Mutation(
        "journal.seal",
        "scenarios/bench/sealed_lines.py",
        "    if seal.encode() != found[2]:\n",
        "    if False:\n",
        (f"{_BENCH_TESTS}::test_a_damaged_journal_is_one_line_and_stays",),
    ),
    Mutation(
        "journal.settings",
        _JOURNAL,
        "difference(begun, asked, OPTIONS) if",
        '"" if',
        (
            f"{_BENCH_TESTS}::test_other_options_are_refused_by_name",
            f"{_BENCH_TESTS}::test_a_twin_or_effect_edited_under_its_name_is_another",
        ),
    ),
    Mutation(
        "journal.foreign",
        _JOURNAL,
        "        check_own(self.path)\n",
        "",
        (f"{_BENCH_TESTS}::test_what_is_no_journal_is_never_removed",),
    ),
    Mutation(
        "journal.own_files_alone",
        "scenarios/commands/outputs.py",
        "digest(target_of(path)) in written",
        "True",
        (f"{_BENCH_TESTS}::test_only_what_the_run_itself_wrote_is_replaced_unasked",),
    ),
    Mutation(
        "journal.plain_file",
        "twin/regular_file.py",
        "    if stat.S_ISREG(os.fstat(number).st_mode):\n",
        "    if True:\n",
        (f"{_BENCH_TESTS}::test_what_is_no_journal_is_never_removed",),
    ),
    Mutation(
        "journal.closed_without_a_reading",
        _JOURNAL,
        "        if not self._file.closed and not self.readings:\n",
        "        if False:\n",
        (f"{_BENCH_TESTS}::test_a_mistake_in_an_option_is_one_line_and_leaves_nothing",),
    ),
)
