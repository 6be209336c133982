"""What a check of the set-up finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

MOST_ROWS = 20
"""Rows that a finding lists; of more it says how many there are."""


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One thing that is wrong with a set-up, or that has to be kept in mind.

    Attributes
    ----------
    kind : str
        The word by which scripts ask for it, such as ``"axial_magnet"``.
    level : {"fault", "note"}
        Whether it has to be mended before the answers mean what they say, or is taken care of and worth knowing.
    what, evidence, consequence, remedy : str
        What is found, by which figures, what becomes of an answer with it, and what to do; each a clause.
    rows : tuple of int
        Numbers of the rows that show it (the first reading is 1), where single ones do.
    columns : str
        The statement for ``--columns`` that mends it; empty where none does.
    options : tuple of str
        Statements for ``--columns`` of which one may be meant.
    """

    kind: str
    what: str
    evidence: str
    consequence: str
    remedy: str
    level: Literal["fault", "note"] = "fault"
    rows: tuple[int, ...] = ()
    columns: str = ""
    options: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """As plain values of an answer."""
        return {
            "kind": self.kind,
            "level": self.level,
            "what": self.what,
            "evidence": self.evidence,
            "consequence": self.consequence,
            "remedy": self.remedy,
            "rows": list(self.rows[:MOST_ROWS]),
            "rows_left_out": max(len(self.rows) - MOST_ROWS, 0),
            "columns": self.columns or None,
            "options": list(self.options),
        }


def rows_shown(rows: tuple[int, ...]) -> str:
    """Some row numbers as a sentence names them."""
    shown = ", ".join(map(str, rows[:5]))
    return f"row{'s' if len(rows) > 1 else ''} {shown}{f' and {len(rows) - 5} more' if len(rows) > 5 else ''}"
