"""A correction as a person reads it in a terminal: what it is, what it leaves out, the error without and with it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from diagnosis.correction.compensation import Correction
from diagnosis.correction.cross_validation import BeforeAfter

Rows = Sequence[tuple[str, BeforeAfter]]


def show(source: str, correction: Correction, rows: Rows, console: Console | None = None) -> None:
    """Print a correction and the errors [deg] of the readings that it was tried on, by their name."""
    console = console or Console(highlight=False)
    console.print(
        Text(
            f"{source}: shaft = {correction.slope:+d} x reading {-np.degrees(correction.zero_rad):+.4f} deg + "
            f"{correction.series.shape[1]} orders, the largest {_largest_deg(correction):.4f} deg"
        )
    )
    if correction.left_out:
        left_out = ", ".join(correction.left_out)
        console.print(Text(f"not in the correction, because a single angle reading cannot tell it: {left_out}"))
    if rows:
        console.print(_table(rows))


def _table(rows: Rows) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0))
    table.add_column("angle error without -> with it", overflow="fold")
    for head in ("RMS / deg", "largest / deg"):
        table.add_column(head, no_wrap=True)
    for name, found in rows:
        pairs = (f"{before:.4f} -> {after:.4f}" for before, after in (found.rms_deg, found.peak_deg))
        table.add_row(Text(name), *pairs)
    return table


def _largest_deg(correction: Correction) -> float:
    sizes = np.hypot(correction.series[0], correction.series[1])
    return float(np.degrees(sizes.max())) if sizes.size else 0.0
