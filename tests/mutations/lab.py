"""Mutations of the page's server: whom it answers, what it reads, and that its figures are the command line's."""

from __future__ import annotations

from tests.mutations.mutation import Mutation

_GUARD, _SERVER, _DROPPED = (f"scenarios/lab/{name}.py" for name in ("guard", "server", "dropped"))
_LAYERS, _COLUMNS, _DESIGN = (f"scenarios/lab/{name}.py" for name in ("layers", "columns", "design"))
_GUARD_TESTS = "tests/scenarios/lab/test_guard.py"
_DESIGN_TESTS = "tests/scenarios/lab/test_design.py"
_EXPLAIN_TESTS = "tests/scenarios/lab/test_explain.py"

LAB: tuple[Mutation, ...] = (
    Mutation(
        "lab.host",
        _GUARD,
        'if headers.get_all("Host") != [f"{ADDRESS}:{self.port}"]:',
        "if False:",
        (f"{_GUARD_TESTS}::test_another_name_of_this_address_is_refused",),
    ),
    Mutation(
        "lab.origin",
        _GUARD,
        'if headers.get_all("Origin", [self.origin]) != [self.origin]:',
        "if False:",
        (f"{_GUARD_TESTS}::test_another_site_is_refused",),
    ),
    Mutation(
        "lab.fetch_site",
        _GUARD,
        'not in ("same-origin", "none"):',
        'in ("nowhere",):',
        (f"{_GUARD_TESTS}::test_another_site_is_refused",),
    ),
    Mutation(
        "lab.page_alone",
        _GUARD,
        'comes = method == "GET" and not below and headers.get("Sec-Fetch-Dest") == "document"',
        'comes = method == "GET"',
        (f"{_GUARD_TESTS}::test_a_person_comes_to_the_page_from_anywhere_but_nothing_else_does",),
    ),
    Mutation(
        "lab.door_once",
        _GUARD,
        'self._code = ""',
        "pass",
        (f"{_GUARD_TESTS}::test_the_door_leads_to_the_page_once",),
    ),
    Mutation(
        "lab.secret",
        _GUARD,
        "or not secrets.compare_digest(token.encode(), self.token.encode()):",
        "or False:",
        (f"{_GUARD_TESTS}::test_nothing_is_had_without_the_secret",),
    ),
    Mutation(
        "lab.own_header",
        _GUARD,
        'if method == "POST" and OWN_HEADER not in headers:',
        "if False:",
        (f"{_GUARD_TESTS}::test_a_question_without_the_pages_own_header_is_refused",),
    ),
    Mutation(
        "lab.length",
        _SERVER,
        "if len(told) > len(str(most)) or int(told) > most:",
        "if False:",
        (f"{_GUARD_TESTS}::test_a_file_that_is_too_large_is_refused_before_it_is_read",),
    ),
    Mutation(
        "lab.hostile_name",
        _DROPPED,
        "not given.isprintable() or set(given) & set(",
        "False or set() & set(",
        (f"{_GUARD_TESTS}::test_a_hostile_name_of_a_file_is_refused",),
    ),
    Mutation(
        "lab.called_by_its_name",
        _DROPPED,
        "return UserError(str(error).replace(str(path), name).replace(path.name, name))",
        "return error",
        (f"{_EXPLAIN_TESTS}::test_a_hostile_sweep_is_one_line_that_names_it",),
    ),
    Mutation(
        "lab.scaled_to_the_field",
        _DESIGN,
        "own = in_designs(chain, designs)",
        "own = replace(chain, magnet=designs)",
        (f"{_DESIGN_TESTS}::test_an_offset_in_volts_counts_more_in_a_weaker_field",),
    ),
    Mutation(
        "lab.single_readings",
        _LAYERS,
        "among[list(cause.rows)] = True",
        "pass",
        (f"{_EXPLAIN_TESTS}::test_single_readings_come_back_where_their_cause_is_off",),
    ),
    Mutation(
        "lab.mean_without_factors",
        _LAYERS,
        "if MODEL in off:\n            left",
        "if False:\n            left",
        (f"{_EXPLAIN_TESTS}::test_all_off_is_the_error_as_measured_whatever_a_cause_does_to_the_zero",),
    ),
    Mutation(
        "lab.extremes",
        _COLUMNS,
        "np.maximum.reduceat(values, first)",
        "values[first]",
        (f"{_EXPLAIN_TESTS}::test_of_many_readings_each_column_keeps_its_extremes",),
    ),
    Mutation(
        "lab.one_piece",
        _SERVER,
        "line.write(whole.getvalue())",
        "[line.write(whole.getvalue()[k : k + 64]) for k in range(0, len(whole.getvalue()), 64)]",
        (f"{_GUARD_TESTS}::test_an_answer_comes_in_one_piece",),
    ),
    Mutation(
        "lab.signals_of_the_temperature",
        _DESIGN,
        '"after channels")[0][:, here]',
        '"after channels")[0]',
        (f"{_DESIGN_TESTS}::test_the_channels_are_those_of_the_temperature_looked_at",),
    ),
    Mutation(
        "lab.asked_first_is_answered_first",
        "scenarios/lab/session.py",
        "with self._at_hand:",
        "with threading.Lock():",
        (f"{_DESIGN_TESTS}::test_one_design_is_computed_at_a_time",),
    ),
    Mutation(
        "lab.computing_not_the_clock",
        "scenarios/lab/explain_worker.py",
        '("computed", time.thread_time() - self._began_s)',
        '("computed", time.monotonic())',
        (f"{_EXPLAIN_TESTS}::test_a_search_is_stopped_with_the_answer_so_far",),
    ),
    Mutation(
        "lab.sweep_of_the_saved_twin",
        "scenarios/lab/twins.py",
        "from_dict(tomllib.loads(saved(sensor, asked).decode()), effects=effects_with())",
        "sensor.chain",
        (f"{_DESIGN_TESTS}::test_a_saved_sweep_is_the_commands_byte_for_byte",),
    ),
    Mutation(
        "lab.example_where_it_lies",
        "scenarios/lab/sweeps.py",
        "_EXAMPLE.name, shown_path(path))",
        "_EXAMPLE.name, _EXAMPLE.name)",
        (f"{_EXPLAIN_TESTS}::test_the_example_is_named_so_that_a_command_finds_it",),
    ),
)
