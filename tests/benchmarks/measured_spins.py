"""Measured spins: what is found in each, and whether a correction from one half of a log predicts the other half.

``python -m tests.benchmarks.measured_spins`` reads the logs beside the checkout. What is locked to the angle in the
half that was not asked about is measured by a fit of its own (orders 1 to 16 beside cubics in time over four turns
each), before and after the correction made from the other half. ``--with-reference`` lists which sweeps with a
reference have time stamps that allow hiding it, and holds the two corrections of those against each other.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from tests.hidden.spins.peers import weighted_fit
from tests.hidden.spins.rotor import Array
from tests.hidden.spins.sensor import coefficients, rms_of_orders
from tests.hidden.spins.study import DEFAULT_ANSWERER, Answerer, answerer_of
from tests.measured import DATA

LONGEST_S = 0.02
"""Between readings: with more, a bench has stopped to measure."""
LEAST_TURNS = 1.0
GRID_DEG = 360.0 / 1440 * np.arange(1440)
Columns = dict[str, Array]


def read(path: Path) -> Columns:
    """The columns of a file by name; empty and unreadable cells are NaN."""
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    names = lines[0].split(",")
    rows = np.genfromtxt(lines[1:], delimiter=",", ndmin=2)
    return {name: rows[:, place] for place, name in enumerate(names)}


def write(path: Path, columns: Mapping[str, Array]) -> Path:
    """A file of them."""
    cells = [[f"{one:.9f}" for one in values] for values in columns.values()]
    path.write_text(
        "\n".join([",".join(columns), *(",".join(row) for row in zip(*cells, strict=True))]) + "\n", "utf-8"
    )
    return path


def locked_rms_deg(columns: Mapping[str, Array]) -> float:
    """RMS of what is locked to the angle in a log, over orders 1 to 16."""
    return rms_of_orders(weighted_fit(columns)(GRID_DEG) - GRID_DEG)


@dataclass(frozen=True)
class Halves:
    """What is locked to the angle in each half [deg], before and after the correction from the other one."""

    before_deg: tuple[float, float]
    after_deg: tuple[float, float]

    @property
    def factor(self) -> float:
        """By how much it becomes smaller, the worse of the two."""
        return min(before / after for before, after in zip(self.before_deg, self.after_deg, strict=True))


def halves(columns: Columns, answerer: Answerer) -> Halves:
    """Each half of a log corrected from the other."""
    middle = len(columns["time_s"]) // 2
    parts = [{name: values[rows] for name, values in columns.items()} for rows in (slice(middle), slice(middle, None))]
    before, after = [], []
    with tempfile.TemporaryDirectory() as folder:
        for at, part in enumerate(parts):
            _, corrected, _ = answerer([str(write(Path(folder) / f"half{at}.csv", part))])
            other = parts[1 - at]
            before.append(locked_rms_deg(other))
            after.append(locked_rms_deg({**other, "measured_deg": corrected(other["measured_deg"])}))
    # told of the half that was corrected, the first one first
    return Halves((before[1], before[0]), (after[1], after[0]))


def why_not(columns: Mapping[str, Array]) -> str:
    """Why the reference of a sweep cannot be hidden; "" where it can."""
    if "time_s" not in columns:
        return "no time stamps"
    lapse = float(np.median(np.diff(columns["time_s"])))
    if not 0.0 < lapse <= LONGEST_S:
        return f"stop and measure: {lapse:g} s from one reading to the next"
    turns = float(np.sum(np.abs(np.mod(np.diff(columns["measured_deg"]) + 180.0, 360.0) - 180.0))) / 360.0
    return "" if turns >= LEAST_TURNS else f"{turns:.1f} turns"


def apart_deg(path: Path, answerer: Answerer) -> float:
    """RMS over orders 1 to 16 between the corrections with the reference and without it."""
    columns = read(path)
    hidden = {name: values for name, values in columns.items() if name not in ("reference_deg", "turn")}
    with tempfile.TemporaryDirectory() as folder:
        _, without, _ = answerer([str(write(Path(folder) / path.name, hidden))])
    _, given, _ = answerer([str(path)])
    both = []
    for corrected in (given, without):
        told = corrected(GRID_DEG)
        sense = 1.0 if np.abs(np.mean(np.exp(1j * np.radians(told - GRID_DEG)))) > 0.5 else -1.0
        away = np.exp(1j * np.radians(sense * told - GRID_DEG))
        both.append(np.degrees(np.angle(away * np.conj(np.mean(away)))))
    return rms_of_orders(both[0] - both[1])


def verdict_of(answer: Mapping[str, Any]) -> str:
    """The verdict, and whether the search was cut short."""
    return f"{answer.get('verdict', '')}{' (cut short)' if answer.get('cut_short') else ''}"


def told(answer: Mapping[str, Any]) -> str:
    """The causes of an answer with their intervals, in a line."""
    found = []
    for entry in answer["causes"]:
        figures = ", ".join(
            f"{name} {one['value']:.4g} [{one['low']:.4g}, {one['high']:.4g}]"
            for name, one in entry.get("parameters", {}).items()
            if all(isinstance(one.get(end), float | int) for end in ("value", "low", "high"))
        )
        others = ", ".join(entry.get("indistinguishable_from", ()))
        found.append(f"{entry['name']} ({figures})" + (f" or {others}" if others else ""))
    return "; ".join(found) or "nothing"


def orders_of(columns: Mapping[str, Array]) -> str:
    """The three strongest orders that are locked to the angle, whatever makes them."""
    sizes = np.abs(coefficients(weighted_fit(columns)(GRID_DEG) - GRID_DEG))
    return ", ".join(f"{order + 1}: {sizes[order]:.3f}" for order in np.argsort(-sizes)[:3])


def show_spin(path: Path, answerer: Answerer) -> None:
    """A log whole, and by halves."""
    columns = read(path)
    print(f"{path.name}: locked to the angle {locked_rms_deg(columns):.4f} deg RMS ({orders_of(columns)})")
    try:
        answer, _, unseparated = answerer([str(path)])
        print(f"  {verdict_of(answer)}: {told(answer)}")
        print(f"  orders left open: {sorted(unseparated) or 'none'}")
        found = halves(columns, answerer)
        pairs = zip(found.before_deg, found.after_deg, strict=True)
        text = "; ".join(f"{before:.4f} -> {after:.4f}" for before, after in pairs)
        print(f"  first half, second half, each by the other: {text} deg (at least {found.factor:.1f} times less)")
    except Exception as error:
        print(f"  no answer: {type(error).__name__}: {error}")


def show_together(paths: Sequence[Path], answerer: Answerer) -> None:
    """Logs of one device at several speeds."""
    print(" + ".join(path.name for path in paths))
    try:
        answer, _, unseparated = answerer([str(path) for path in paths])
        print(f"  {verdict_of(answer)}: {told(answer)}; orders left open: {sorted(unseparated) or 'none'}")
    except Exception as error:
        print(f"  no answer: {type(error).__name__}: {error}")


def show_with_reference(answerer: Answerer) -> None:
    """Of every sweep with a reference whether it can be hidden, and what comes out."""
    for path in sorted(
        one for folder in ("real", "cases", "physics", "spins") for one in (DATA / folder).glob("*.csv")
    ):
        columns = read(path)
        if not {"reference_deg", "measured_deg"} <= set(columns):
            continue
        reason = why_not(columns)
        if reason:
            print(f"{path.parent.name}/{path.name}: {reason}")
            continue
        try:
            print(f"{path.parent.name}/{path.name}: {apart_deg(path, answerer):.4f} deg RMS apart")
        except Exception as error:
            print(f"{path.parent.name}/{path.name}: no answer: {type(error).__name__}: {error}")


def main(arguments: Sequence[str] | None = None) -> None:
    """The command."""
    options = argparse.ArgumentParser(prog="python -m tests.benchmarks.measured_spins", description=__doc__)
    options.add_argument("--with-reference", action="store_true")
    options.add_argument("--only", default="", help="part of the names of the files to keep")
    options.add_argument("--answerer", default=DEFAULT_ANSWERER, help="module:function")
    options.add_argument("--budget", type=float, default=120.0, help="seconds of computing for each log of an answer")
    asked = options.parse_args(arguments)
    answerer = partial(answerer_of(asked.answerer), budget_s=asked.budget)
    if asked.with_reference:
        show_with_reference(answerer)
        return
    folder = DATA / "spins"
    files = [*sorted(folder.glob("*.csv")), DATA / "cases" / "D06b_spin_down_no_reference_column.csv"]
    for path in files:
        if asked.only in path.name and "reference_deg" not in read(path):
            show_spin(path, answerer)
    if asked.only in "resolver":
        show_together([folder / "resolver_060rpm.csv", folder / "resolver_600rpm.csv"], answerer)


if __name__ == "__main__":
    main()
