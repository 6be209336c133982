"""A figure that the paper prints, held against what the twin and the diagnosis make of it."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass

_WHERE = 10


@dataclass(frozen=True, kw_only=True)
class Held:
    """``where`` in the paper, ``what`` is counted, the printed figure and ours in ``unit``, and the remark.

    ``low`` and ``high`` are the ends of a 95 % interval of ours, where it has one. ``stated``: what the paper says in
    place of a figure, such as "below 200"; then ``printed`` is None.
    """

    where: str
    what: str
    printed: float | None
    ours: float
    unit: str
    low: float | None = None
    high: float | None = None
    stated: str = ""
    remark: str = ""

    @property
    def deviation(self) -> float | None:
        """Ours less the printed one, in the unit."""
        return None if self.printed is None else self.ours - self.printed

    @property
    def printed_words(self) -> str:
        """What the paper prints."""
        return self.stated if self.printed is None else f"{self.printed:.6g}"

    def line(self) -> str:
        """The figure as a line of the terminal."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        interval = "" if self.low is None or self.high is None else f" ({self.low:.4g} to {self.high:.4g})"
        ours = f"{self.ours:.4g}" if math.isfinite(self.ours) else "never"
        said = f"{self.where:{_WHERE}} {self.what:38} printed {self.printed_words}, ours {ours}{interval}{unit}"
        return said if self.deviation is None else f"{said}, deviation {self.deviation:+.2g}{unit}"


def lines(rows: Iterable[Held], *, width: int) -> list[str]:
    """The figures line by line, each remark below in lines of at most ``width`` characters."""
    indent = " " * (_WHERE + 1)
    said: list[str] = []
    for row in rows:
        remark = textwrap.wrap(row.remark, width, initial_indent=indent, subsequent_indent=indent)
        said += [row.line(), *remark]
    return said


def held_csv(rows: Iterable[Held]) -> str:
    """The figures as CSV, words in quotes; an interval or a deviation that there is none of stays empty."""
    lines = ["where,what,printed,ours,low,high,deviation,unit,remark"]
    for row in rows:
        low, high, deviation = ("" if value is None else f"{value:.6g}" for value in (row.low, row.high, row.deviation))
        figures = f"{row.printed_words},{row.ours:.6g},{low},{high},{deviation},{row.unit}"
        lines.append(f'"{row.where}","{row.what}",{figures},"{row.remark}"')
    return "\n".join(lines) + "\n"
