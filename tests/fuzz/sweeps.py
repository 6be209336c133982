"""Sweeps broken at random: a simulated one, its numbers changed, then its text, then its bytes."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from functools import cache

import numpy as np

from tests.command_line import Array, csv_text
from twin.chain import Chain
from twin.motion import Motion

Generator = np.random.Generator
Table = dict[str, Array]

ODD_NUMBERS = (0.0, -0.0, 1.0, -1.0, 1e-300, -1e-300, 1e-12, 1e12, -1e12, 1e9, 1e300, -1e300, np.inf, -np.inf, np.nan)
ODD_CELLS = (
    "",
    "nan",
    "inf",
    "1e400",
    "1_000",
    "0x10",
    "--",
    "1.2.3",
    "9" * 400,
    "\u0661\u0662",
    "true",
    '"',
    "'",
    "#",
    "-",
)


@cache
def bases() -> tuple[Table, ...]:
    """Sweeps of ordinary sizes, from twelve angles to two turns in both directions with every column."""
    chain = Chain().with_effect("offset", x_percent=0.7, y_percent=-0.4).with_effect("noise", rms_deg=0.02)
    sensors = (chain, chain.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0))
    tables = []
    for number, (points, turns, both) in enumerate([(12, 1, False), (36, 1, False), (36, 2, True), (90, 2, True)]):
        for sensor in sensors:
            there = np.arange(points * turns) * 360.0 / points
            angle = np.concatenate([there, there[::-1]]) if both else there
            motion = _recorded(angle, speed_rpm=60.0 * (number % 2))
            tables.append(
                {name: np.array(values) for name, values in sensor.simulate(motion, seed=number).columns.items()}
            )
    return tuple(tables)


def _recorded(angle_deg: Array, *, speed_rpm: float) -> Motion:
    """A motion over these angles with everything recorded."""
    size = angle_deg.size
    way = np.where(np.gradient(angle_deg) >= 0.0, 1.0, -1.0)
    return Motion.from_angle(
        np.radians(angle_deg),
        time_s=0.01 * np.arange(size) if speed_rpm else 0.5 * np.arange(size),
        direction=way,
        speed_rad_s=way * speed_rpm * 2.0 * np.pi / 60.0,
        turn=np.floor(np.arange(size) / 36.0),
        temperature_c=np.linspace(20.0, 60.0, size),
        has_channels=True,
    )


# ---- numbers ----------------------------------------------------------------------------------------------------


def _column(table: Table, rng: Generator) -> str:
    return str(rng.choice(list(table)))


def _some_rows(table: Table, rng: Generator) -> Array:
    size = next(iter(table.values())).size
    return np.flatnonzero(rng.random(size) < rng.choice([0.02, 0.2, 0.9]))


def _cells(table: Table, rng: Generator) -> Table:
    name = _column(table, rng)
    table[name][_some_rows(table, rng)] = rng.choice(ODD_NUMBERS)
    return table


def _scaled(table: Table, rng: Generator) -> Table:
    name = _column(table, rng)
    with np.errstate(all="ignore"):
        table[name] = table[name] * rng.choice([-1.0, 0.0, np.pi / 180.0, 180.0 / np.pi, 2.0, 1e-13, 1e-6, 1e6, 1e11])
    return table


def _shifted(table: Table, rng: Generator) -> Table:
    table[_column(table, rng)] += rng.choice([0.5, 180.0, -360.0, 1e5, 1e9, -1e12])
    return table


def _constant(table: Table, rng: Generator) -> Table:
    name = _column(table, rng)
    table[name] = np.full(table[name].size, rng.choice([table[name][0], *ODD_NUMBERS]))
    return table


def _coarse(table: Table, rng: Generator) -> Table:
    name, step = _column(table, rng), rng.choice([0.01, 1.0, 10.0, 45.0])
    table[name] = np.round(table[name] / step) * step
    return table


def _noisy(table: Table, rng: Generator) -> Table:
    name = _column(table, rng)
    table[name] = table[name] + rng.choice([1e-9, 0.1, 5.0, 30.0]) * rng.standard_normal(table[name].size)
    return table


def _wild(table: Table, rng: Generator) -> Table:
    rows, name = _some_rows(table, rng), "measured_deg" if "measured_deg" in table else _column(table, rng)
    table[name][rows] += rng.uniform(-180.0, 180.0, rows.size)
    return table


def _dropped(table: Table, rng: Generator) -> Table:
    names = [name for name in table if name not in ("reference_deg", "measured_deg") or rng.random() < 0.1]
    for name in names:
        if rng.random() < 0.5:
            del table[name]
    return table or {"reference_deg": np.zeros(9)}


def _swapped(table: Table, rng: Generator) -> Table:
    one, other = _column(table, rng), _column(table, rng)
    table[one], table[other] = table[other].copy(), table[one].copy()
    return table


def _rows(table: Table, rng: Generator) -> Table:
    size = next(iter(table.values())).size
    order = {
        "few": np.arange(min(size, int(rng.integers(0, 30)))),
        "back": np.arange(size)[::-1],
        "mixed": rng.permutation(size),
        "again": np.repeat(np.arange(size), int(rng.integers(2, 6)))[:2000],
        "part": np.sort(rng.choice(size, size // 2, replace=False)),
        "sorted": np.argsort(table[_column(table, rng)], kind="stable"),
        "drawn": rng.integers(0, size, size),
    }[str(rng.choice(["few", "back", "mixed", "again", "part", "sorted", "drawn"]))]
    return {name: values[order] for name, values in table.items()}


def _clock(table: Table, rng: Generator) -> Table:
    size = next(iter(table.values())).size
    steps = rng.choice([1e-9, 1e-3, 1.0, 1e6]) * rng.choice([0.0, 1.0, -1.0, 50.0], size, p=[0.1, 0.8, 0.05, 0.05])
    table["time_s"] = np.cumsum(steps)
    table["speed_rpm"] = np.full(size, rng.choice([0.0, 1e-9, 60.0, -3000.0, 1e7]))
    return table


NUMBERS: tuple[Callable[[Table, Generator], Table], ...] = (
    *(_cells, _scaled, _shifted, _constant, _coarse, _noisy, _wild, _dropped, _swapped, _rows, _rows, _clock),
)

# ---- text and bytes ---------------------------------------------------------------------------------------------


def _cell_of_text(text: str, rng: Generator) -> str:
    lines = text.split("\n")
    row = int(rng.integers(0, len(lines)))
    cells = lines[row].split(",")
    cells[int(rng.integers(0, len(cells)))] = str(rng.choice(ODD_CELLS))
    lines[row] = ",".join(cells)
    return "\n".join(lines)


def _line_of_text(text: str, rng: Generator) -> str:
    lines = text.split("\n")
    row = int(rng.integers(0, len(lines)))
    change = str(rng.choice(["drop", "double", "comment", "blank", "short", "long", "header", "move"]))
    new = {
        "drop": [],
        "double": [lines[row], lines[row]],
        "comment": ["# " + lines[row]],
        "blank": ["", "   ", lines[row]],
        "short": [lines[row].rpartition(",")[0]],
        "long": [lines[row] + ",1" * int(rng.integers(1, 2000))],
        "header": [lines[0]],
        "move": [lines[row][::-1]],
    }[change]
    return "\n".join([*lines[:row], *new, *lines[row + 1 :]])


def _parted(text: str, rng: Generator) -> str:
    if rng.random() < 0.3:
        return text.replace(".", ",").replace(",", ";", 3)
    return text.replace(",", str(rng.choice([";", "\t", " ", ", ", '","', "|"]))).replace(
        "\n", str(rng.choice(["\n", "\r\n", "\r"]))
    )


TEXTS: tuple[Callable[[str, Generator], str], ...] = (_cell_of_text, _line_of_text, _parted)


def _bytes_changed(raw: bytes, rng: Generator) -> bytes:
    found = bytearray(raw)
    for _ in range(int(rng.integers(1, 20))):
        place = int(rng.integers(0, len(found) + 1))
        change = rng.random()
        if change < 0.4 and place < len(found):
            found[place] = int(rng.integers(0, 256))
        elif change < 0.7:
            found[place:place] = bytes(rng.integers(0, 256, int(rng.integers(1, 5)), dtype=np.uint8))
        else:
            del found[place : place + int(rng.integers(1, 50))]
    return bytes(found)


def _encoded(raw: bytes, rng: Generator) -> bytes:
    text = raw.decode("utf-8", "replace")
    change = str(rng.choice(["mark", "utf-16", "utf-32", "gzip", "cut gzip", "cut", "twice", "parquet"]))
    return {
        "mark": b"\xef\xbb\xbf" + raw,
        "utf-16": text.encode("utf-16"),
        "utf-32": text.encode("utf-32"),
        "gzip": gzip.compress(raw),
        "cut gzip": gzip.compress(raw)[: int(rng.integers(1, 400))],
        "cut": raw[: int(rng.integers(0, len(raw) + 1))],
        "twice": raw + raw,
        "parquet": b"PAR1" + raw + b"PAR1",
    }[change]


BYTES: tuple[Callable[[bytes, Generator], bytes], ...] = (_bytes_changed, _encoded)


def mutated(rng: Generator) -> bytes:
    """A sweep file with one to four changes, most of them of its numbers: those are the ones that are read."""
    bank = bases()
    table = {name: values.copy() for name, values in bank[int(rng.integers(0, len(bank)))].items()}
    for _ in range(int(rng.integers(1, 4))):
        if next(iter(table.values())).size:
            table = NUMBERS[int(rng.integers(0, len(NUMBERS)))](table, rng)
    if rng.random() < 0.5:
        text = csv_text(table)
    else:
        rows = zip(*table.values(), strict=True)
        text = "\n".join([",".join(table), *(",".join("" if v != v else repr(float(v)) for v in row) for row in rows)])
    if rng.random() < 0.25:
        text = TEXTS[int(rng.integers(0, len(TEXTS)))](text, rng)
    raw = text.encode()
    return BYTES[int(rng.integers(0, len(BYTES)))](raw, rng) if rng.random() < 0.1 else raw
