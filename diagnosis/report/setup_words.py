"""What is wrong with a set-up, as a person reads it in a terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.text import Text

_INSET = 5


def setup_block(findings: Sequence[Mapping[str, Any]], title: str) -> RenderableType:
    """Findings, as an answer holds them, one below the other under a title."""
    parts: list[RenderableType] = [Text(title, "bold")]
    for number, found in enumerate(findings, 1):
        style = "bold yellow" if found["level"] == "fault" else "bold"
        parts.append(Text.assemble(f"{number:3}  ", (found["kind"], style), f"  {found['what']}"))
        lines = [f"seen in: {found['evidence']}", f"so: {found['consequence']}", f"do: {found['remedy']}"]
        options = [found["columns"]] if found["columns"] else found.get("options", ())
        parts.extend(Padding(Text(line), (0, 0, 0, _INSET)) for line in lines)
        parts.extend(columns_line(option, inset=_INSET) for option in options)
    return Group(*parts)


def columns_line(statement: str, *, inset: int, before: str = "") -> Text:
    """A statement as an option of a command, to be copied: on one line, however long, with no blank behind it.

    It has to be printed with ``soft_wrap``, or where it is a part of something with ``crop=False``.
    """
    return Text(f'{" " * inset}{before}--columns "{statement}"', no_wrap=True, overflow="ignore")
