"""The recovery study as tables in the terminal: the baseline's parameters, then the causes."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from scenarios.studies.recovery.cells import BASELINE

_HEAD = ("noise\ndeg", "points", "turns")


def show(found: list[dict[str, Any]]) -> None:
    """Print one row a cell; of the baseline's six parameters the one farthest from the bound."""
    console = Console(highlight=False)
    baseline = [entry for entry in found if entry["cause"] == BASELINE]
    causes = [entry for entry in found if entry["cause"] != BASELINE]
    if baseline:
        table = _table("baseline", *_HEAD, "fits", "RMS / bound", "bias / bound", "coverage %")
        for entry in baseline:
            every = entry["parameters"].values()
            farthest = max((p["rms_over_bound"] for p in every), key=lambda value: abs(value - 1.0))
            bias = max((p["bias_over_bound"] for p in every), key=abs)
            cover = sum(p["coverage"] for p in every) / len(every)
            table.add_row(
                "", *_where(entry), str(entry["repeats"]), f"{farthest:.2f}", f"{bias:+.2f}", f"{100 * cover:.0f}"
            )
        console.print(table)
        console.print("the farthest of six parameters from its Cramer-Rao bound; coverage of all", style="dim")
    if causes:
        table = _table("cause", "deg", *_HEAD, "sweeps", "named %", "false %", "RMS /\nbound", "cover %")
        for entry in causes:
            parameter: dict[str, Any] = next(iter(entry["parameters"].values()), {})
            table.add_row(
                entry["cause"],
                f"{entry['amplitude_deg']:g}",
                *_where(entry),
                str(entry["repeats"]),
                f"{100 * entry['named']:.0f}" if entry["parameters"] else "",
                f"{100 * entry['false_alarms']:.0f}",
                _or_blank(parameter.get("rms_over_bound"), 1.0, ".2f"),
                _or_blank(parameter.get("coverage"), 100.0, ".0f"),
            )
        console.print(table)


def _table(first: str, *columns: str) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 1))
    table.add_column(first)
    for name in columns:
        table.add_column(name, justify="right")
    return table


def _where(entry: dict[str, Any]) -> tuple[str, str, str]:
    return f"{entry['noise_deg']:g}", str(entry["points"]), str(entry["turns"])


def _or_blank(value: float | None, scale: float, form: str) -> str:
    return "" if value is None else format(scale * value, form)
