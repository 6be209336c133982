"""What a reader may count on: no long file, no long function, and hooks that are the linters of CI."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("twin", "diagnosis", "scenarios", "tests")
FILE_LINES = 400
FUNCTION_LINES = 50


def sources(*packages: str) -> list[Path]:
    return sorted(path for package in packages for path in (ROOT / package).rglob("*.py"))


def long_functions(text: str) -> Iterator[tuple[str, int]]:
    """Name and length of each function of more than fifty lines, from ``def`` to its last line less its docstring.

    A public docstring names every parameter; it is read on its own, and a long one is no fault.
    """
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            lines = extent(node) - (extent(node.body[0]) if ast.get_docstring(node) is not None else 0)
            if lines > FUNCTION_LINES:
                yield node.name, lines


def extent(node: ast.stmt) -> int:
    return (node.end_lineno or node.lineno) - node.lineno + 1


@pytest.mark.parametrize("package", PACKAGES)
def test_no_file_is_long(package: str) -> None:
    lengths = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in sources(package)}
    assert lengths
    assert {str(path.relative_to(ROOT)): lines for path, lines in lengths.items() if lines > FILE_LINES} == {}


def test_no_function_is_longer_than_a_screen() -> None:
    found = {
        f"{path.relative_to(ROOT)}: {name}": lines
        for path in sources("twin", "diagnosis", "scenarios")
        # A command has two lines for each of its options: one takes it, one hands it on.
        if path.parent != ROOT / "scenarios" / "cli"
        for name, lines in long_functions(path.read_text(encoding="utf-8"))
    }
    assert found == {}


@pytest.mark.parametrize(("lines", "docstring", "long"), [(49, 0, False), (50, 0, True), (49, 9, False), (50, 9, True)])
def test_a_long_function_is_seen_and_its_docstring_not_counted(lines: int, docstring: int, long: bool) -> None:
    body = ['    """Say.'] + ["    more"] * (docstring - 2) + ['    """'] if docstring else []
    body += ["    x = 1"] * lines
    text = "\n".join(["def found():", *body])
    assert list(long_functions(text)) == ([("found", lines + 1)] if long else [])


def test_the_hooks_are_the_linters_of_ci() -> None:
    hooks = re.findall(r"^ +entry: (.+)$", (ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"), re.MULTILINE)
    run = re.findall(
        r'^"\$venv/bin/(ruff|mypy|lint-imports)"(.*)$', (ROOT / ".ci/run").read_text("utf-8"), re.MULTILINE
    )
    assert hooks == ["".join(command) for command in run]
    assert len(hooks) == 4
