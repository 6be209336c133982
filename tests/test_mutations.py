"""The mutations that take little time, and the runner that tries them all (``python -m tests.mutations``).

The budget of the short ones is a minute of CPU: at most 20, each of about two seconds (a start of pytest and its
tests) and no more than three.
"""

from __future__ import annotations

import inspect
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path

import pytest

from diagnosis.discovery.settings import DiscoverySettings
from tests.mutations import __main__ as command
from tests.mutations.mutation import ROOT, Mutation, StaleMutationError, checked
from tests.mutations.runner import ERROR, KILLED, SURVIVED, Copies, fail_unmutated, try_all, try_one
from tests.mutations.settings import NOTICED_BY, settings
from tests.mutations.signs import signs
from tests.mutations.tables import mutations
from twin.catalogue import CATALOGUE

SHORT = [mutation for mutation in mutations() if mutation.short]


@pytest.fixture(scope="module")
def copies() -> Iterator[tuple[Copies, Path]]:
    """Copies of the tree, and one of them."""
    with Copies() as made:
        yield made, made.new()


@pytest.mark.parametrize("mutation", SHORT, ids=lambda mutation: mutation.name)
def test_a_mutation_is_noticed(mutation: Mutation, copies: tuple[Copies, Path]) -> None:
    outcome = try_one(*copies, mutation)
    assert outcome.result == KILLED, outcome.said


def test_short_mutations_keep_their_budget() -> None:
    assert 0 < len(SHORT) <= 20


def test_every_mutation_can_be_applied() -> None:
    assert len(checked(mutations())) == len(mutations()) > len(SHORT)


def test_every_setting_is_another_in_some_mutation() -> None:
    changed = {mutation.name.removeprefix("settings.").rpartition("_")[0] for mutation in settings()}
    assert changed == set(NOTICED_BY) == {one.name for one in fields(DiscoverySettings)}


def test_every_strength_has_its_sign_turned() -> None:
    """So that an effect whose forward model is written in another manner does not slip through."""
    turned = {mutation.name.removeprefix("sign.") for mutation in signs()}
    # Shapes without a name share their forward models.
    # One that acts in a described magnet's field is held against that field.
    named = [effect for effect in CATALOGUE if effect.stage != "empirical" and inspect.isfunction(effect.forward)]
    strengths = {f"{e.name}.{name}" for e in named for name in e.roles("strength") if e.params[name].null == 0.0}
    assert strengths <= turned
    assert len(strengths) > 20


# ---- the runner, on a tree of one module and one test ---------------------------------------------------------------

TEST = "tests/test_total.py::test_total"
NOTICED = Mutation("sum.sign", "twin/total.py", "a + b", "a - b", (TEST,))
UNNOTICED = Mutation("sum.order", "twin/total.py", "a + b", "b + a", (TEST,))


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    root = tmp_path / "tree"
    for name in ("twin", "tests"):
        (root / name).mkdir(parents=True)
        (root / name / "__init__.py").touch()
    (root / "twin/total.py").write_text("def total(a: int, b: int) -> int:\n    return a + b\n")
    (root / TEST.split("::")[0]).write_text(
        "from twin.total import total\n\n\ndef test_total() -> None:\n    assert total(2, 3) == 5\n"
    )
    return root


def test_killed_survived_and_error_are_told_apart_in_order(tree: Path) -> None:
    wanted = [
        NOTICED,
        UNNOTICED,
        replace(NOTICED, name="no such test", tests=(f"{TEST}s",)),
        replace(NOTICED, name="no longer parses", new="a +"),
    ]
    told: list[str] = []
    outcomes = try_all(wanted, root=tree, workers=2, done=lambda outcome: told.append(outcome.mutation.name))
    assert [outcome.result for outcome in outcomes] == [KILLED, SURVIVED, ERROR, ERROR]
    assert [outcome.mutation for outcome in outcomes] == wanted
    assert sorted(told) == sorted(mutation.name for mutation in wanted)
    assert (tree / NOTICED.file).read_text().endswith("a + b\n")


def test_tests_that_never_end_are_stopped(tree: Path) -> None:
    endless = replace(NOTICED, new="a + b + sum(iter(int, 1))")
    (outcome,) = try_all([endless], root=tree, longest_s=3.0)
    assert outcome.result == ERROR


def test_tests_that_fail_anyway_are_found_before(tree: Path) -> None:
    assert fail_unmutated([NOTICED], root=tree) is None
    (tree / NOTICED.file).write_text("def total(a: int, b: int) -> int:\n    return 0 * (a + b)\n")
    said = fail_unmutated([NOTICED], root=tree)
    assert said is not None
    assert "test_total" in said


@pytest.mark.parametrize(
    ("stale", "said"),
    [
        (replace(NOTICED, old="a * b"), "sum.sign: twin/total.py has 0 places that read 'a \\* b'; expected 1"),
        (replace(NOTICED, old="a"), r"sum.sign: twin/total.py has \d places"),
        (replace(NOTICED, file="twin/sums.py"), "sum.sign: there is no file twin/sums.py"),
        (replace(NOTICED, tests=()), "sum.sign: no test is named"),
    ],
)
def test_a_mutation_that_can_not_be_applied_is_named(stale: Mutation, said: str, tree: Path) -> None:
    with pytest.raises(StaleMutationError, match=said):
        checked([stale], root=tree)
    with pytest.raises(StaleMutationError, match="two mutations bear this name"):
        checked([NOTICED, NOTICED], root=tree)


def test_the_command_ends_non_zero_where_one_survives(
    tree: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "m.json"

    def ran(*tried: Mutation, arguments: tuple[str, ...] = ()) -> int:
        monkeypatch.setattr(command, "mutations", lambda: tried)
        return command.main([*arguments, "-o", str(output)], root=tree)

    assert ran(NOTICED, UNNOTICED) == 1
    assert "survived: sum.order (twin/total.py)" in capsys.readouterr().out
    assert [(one["name"], one["result"]) for one in json.loads(output.read_text())] == [
        ("sum.sign", "killed"),
        ("sum.order", "survived"),
    ]
    assert ran(NOTICED, UNNOTICED, arguments=("--only", "sum.sign")) == 0
    assert ran(NOTICED, arguments=("--only", "product")) == 2
    assert ran(replace(NOTICED, old="a * b")) == 2
    assert "a * b" in capsys.readouterr().err
    assert ran(NOTICED, arguments=("--list",)) == 0


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_broken_off_it_leaves_no_files_behind(sent: signal.Signals, tmp_path: Path) -> None:
    environment = {**os.environ, "TMPDIR": str(tmp_path), "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.mutations", "--only", SHORT[0].name],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        # Whoever runs the tests in the background has this signal ignored, which a child would inherit.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 60.0
    while process.poll() is None and not list(tmp_path.glob("mutations-*/*/tests")) and time.monotonic() < deadline:
        time.sleep(0.02)
    process.send_signal(sent)
    process.communicate(timeout=60.0)
    assert process.returncode == 130
    assert list(tmp_path.iterdir()) == []
