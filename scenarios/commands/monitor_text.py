"""A monitored series as a person reads it in a terminal: a table of the charts, and what drifts since when."""

from __future__ import annotations

from collections.abc import Iterator

from rich.console import Console
from rich.table import Table
from rich.text import Text

from diagnosis.factors.control_chart import BOTH, Chart
from diagnosis.factors.series import MonitoredSeries

_WIDE = 100
"""Characters in a line from which on the scatter and the sweeps' names have room."""


def show(found: MonitoredSeries, console: Console | None = None) -> None:
    """Print the series."""
    console = console or Console(highlight=False)
    console.print(Text(_head(found)))
    console.print()
    console.print(_table(found, wide=console.width >= _WIDE))
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


def _table(found: MonitoredSeries, *, wide: bool) -> Table:
    table = Table(box=None, padding=(0, 2 if wide else 1, 0, 0))
    table.add_column("factor", no_wrap=True)
    table.add_column("readings", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for head in ("first", "last", "scatter") if wide else ("first", "last"):
        table.add_column(head, justify="right", no_wrap=True)
    table.add_column("signal at", no_wrap=True)
    table.add_column("began at (95 %)", no_wrap=True)
    names = {item.name: 0 for item in found.charts}
    for item in sorted(found.charts, key=lambda one: list(names).index(one.name)):
        repeated, names[item.name] = names[item.name], 1
        figures = [item.values[0], item.values[-1], item.scatter] if wide else [item.values[0], item.values[-1]]
        table.add_row(
            "" if repeated else item.name,
            item.travel,
            item.unit,
            *(f"{value:.5f}" for value in figures),
            _signalled(found, item, wide=wide),
            _began(item),
            style="" if item.signal is None else "bold",
        )
    return table


def _signalled(found: MonitoredSeries, item: Chart, *, wide: bool) -> str:
    if item.signal is None:
        return "-"
    arrow = "up" if item.direction > 0 else "down"
    named = f" ({found.names[item.signal]})" if wide else ""
    return f"{item.signal + 1}{named}, {arrow}"


def _began(item: Chart) -> str:
    change = item.change
    return "-" if change is None else f"{change.first + 1} ({change.low + 1}..{change.high + 1})"


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
        unit = "" if item.unit == "1" else f" {item.unit}"
        yield (
            f"drift: {item.name} {way(item)}, first signalled at sweep {item.signal + 1} of {len(found.names)}; "
            f"a {item.change.shape} of {item.change.size:+.3g}{unit} that began at sweep {item.change.first + 1}, "
            f"95 %: {item.change.low + 1} ({low}) to {item.change.high + 1} ({high})"
        )
