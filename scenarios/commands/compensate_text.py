"""A correction as a person reads it: what it is made of, what it leaves out, the error without and with it.

Figures are told to two digits of their uncertainty.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from diagnosis.correction.compensation import Correction
from diagnosis.correction.cross_validation import BeforeAfter
from diagnosis.report.wording import decimals_of, rms_shown

Rows = Sequence[tuple[str, BeforeAfter]]
_HEADS = ("RMS / deg", "largest / deg")
_NARROW = 72
"""Characters of a line below which the figures stand under the name of what they are of."""


@dataclass(frozen=True)
class MadeOf:
    """What a correction was made of: a name, what became of the readings in words, and how well it is known [deg].

    ``readings`` is empty for a twin.
    """

    name: str
    readings: str
    uncertainty_deg: float


def show(made_of: MadeOf, correction: Correction, rows: Rows, console: Console | None = None) -> None:
    """Print a correction and the errors [deg] of the readings that it was tried on, by their name."""
    console = console or Console(highlight=False)
    decimals = decimals_of(made_of.uncertainty_deg)
    if made_of.readings:
        console.print(Text(f"{made_of.name}   {made_of.readings}"))
    console.print(
        Text(
            f"{'' if made_of.readings else f'{made_of.name}: '}shaft = {correction.slope:+d} x reading "
            f"{-np.degrees(correction.zero_rad):+.{decimals}f} deg + {correction.series.shape[1]} orders, "
            f"the largest {_largest_deg(correction):.{decimals}f} deg"
        )
    )
    if correction.left_out:
        left_out = ", ".join(correction.left_out)
        console.print(Text(f"not in the correction, because a single angle reading cannot tell it: {left_out}"))
    if rows:
        console.print(_table(rows) if console.width >= _NARROW else _list(rows))


def _table(rows: Rows) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column("angle error without -> with it", overflow="fold")
    for head in _HEADS:
        table.add_column(head, no_wrap=True)
    for name, found in rows:
        table.add_row(Text(name), *_figures(found))
    return table


def _list(rows: Rows) -> Table:
    table = Table.grid()
    table.add_column(overflow="fold")
    table.add_row("angle error without -> with it")
    for name, found in rows:
        table.add_row(Text(name))
        for head, told in zip(_HEADS, _figures(found), strict=True):
            table.add_row(Padding(Text(f"{head}: {told}"), (0, 0, 0, 4)))
    return table


def _figures(found: BeforeAfter) -> Iterable[str]:
    """RMS and largest error, without and with the correction; a single error is known to the RMS of what is left."""
    rms, readings = found.rms_deg, found.before_rad.size
    yield " -> ".join(rms_shown(value, readings) for value in rms)
    decimals = decimals_of(rms[1])
    yield " -> ".join(f"{value:.{decimals}f}" for value in found.peak_deg)


def _largest_deg(correction: Correction) -> float:
    sizes = np.hypot(correction.series[0], correction.series[1])
    return float(np.degrees(sizes.max())) if sizes.size else 0.0
