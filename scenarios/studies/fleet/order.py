"""The order in which devices were made, as far as their files tell it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from twin.angles import Array, IntArray
from twin.errors import UserError
from twin.sweep_columns import COLUMNS

NAME, GIVEN = "name", "given"
_DIGITS = re.compile(r"(\d+)")


def check_order(order: str) -> None:
    """Refuse what orders nothing. Raises UserError."""
    if order not in (NAME, GIVEN, *COLUMNS):
        raise UserError(
            f"--order {order}: expected {NAME} (numbers in the files' names), {GIVEN} (as the files are given), or a "
            f"column of the sweeps: {', '.join(COLUMNS)}"
        )


def in_order(paths: Sequence[Path], order: str) -> list[Path]:
    """The files in their order where names tell it: device 2 ahead of device 10."""
    return list(paths) if order == GIVEN else sorted(paths, key=lambda path: _by_numbers(path.as_posix()))


def places_by(values: Array) -> IntArray:
    """Places of devices in the order of a column's first values (N,); those that lack it come last, as they stood."""
    return np.asarray(np.argsort(np.where(np.isnan(values), np.inf, values), kind="stable"))


def _by_numbers(name: str) -> list[tuple[int, int, str]]:
    """A key that sorts numbers in a name by their size, and the rest as text."""
    parts = _DIGITS.split(name)
    return [(1, int(part), part) if part.isdecimal() else (0, 0, part) for part in parts if part]
