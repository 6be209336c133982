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
        lines += [f'--columns "{option}"' for option in options]
        parts.extend(Padding(Text(line), (0, 0, 0, _INSET)) for line in lines)
    return Group(*parts)
