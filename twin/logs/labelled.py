"""Lines in which a label stands before each number, as a serial plotter or a logger of JSON writes them."""

from __future__ import annotations

import re
from collections.abc import Sequence

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|null|nan|NaN"
_PAIR = re.compile(rf"""["']?([^\W\d][\w.\[\]/ -]*?)["']?\s*[:=]\s*({_NUMBER})(?=[\s,;}}|]|$)""")
_BETWEEN = re.compile(r"[\s,;{}|]*")


def without_labels(lines: Sequence[tuple[int, str]]) -> list[tuple[int, str]] | None:
    """Numbered lines as a header and rows parted by semicolons; None where they are no labels with numbers.

    All lines have the same labels, but for the first and the last, of which a part may be missing and which are then
    left out: that is where a recording was cut.
    """
    middle = _pairs(lines[len(lines) // 2][1])
    wanted = [label for label, _ in middle]
    if len(wanted) < 2 or len(set(wanted)) < len(wanted):
        return None
    rows = []
    for place, (number, line) in enumerate(lines):
        pairs = _pairs(line)
        if [label for label, _ in pairs] == wanted:
            rows.append((number, ";".join(value for _, value in pairs)))
        elif 0 < place < len(lines) - 1:
            return None
    return [(rows[0][0], ";".join(wanted)), *rows]


def _pairs(line: str) -> list[tuple[str, str]]:
    """Labels and numbers of a line; none where anything else stands in it."""
    return _PAIR.findall(line) if _BETWEEN.fullmatch(_PAIR.sub("", line)) else []
