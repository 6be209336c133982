"""Examples as a Python prompt shows them, on pages and in docstrings: run, and compared with what comes out."""

from __future__ import annotations

import doctest
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

NUMBER = re.compile(r"(?<![\w.])[-+±]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
CLOSE = 0.03
"""Numbers may differ by so much of themselves: numerical libraries differ in the last digits, and a seed's simulated
sweeps with them."""
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


class Checker(doctest.OutputChecker):
    """Compares the words of an output, and its numbers to within :data:`CLOSE` or a unit of the last digit shown."""

    def check_output(self, want: str, got: str, optionflags: int) -> bool:
        """Whether an output is the one wanted; three dots stand for anything, at the end for further numbers too."""
        words = (NUMBER.sub("#", text) for text in (want, got))
        wanted, found = NUMBER.findall(want), NUMBER.findall(got)
        if "..." in want:
            found = found[: len(wanted)]
        alike = len(wanted) == len(found) and all(map(_close, wanted, found))
        return alike and super().check_output(*words, optionflags)


def _close(wanted: str, found: str) -> bool:
    a, b = (float(text.strip("±")) for text in (wanted, found))
    if re.fullmatch(r"[-+]?\d+", wanted):
        return a == b
    last_digit = 10.0 ** -len(wanted.partition(".")[2])
    return abs(a - b) <= max(CLOSE * abs(a), 1.001 * last_digit)


def run_page(page: Path) -> None:
    """Run the examples of a page of Markdown, one after the other; fail with every one that shows something else."""
    text = re.sub(r"^```.*$", "", page.read_text(encoding="utf-8"), flags=re.M)
    _run(doctest.DocTestParser().get_doctest(text, {}, page.name, str(page), 0))


def docstring_examples(module: ModuleType) -> Iterator[Any]:
    """The docstrings of a module that hold examples, each to be run by :func:`run_docstring`."""
    for found in doctest.DocTestFinder(exclude_empty=True).find(module):
        if found.examples:
            yield pytest.param(found, id=found.name)


def run_docstring(found: doctest.DocTest) -> None:
    """Run the examples of one docstring."""
    _run(found)


def _run(found: doctest.DocTest) -> None:
    said: list[str] = []
    runner = doctest.DocTestRunner(Checker(), optionflags=FLAGS, verbose=False)
    runner.run(found, out=said.append)
    assert found.examples, f"{found.name} holds no example"
    if said:
        pytest.fail("".join(said), pytrace=False)
