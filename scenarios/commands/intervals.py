"""Ranges and tolerances as people write them: ``-40:125``, ``0.5:4:0.5``, ``off_axis=0.3mm, tilt=1deg``."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from scenarios.commands.once import check_once
from twin.errors import UserError
from twin.known_names import nearest
from twin.shown import shown


def interval(name: str, text: str, *, example: str) -> tuple[float, float]:
    """``low:high`` as two numbers in order; one number alone is both. Raises UserError with an example of it."""
    parts = _numbers(text, ":")
    if parts is None or len(parts) not in (1, 2) or parts[0] > parts[-1]:
        raise UserError(f"{name} is {shown(text)}; expected low:high, e.g. {example}")
    return parts[0], parts[-1]


def values(name: str, text: str) -> tuple[float, ...]:
    """``low:high:step`` (high included where a step falls on it), or numbers with commas. Raises UserError."""
    steps = _numbers(text, ":")
    if steps is not None and len(steps) == 3:
        low, high, step = steps
        if step > 0.0 and low <= high and (high - low) / step < 1e5:
            count = int(np.floor((high - low) / step + 1e-9)) + 1
            return tuple(float(round(low + step * k, 12)) for k in range(count))
    listed = _numbers(text, ",")
    if listed:
        return tuple(listed)
    raise UserError(f"{name} is {shown(text)}; expected low:high:step such as 0.5:4:0.25, or numbers with commas")


def whole_values(name: str, text: str) -> tuple[int, ...]:
    """The same for whole numbers. Raises UserError for others: 36.9 readings are not 36."""
    found = values(name, text)
    for value in found:
        if value != int(value):
            raise UserError(f"{name} is {shown(text)}; expected whole numbers, found {value:g}")
    return tuple(int(value) for value in found)


def with_units(name: str, text: str, units: Mapping[str, str]) -> dict[str, float]:
    """``key=number[unit], ...`` by key, each in its own unit of ``units``; a unit may be left out. Raises UserError."""
    found: dict[str, float] = {}
    for part in filter(None, (piece.strip() for piece in text.split(","))):
        key, _, value = (piece.strip() for piece in part.partition("="))
        if key not in units:
            raise UserError(f"{name} has no '{key}'{nearest(key, units)}; expected among {', '.join(units)}")
        numbers = _numbers(value.removesuffix(units[key]), ":")
        if numbers is None or len(numbers) != 1 or numbers[0] < 0.0:
            raise UserError(f"{name}: {key} is '{value}'; expected a number in {units[key]}, 0 or more")
        check_once(name, [*found, key])
        found[key] = numbers[0]
    return found


def _numbers(text: str, between: str) -> list[float] | None:
    try:
        found = [float(part) for part in text.split(between)]
    except ValueError:
        return None
    return found if all(np.isfinite(found)) else None
