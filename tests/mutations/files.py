"""Mutations of how files are written and what becomes of broken ones: each rule off, with the test that notices."""

from __future__ import annotations

from tests.mutations.mutation import Mutation, of_one_file

FILES: tuple[Mutation, ...] = (
    *of_one_file(
        "twin/whole_file.py",
        "tests/twin/test_whole_file.py",
        (
            "whole_file.a_planted_link_is_followed",
            'os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0)',
            "os.O_WRONLY | os.O_CREAT",
            "::test_names_cannot_be_foreseen_and_a_planted_link_is_not_followed",
        ),
        (
            "whole_file.permissions_are_those_of_a_new_file",
            "_keep(number, there)\n",
            "pass\n",
            "::test_a_file_keeps_its_permissions[436]",
        ),
        (
            "whole_file.a_new_file_is_for_its_owner_alone",
            "0o666 if there is None else",
            "0o600 if there is None else",
            "::test_a_new_file_has_the_permissions_that_the_umask_leaves",
        ),
        (
            "whole_file.what_was_renamed_stays",
            "                os.replace(one.before, one.target)",
            "                pass",
            "::test_of_several_files_all_are_written_or_none[3-replace]",
        ),
        (
            "whole_file.a_link_is_replaced",
            "return Path(os.path.realpath(path))",
            "return Path(os.path.abspath(path))",
            "::test_a_link_stays_and_what_it_leads_to_is_replaced",
        ),
    ),
    *of_one_file(
        "scenarios/commands/outputs.py",
        "tests/scenarios/test_outputs.py",
        (
            "outputs.an_input_is_written_over",
            "            if identity in read or ",
            "            if ",
            "::test_an_input_stays[link-simulate--o]",
        ),
        (
            "outputs.an_open_file_is_no_input",
            "            if identity in read or ",
            "            if identity in read and not is_stream(path) or ",
            "::test_an_input_that_is_open_stays[simulate--o]",
        ),
        (
            "outputs.an_open_file_is_nobodys",
            "    return is_stream(path) and _identity(path) in (_identity(1), _identity(2))",
            "    return is_stream(path)",
            "::test_an_open_file_of_somebody_else_stays",
        ),
        (
            "outputs.two_outputs_are_one_file",
            "        if names & seen:",
            "        if False:",
            "::test_an_output_is_no_other[simulate--o]",
        ),
        (
            "outputs.files_of_others_are_replaced",
            "                _check_own(path, self.formats[path], self.unfinished.get(path, ()))",
            "                pass",
            "::test_a_file_of_somebody_else_stays[simulate--o]",
        ),
        (
            "outputs.not_asked_again_before_writing",
            "        self.check(made)",
            "        pass",
            "::test_nothing_is_written_where_the_last_file_fails",
        ),
    ),
    *of_one_file(
        "scenarios/commands/marks.py",
        "tests/scenarios/test_outputs.py",
        (
            "marks.edited_files_pass_for_own",
            "return digest.hexdigest().encode() == found[1]",
            "return True",
            "::test_own_files_are_known_and_edited_ones_are_not[simulate]",
        ),
    ),
    *of_one_file(
        "scenarios/commands/inputs.py",
        "tests/scenarios/test_broken_files.py",
        (
            "inputs.left_out_in_silence",
            "        if self.unusable:",
            "        if False:",
            "::test_the_rest_is_answered[diagnose]",
        ),
    ),
    *of_one_file(
        "scenarios/cli/streams.py",
        "tests/scenarios/cli/test_streams.py",
        (
            "streams.the_interpreter_tries_again",
            "            os.dup2(nowhere, stream.fileno())",
            "            pass",
            "::test_a_full_device_to_the_end_of_the_interpreter[]",
        ),
    ),
)
