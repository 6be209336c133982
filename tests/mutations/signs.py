"""Mutations made from the catalogue: the sign of every strength of every effect, where the effect uses it.

Each must be noticed by the effect's leading signature, which is worked out apart from the code.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from tests.mutations.mutation import ROOT, Mutation
from twin.catalogue import CATALOGUE
from twin.effect import Effect

_TEST = "tests/contract/test_effects.py::test_leading_signature[{}]"


def signs() -> tuple[Mutation, ...]:
    """One mutation for each place where an effect's forward model uses a strength."""
    found: dict[tuple[str, str, str], Mutation] = {}
    for effect in CATALOGUE:
        for mutation in _of(effect):
            place = (mutation.file, mutation.old, mutation.new)
            # Effects of one family share their forward model: any of them may notice.
            known = found.get(place)
            found[place] = mutation if known is None else replace(known, tests=(*known.tests, *mutation.tests))
    return tuple(found.values())


def _of(effect: Effect) -> Iterator[Mutation]:
    if not inspect.isfunction(effect.forward):
        # In a described magnet's field: tests/twin/test_magnet_field.py holds it against the field itself.
        return
    file = Path(inspect.getfile(effect.forward)).resolve()
    lines, first = inspect.getsourcelines(effect.forward)
    source = file.read_text(encoding="utf-8").splitlines(keepends=True)
    for name in effect.roles("strength"):
        if effect.params[name].null != 0.0:
            # A ratio, which is never negative.
            continue
        used = f'values["{name}"]'
        for number, line in enumerate(lines):
            if used not in line:
                continue
            old = _only(source, first - 1 + number)
            new = old.removesuffix(line) + line.replace(used, f"(-1.0 * {used})")
            yield Mutation(
                f"sign.{effect.name}.{name}", str(file.relative_to(ROOT)), old, new, (_TEST.format(effect.name),)
            )


def _only(source: list[str], place: int) -> str:
    """The line at ``place`` with as many lines before it as make it occur once in the file."""
    whole = "".join(source)
    for start in range(place, -1, -1):
        text = "".join(source[start : place + 1])
        if whole.count(text) == 1:
            return text
    return whole
