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
from diagnosis.correction.left_of_readings import of_words
from diagnosis.report.motion import correction_words
from diagnosis.report.row_counts import counts_of, diagnosed_rows, left_out_words
from diagnosis.report.temperature_text import lines
from diagnosis.report.wording import decimals_of, rms_shown
from scenarios.commands.compensate_source import Readings
from scenarios.commands.left_words import left_words
from scenarios.commands.terminal import terminal_width

Rows = Sequence[tuple[str, BeforeAfter]]
_HEADS = ("RMS / deg", "largest / deg")
_NARROW = 72
"""Characters of a line below which the figures stand under the name of what they are of."""


@dataclass(frozen=True)
class MadeOf:
    """What a correction was made of: a name, what became of the readings in words, and how well it is known [deg].

    ``readings`` is empty for a twin. ``temperature``: what they say of it, line by line; ``faults``: of their words;
    ``motion``: what has to be kept in mind where they had no reference.
    """

    name: str
    readings: str
    uncertainty_deg: float
    temperature: Sequence[str] = ()
    faults: Sequence[str] = ()
    motion: Sequence[str] = ()


def made_of(readings: Readings | None, name: str, tolerance_deg: float) -> MadeOf:
    """What is told of the readings, of which there are none where a twin is corrected."""
    if readings is None:
        return MadeOf(name, "", tolerance_deg)
    counts, end = [], 0
    for sweep in readings.sweeps:
        start, end = end, end + len(sweep)
        gross = sweep.numbers[readings.calibration.gross[start:end]].tolist()
        counts.append({"sweep": sweep.name, **counts_of(sweep, gross)})
    rows, fitted = (sum(one[key] for one in counts) for key in ("rows", "fitted"))
    told = diagnosed_rows(counts[0]) if len(counts) == 1 else left_out_words(counts) or "all fitted"
    # Of the mean of so many readings; and no better than the orders that were left out.
    known_deg = float(np.degrees(readings.calibration.sigma_rad)) / np.sqrt(fitted)
    faults = [f"not removed: {left_words(left)}" for left in of_words(readings.as_read)]
    return MadeOf(
        name,
        f"{rows} readings; {told}",
        max(known_deg, tolerance_deg),
        _of_temperature(readings),
        faults,
        correction_words(readings.estimated),
    )


def show(made: MadeOf, correction: Correction, rows: Rows, console: Console | None = None) -> None:
    """Print a correction and the errors [deg] of the readings that it was tried on, by their name."""
    console = console or Console(highlight=False)
    decimals = decimals_of(made.uncertainty_deg)
    if made.readings:
        console.print(Text(f"{made.name}   {made.readings}"))
    console.print(
        Text(
            f"{'' if made.readings else f'{made.name}: '}shaft = {correction.slope:+d} x reading "
            f"{-np.degrees(correction.zero_rad):+.{decimals}f} deg + {correction.series.shape[1]} orders, "
            f"the largest {_largest_deg(correction):.{decimals}f} deg{_following(correction)}"
        )
    )
    for line in (*made.motion, *made.temperature):
        console.print(Text(line))
    if correction.left_out:
        left_out = ", ".join(correction.left_out)
        console.print(Text(f"not in the correction, because a single angle reading cannot tell it: {left_out}"))
    for line in made.faults:
        console.print(Text(line))
    if correction.to_middle:
        console.print(Text(f"corrected to the middle between both directions: {', '.join(correction.to_middle)}"))
    if rows:
        console.print(figures(rows, console.width))


def figures(rows: Rows, width: int) -> Table:
    """Errors without and with a correction, for a terminal of so many characters."""
    return _table(rows) if width >= _NARROW else _list(rows)


def _following(correction: Correction) -> str:
    drift = correction.drift
    if drift is None:
        return ""
    orders = drift.series.shape[2]
    which = f"zero and orders 1 to {orders}" if orders > 1 else "zero and order 1" if orders else "the zero"
    return f"; {which} follow{'s' if orders == 0 else ''} the temperature, {drift.low_c:.1f} .. {drift.high_c:.1f} C"


def _of_temperature(readings: Readings) -> list[str]:
    """What the readings say of the temperature."""
    over = readings.calibration.over
    if over is not None:
        said = lines(readings.laws(), terminal_width())
        return said if over.followed.any() else [*said, "- the correction is the same at every temperature"]
    words = readings.temperature_words
    return [] if words is None else [words]


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
