"""Twin files broken at random: effects with parameters in and out of range, tables of magnets, text and bytes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import cache
from importlib import resources

import numpy as np

from twin.catalogue import CATALOGUE
from twin.concentrator.disk import Disk
from twin.hall.spinning_current import Plate
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.presets import preset_names

Generator = np.random.Generator
ODD_VALUES = (
    *(
        "nan",
        "inf",
        "-inf",
        "-1",
        "0",
        "1e308",
        "-1e308",
        "1e-320",
        "36.9",
        "true",
        "''",
        "[]",
        "[1, 2]",
        "[nan]",
        "{}",
    ),
    *("9" * 400, "9" * 5000, "1979-05-27", "[[[]]]", "'N35H'", "'block'", "0x7fffffffffffffff", "-0.0", "5", "1e3"),
)


@cache
def presets() -> tuple[str, ...]:
    """The text of each preset."""
    folder = resources.files("twin.presets")
    return tuple(folder.joinpath(f"{name}.toml").read_text(encoding="utf-8") for name in preset_names())


def _value(rng: Generator, low: float, high: float) -> str:
    return str(rng.choice(ODD_VALUES)) if rng.random() < 0.04 else repr(float(rng.uniform(low, high)))


def _effects(rng: Generator) -> str:
    """Tables of some effects: each parameter within its limits, a little outside, or odd."""
    lines = []
    for place in rng.choice(len(CATALOGUE), int(rng.integers(1, 5)), replace=False):
        effect = CATALOGUE[int(place)]
        name = effect.name + str(rng.choice(["", "", "", "#2", "#x"]))
        lines.append(f"[effects.{name!r}]" if "#" in name else f"[effects.{name}]")
        for param, declared in effect.params.items():
            if rng.random() < 0.7:
                middle = rng.choice([declared.null, 0.5 * (declared.lower + declared.upper)])
                reach = rng.choice([declared.typical, declared.upper - declared.lower])
                low, high = max(middle - reach, declared.lower - 0.01), min(middle + reach, declared.upper + 0.01)
                value = _value(rng, low, high)
                whole = declared.counts and len(value) < 30 and value.replace(".", "").isdigit()
                lines.append(f"{param} = {round(float(value)) if whole else value}")
    return "\n".join(lines)


def _parts(rng: Generator) -> str:
    """Tables of a magnet, its place, the encoder and the hardware."""
    lines = []
    kinds = (("magnet", Magnet), ("magnet.placement", Placement), ("hardware.disk", Disk), ("hardware.plate", Plate))
    for table, kind in kinds:
        if rng.random() < 0.4:
            lines.append(f"[{table}]")
            numbers = [one.name for one in fields(kind) if not isinstance(one.default, str | bool)]
            lines += [f"{name} = {_value(rng, 0.0, 3.0)}" for name in numbers if rng.random() < 0.2]
    if rng.random() < 0.3:
        lines += ["[reference]", f"lines = {_value(rng, 1, 1e4)}", f"index_deg = {_value(rng, -360, 360)}"]
    return "\n".join(lines)


def _replaced(text: str, rng: Generator) -> str:
    """One value of the text by an odd one."""
    lines = text.split("\n")
    places = [k for k, line in enumerate(lines) if "=" in line and not line.startswith("#")]
    k = int(rng.choice(places))
    lines[k] = f"{lines[k].partition('=')[0]}= {rng.choice(ODD_VALUES)}"
    return "\n".join(lines)


def _lines(text: str, rng: Generator) -> str:
    """A line dropped, doubled or moved."""
    lines = text.split("\n")
    k, to = rng.integers(0, len(lines), 2)
    line = lines.pop(int(k))
    return "\n".join(
        lines + [line] * int(rng.integers(0, 3)) if rng.random() < 0.3 else [*lines[:to], line, *lines[to:]]
    )


def _characters(text: str, rng: Generator) -> str:
    """Characters replaced, left out or put in."""
    found = list(text)
    for _ in range(int(rng.integers(1, 8))):
        k = int(rng.integers(0, len(found)))
        found[k : k + int(rng.integers(0, 3))] = str(rng.choice(list('[]{}"=.#\n0-e\u00e9\x00_')))
    return "".join(found)


CHANGES: tuple[Callable[[str, Generator], str], ...] = (_replaced, _replaced, _lines, _characters)


def mutated(rng: Generator) -> bytes:
    """A twin file: a preset or one drawn from the catalogue, changed or as it is."""
    if rng.random() < 0.35:
        text = presets()[int(rng.integers(0, len(presets())))]
        text = CHANGES[int(rng.integers(0, len(CHANGES)))](text, rng)
    else:
        senses = "sensor_sense = -1\n" if rng.random() < 0.3 else ""
        text = "\n".join(['schema = "halltwin.twin/1"', senses, _parts(rng), _effects(rng), ""])
        if rng.random() < 0.3:
            text = CHANGES[int(rng.integers(0, len(CHANGES)))](text, rng)
    return text.encode("utf-8", "replace")
