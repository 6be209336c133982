"""The best designs as a person reads them in a terminal."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from scenarios.studies.design.check import Check
from scenarios.studies.design.distance import Distance
from scenarios.studies.design.study import DesignStudy, feasible
from twin.angles import Array, IntArray

_COLUMNS = (
    "field: at the sensor, from the warmest to the coldest; margin: from it to the nearer end of the window, below 0 "
    "outside of it",
    "error: as designed, at its worst over turn and temperature; 95 %: what 95 % of the mountings keep; 1 mT: what so "
    "much stray field adds",
    "noise: bits that it leaves of a turn; yield: mountings that keep the demand",
)
"""What the columns of the table mean."""
_WHY = "largest yield, and of equal ones the smallest error of 95 % of the mountings"


def show(found: Mapping[str, Array], rows: IntArray, study: DesignStudy, check: Check, *, sensor: str) -> None:
    """Print how many designs of a sensor keep the demand, which to take, what its error is made of, and the check."""
    console, demand, space = Console(highlight=False), study.demand, study.space
    good = int(np.count_nonzero(feasible(found, demand)))
    low, high = demand.temperature_c
    console.print(
        f"[bold]{good} of {space.designs} designs[/bold] keep {demand.max_error_deg:g} deg and "
        f"{demand.window_mT[0]:g} to {demand.window_mT[1]:g} mT from {low:g} to {high:g} C in "
        f"{100 * demand.min_yield:g} % of {demand.mountings} mountings, with the sensor of {sensor}"
    )
    if not good:
        console.print("None does: what follows comes closest. A wider --air-gap, --diameter or --tolerance may.")
    columns: dict[str, Callable[[int], str]] = {
        "magnet": lambda r: f"{space.grades[int(found['grade'][r])]} {_size(found['design'][r])}",
        "gap\nmm": lambda r: f"{found['design'][r][3]:.2f}",
        "field\nmT": lambda r: f"{found['field_low_mT'][r]:.0f}-{found['field_high_mT'][r]:.0f}",
        "margin\nmT": lambda r: f"{found['margin_mT'][r]:.1f}",
        "error\ndeg": lambda r: f"{found['error_deg'][r]:.3f}",
        "95 %\ndeg": lambda r: f"{found['error_p95_deg'][r]:.3f}",
        "1 mT\ndeg": lambda r: f"{found['stray_error_deg'][r]:.2f}",
        "noise\nbits": lambda r: f"{found['resolution_bits'][r]:.1f}",
        "yield\n%": lambda r: f"{100 * found['yield'][r]:.1f}",
    }
    table = Table(box=None, pad_edge=False, padding=(0, 1), header_style="bold")
    for name in columns:
        table.add_column(name, justify="left" if name == "magnet" else "right", no_wrap=True)
    for row in rows:
        table.add_row(*(write(int(row)) for write in columns.values()))
    console.print(table)
    for words in _COLUMNS:
        console.print(words, style="dim")
    if good:
        console.print(
            f"[bold]take {_named(found, rows[0], study)}[/bold]: of those that keep the demand it has the {_WHY}"
        )
    else:
        console.print(f"take none; {_named(found, rows[0], study)} comes closest, by yield and then by error")
    causes = {
        name.partition(".")[2]: column[rows[0]] for name, column in found.items() if name.startswith("error_deg.")
    }
    largest = sorted(causes, key=lambda name: -causes[name])[:5]
    console.print("error of the first, by cause: " + ", ".join(f"{name} {causes[name]:.3f}" for name in largest))
    console.print(
        f"checked: its own twin simulated errs by {check.simulated_error_deg:.3f} deg ({check.error_deg:.3f} here); "
        f"magpylib has {check.magpylib_mT:.3f} mT on the axis ({check.field_mT:.3f} here)"
    )


def _named(found: Mapping[str, Array], row: int, study: DesignStudy) -> str:
    design = found["design"][row]
    return f"{study.space.grades[int(found['grade'][row])]} {_size(design)} at {design[3]:.2f} mm"


def show_distances(found: Sequence[Distance]) -> None:
    """Print at which distance each magnet of the best designs is least non-linear."""
    console = Console(highlight=False)
    if not found:
        console.print("least non-linear distance: none, as nothing in this twin depends on the field")
        return
    console.print(
        "least non-linear distance of each magnet, where what depends on the field errs least (25 C, on the axis, "
        "mountings and window not asked):"
    )
    for one in found:
        console.print(f"  {one.words()}")


def _size(design: Array) -> str:
    return f"{design[0]:.3g} x {design[1]:.3g} mm"
