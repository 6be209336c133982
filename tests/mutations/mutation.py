"""What a mutation is: one place of one file, changed so that the program still runs and no longer does the same."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]


class StaleMutationError(Exception):
    """The text that a mutation replaces is not in its file any more, or not once only."""


@dataclass(frozen=True)
class Mutation:
    """One change of the source and the tests that have to notice it.

    Attributes
    ----------
    name : str
        What is broken, as ``part.mechanism``.
    file : str
        The file that is changed, relative to the root of the repository.
    old, new : str
        The text that is replaced, which occurs once in the file, and what replaces it.
    tests : tuple of str
        Node ids of pytest; at least one of them has to fail.
    short : bool
        Whether its tests take less than three seconds: such mutations are tried by the test suite too.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    short: bool = False

    def applied(self, source: str) -> str:
        """The source with the mutation in it.

        Raises
        ------
        StaleMutationError
            If ``old`` does not occur exactly once, with the mutation's name.
        """
        found = source.count(self.old)
        if found != 1:
            raise StaleMutationError(
                f"{self.name}: {self.file} has {found} places that read {self.old!r}; expected 1: "
                "correct the mutation's text, or take the mutation out if its mechanism is gone"
            )
        return source.replace(self.old, self.new)

    def apply_to(self, root: Path) -> str:
        """Write the mutated file below ``root`` and return the text that stood there before."""
        path = root / self.file
        if not path.is_file():
            raise StaleMutationError(f"{self.name}: there is no file {self.file}: correct the mutation's path")
        before = path.read_text(encoding="utf-8")
        path.write_text(self.applied(before), encoding="utf-8")
        return before


def of_one_file(file: str, tests: str, *rows: tuple[str, str, str, str]) -> tuple[Mutation, ...]:
    """Mutations of one file, each noticed by one test.

    Parameters
    ----------
    file, tests : str
        The file that is changed, and the folder or file of the tests, relative to the root of the repository.
    *rows : tuple of str
        Name, text that is replaced, what replaces it, and node id below the folder or, with ``::`` first, the file.
    """
    return tuple(
        Mutation(name, file, old, new, (f"{tests}{'' if test.startswith('::') else '/'}{test}",))
        for name, old, new, test in rows
    )


def of_one_test(part: str, tests: str, *rows: tuple[str, str, str, str, str]) -> tuple[Mutation, ...]:
    """Mutations of one part of the program, each noticed by one test of the same file.

    Parameters
    ----------
    part, tests : str
        What the names begin with, and the file of the tests, relative to the root of the repository.
    *rows : tuple of str
        Name, file that is changed, text that is replaced, what replaces it, and name of the test.
    """
    return tuple(
        Mutation(f"{part}.{name}", file, old, new, (f"{tests}::{test}",)) for name, file, old, new, test in rows
    )


def checked(mutations: Iterable[Mutation], root: Path = ROOT) -> tuple[Mutation, ...]:
    """The mutations, each of which can be applied.

    Raises
    ------
    StaleMutationError
        For the first that cannot, or that bears a name twice or no test.
    """
    kept: dict[str, Mutation] = {}
    for mutation in mutations:
        if mutation.name in kept:
            raise StaleMutationError(f"{mutation.name}: two mutations bear this name")
        if not mutation.tests:
            raise StaleMutationError(f"{mutation.name}: no test is named that must fail")
        path = root / mutation.file
        if not path.is_file():
            raise StaleMutationError(f"{mutation.name}: there is no file {mutation.file}: correct the mutation's path")
        mutation.applied(path.read_text(encoding="utf-8"))
        kept[mutation.name] = mutation
    return tuple(kept.values())
