"""A monitored series as a person reads it in a terminal: the charts, and what drifts which way since when."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from diagnosis.factors.control_chart import BOTH, Chart
from diagnosis.factors.series import LABELS, RESIDUAL, MonitoredSeries
from diagnosis.report.wording import decimals_of, unit_shown

_WIDE = 100
"""Characters in a line from which on the scatter and the sweeps' names have room."""
_NARROW = 72
"""Characters in a line below which each chart is told in a sentence, not in a row of a table."""


def show(found: MonitoredSeries, console: Console | None = None) -> None:
    """Print the series."""
    console = console or Console(highlight=False)
    console.print(Text(_head(found)))
    console.print()
    console.print(_table(found, wide=console.width >= _WIDE) if console.width >= _NARROW else _list(found))
    console.print()
    for line in _drifts(found):
        console.print(Text(line))


def way(item: Chart) -> str:
    """Which way a signalled factor moves, and in which direction of travel where it has charts of both."""
    travel = "" if item.travel == BOTH else f" ({item.travel})"
    return f"{'up' if item.direction > 0 else 'down'}{travel}"


def _head(found: MonitoredSeries) -> str:
    apart = ", directions also apart" if any(item.travel != BOTH for item in found.charts) else ""
    return (
        f"{len(found.names)} sweeps; EWMA charts of {len({item.name for item in found.charts})} factors{apart}, "
        f"together one false alarm in {found.run_length:.0f} sweeps; a lasting shift by one standard deviation shows "
        f"after {found.delay:.0f} on average"
    )


# ---- the charts -----------------------------------------------------------------------------------------------------


def _table(found: MonitoredSeries, *, wide: bool) -> Table:
    table = Table(box=None, padding=(0, 2 if wide else 1, 0, 0))
    for head in ("factor", "readings", "unit"):
        table.add_column(head, overflow="fold")
    for head in ("first", "last", "scatter") if wide else ("first", "last"):
        table.add_column(head, justify="right", no_wrap=True)
    table.add_column("signal at", overflow="fold")
    table.add_column("began at (95 %)", overflow="fold")
    before = ""
    for item in _in_order(found):
        figures = _figures(item)
        table.add_row(
            "" if item.name == before else LABELS[item.name],
            item.travel,
            _unit(item),
            *(figures if wide else figures[:2]),
            _signalled(found, item, wide=wide),
            _began(item),
            style="" if item.signal is None else "bold",
        )
        before = item.name
    return table


def _list(found: MonitoredSeries) -> RenderableType:
    """The charts on a terminal that is too narrow for a table: nothing is cut."""
    lines = []
    for item in _in_order(found):
        first, last, _ = _figures(item)
        told = (
            "" if item.signal is None else f"; signal at {_signalled(found, item, wide=False)}; began at {_began(item)}"
        )
        words = f"{LABELS[item.name]}, {item.travel}: {first} -> {last} {_unit(item)}".rstrip()
        lines.append(Text(f"{words}{told}", style="" if item.signal is None else "bold"))
    return Group(*lines)


def _in_order(found: MonitoredSeries) -> list[Chart]:
    """The charts of one factor one after the other."""
    names = list(dict.fromkeys(item.name for item in found.charts))
    return sorted(found.charts, key=lambda item: names.index(item.name))


def _figures(item: Chart) -> tuple[str, str, str]:
    """First and last value and the scatter of a value, to two digits of that.

    The RMS of the residual is charted by its logarithm and told in deg.
    """
    first, last, scatter = float(item.values[0]), float(item.values[-1]), item.scatter
    if item.name == RESIDUAL:
        first, last = (float(np.degrees(np.exp(value))) for value in (first, last))
        scatter *= first
    decimals = decimals_of(scatter)
    return f"{first:.{decimals}f}", f"{last:.{decimals}f}", f"{scatter:.{decimals}f}"


def _unit(item: Chart) -> str:
    return "deg" if item.name == RESIDUAL else unit_shown(item.unit)


def _signalled(found: MonitoredSeries, item: Chart, *, wide: bool) -> str:
    if item.signal is None:
        return "-"
    named = f" ({found.names[item.signal]})" if wide else ""
    return f"{item.signal + 1}{named}, {'up' if item.direction > 0 else 'down'}"


def _began(item: Chart) -> str:
    change = item.change
    return "-" if change is None else f"{change.first + 1} ({change.low + 1}..{change.high + 1})"


# ---- what drifts ----------------------------------------------------------------------------------------------------


def _drifts(found: MonitoredSeries) -> Iterator[str]:
    """One line a factor that drifts, in the order of the signals."""
    if not found.signalled:
        yield "no drift signalled"
    told: set[str] = set()
    for item in found.signalled:
        if item.name in told or item.signal is None or item.change is None:
            continue
        told.add(item.name)
        low, high = (found.names[place] for place in (item.change.low, item.change.high))
        when = f"first signalled at sweep {item.signal + 1} of {len(found.names)}"
        between = f"{item.change.low + 1} ({low}) to {item.change.high + 1} ({high})"
        what = f"a {item.change.shape} {_size(item)} that began at sweep {item.change.first + 1}, 95 %: {between}"
        yield f"{LABELS[item.name]} drifts {way(item)}: {when}; {what}"


def _size(item: Chart) -> str:
    """By how much a factor has changed, to two digits of its scatter; the RMS of the residual by a ratio."""
    assert item.change is not None
    size = item.change.size
    if item.name == RESIDUAL:
        ratio = float(np.exp(size))
        return f"to {ratio:.{decimals_of(item.scatter * ratio)}f} times"
    return f"of {size:+.{decimals_of(item.scatter)}f} {_unit(item)}".rstrip()
