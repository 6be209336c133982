"""Print what a study of spins found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from ..coverage import Interval, pooled
from ..coverage_table import table as coverage_table
from .judging import GOAL_DEG

Record = Mapping[str, Any]


def print_all(console: Console, records: Sequence[Record]) -> None:
    """Every table that the records give."""
    accuracy = [one for one in records if one["causes"] is None]
    if accuracy:
        asked = {label for label, ones in _by(accuracy, "protocol").items() if any("rms_deg" in one for one in ones)}
        if asked:
            console.print(_accuracy([one for one in accuracy if one["protocol"] in asked]))
        console.print(_beside(accuracy))
        _print_open(console, [one for one in accuracy if one["protocol"] == "one_speed" and "rms_deg" in one])
    named = [one for one in records if one["causes"] is not None]
    if named:
        console.print(_names(named))
    intervals = [
        {label: Interval(**one) for label, one in record["intervals"].items()}
        for record in records
        if "intervals" in record
    ]
    if any(intervals):
        console.print(coverage_table(intervals))
    for record in records:
        if "failed" in record:
            console.print(f"failed: {record['key']}: {record['failed']}", markup=False)


def _by(records: Sequence[Record], key: str) -> dict[str, list[Record]]:
    found: dict[str, list[Record]] = {}
    for record in records:
        found.setdefault(record[key], []).append(record)
    return found


def _accuracy(records: Sequence[Record]) -> Table:
    table = Table(title="Error left over orders 1 to 16, RMS in degrees", title_justify="left")
    heads = (
        "spins",
        "draws",
        f"<= {GOAL_DEG:g}",
        "median",
        "95 %",
        "worst",
        "bound 95 %",
        "factor",
        "intervals",
        "failed",
        "CPU s",
    )
    for head in heads:
        table.add_column(head, justify="left" if head == "spins" else "right")
    for label, ones in _by(records, "protocol").items():
        table.add_row(label, *_figures(ones))
        belted = [one for one in ones if one["truth"]["belt"]]
        if any("rms_deg" in one for one in belted):
            table.add_row("  with a belt", *_figures(belted))
    return table


def _figures(records: Sequence[Record]) -> list[str]:
    done = [one for one in records if "rms_deg" in one]
    left = np.array([one["rms_deg"] for one in done])
    each = ({name: Interval(**one) for name, one in record["intervals"].items()} for record in done)
    hits = [interval.miss == 0 for interval in pooled(each).get("all measured", [])]
    bounds = [one["least_rms_deg"] for one in records if one.get("least_rms_deg") is not None]
    return [
        str(len(records)),
        f"{np.count_nonzero(left <= GOAL_DEG)}/{len(records)}",
        *(f"{np.quantile(left, share):.4f}" for share in (0.5, 0.95, 1.0)),
        f"{np.quantile(bounds, 0.95):.4f}" if bounds else "",
        f"{np.median([one['factor'] for one in done]):.1f}",
        f"{sum(hits)}/{len(hits)}",
        str(len(records) - len(done)),
        f"{np.median([one['cpu_s'] for one in done]):.1f}",
    ]


def _beside(records: Sequence[Record]) -> Table:
    """The same spins, corrected as others do it."""
    table = Table(title="Beside others on the same spins, RMS left: median / 95 % in degrees", title_justify="left")
    others = list(records[0]["peers"])
    for head in ("spins", "ours", *others, "best of them over ours"):
        table.add_column(head, justify="left" if head == "spins" else "right")
    for label, ones in _by(records, "protocol").items():
        cells = [_middle_and_most([one["rms_deg"] for one in ones if "rms_deg" in one])]
        cells += [_middle_and_most([one["peers"][other] for one in ones]) for other in others]
        ratios = [min(one["peers"].values()) / one["rms_deg"] for one in ones if "rms_deg" in one]
        table.add_row(label, *cells, f"{np.median(ratios):.1f}" if ratios else "")
    return table


def _middle_and_most(values: Sequence[float]) -> str:
    return f"{np.median(values):.3f} / {np.quantile(values, 0.95):.3f}" if values else ""


def _print_open(console: Console, records: Sequence[Record]) -> None:
    """At one speed: what stays open, and whether it is said."""
    if not records:
        return
    wrong = [one for one in records if one["wrong_orders"]]
    truly = sum(len(one["open_orders"]) for one in records)
    said = sum(len(set(one["open_orders"]) & set(one["unseparated"])) for one in records)
    console.print(
        f"At one speed, of {truly} orders that torques move by more than {GOAL_DEG:g} deg RMS {said} are said to stay "
        f"open; {len(wrong)} of {len(records)} answers have an order wrong and do not say so.",
        highlight=False,
    )
    for one in wrong:
        console.print(f"  {one['key']}: orders {one['wrong_orders']}", markup=False, highlight=False)


def _names(records: Sequence[Record]) -> Table:
    table = Table(title="Names, against what is wrong with the sensor", title_justify="left")
    for head in ("cause", "draws", "right", "failed", "not right, and the names given"):
        table.add_column(head, justify="right" if head in ("draws", "right", "failed") else "left")
    for label, ones in _by(records, "label").items():
        asked = [one for one in ones if "verdict" in one]
        wrong = Counter(
            f"{one['verdict']} ({one['protocol']}): {' + '.join(one['names']) or 'nothing'}"
            for one in asked
            if one["verdict"] != "right"
        )
        right = sum(one["verdict"] == "right" for one in asked)
        failed = sum("failed" in one for one in ones)
        told = "; ".join(f"{what} x{count}" for what, count in wrong.most_common(4))
        table.add_row(label, str(len(ones)), str(right), str(failed), told)
    return table
