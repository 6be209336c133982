"""The nomenclature page knows every unit, column and key that the program hands to the outside."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.hidden.fleets.generator import Plan, write
from tests.pages import GUIDE, ROOT
from twin.adc.converter import Converter
from twin.baseline import FACTORS
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.concentrator.disk import Disk
from twin.hall.spinning_current import Plate
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement
from twin.motion import Motion
from twin.parts import Parts
from twin.reference.encoder import Encoder
from twin.sweep import COLUMNS

PAGE = (GUIDE / "nomenclature.md").read_text(encoding="utf-8")
CODE = re.compile(r"`([^`]+)`")
TABLES = (Magnet, Placement, Encoder, Parts, Disk, Plate, Converter)
"""Parts of magnet, bench and sensor, described by a field a number; most are tables of a twin file."""


def table(heading: str) -> Iterator[list[str]]:
    """The cells of each row of the table under a heading, the header left out."""
    section = re.search(f"^#+ {re.escape(heading)}\n(.*?)(?=^#|\\Z)", PAGE, re.S | re.M)
    assert section, heading
    rows = [line for line in section[1].splitlines() if line.startswith("|")]
    for line in rows[2:]:
        yield [cell.strip() for cell in line.strip("|").split("|")]


@cache
def endings() -> dict[str, str]:
    """Unit by the ending that stands for it."""
    listed = table("Units at the end of names")
    return {ending: row[1] for row in listed for ending in CODE.findall(row[0])}


@cache
def bare_names() -> dict[str, str]:
    """What a name without a unit counts in."""
    listed = table("Names without a unit")
    return {name: row[1] for row in listed for name in CODE.findall(row[0])}


def unit_of(name: str) -> str | None:
    """The unit that a name ends in, by the longest ending that it has; None: none of the list."""
    fitting = [e for e in endings() if name == e.removeprefix("_") or name.endswith(f"_{e.removeprefix('_')}")]
    return endings()[max(fitting, key=len)] if fitting else None


@pytest.mark.parametrize("effect", CATALOGUE, ids=lambda effect: effect.name)
def test_parameters_of_effects_end_in_their_unit(effect: Any) -> None:
    for name, param in effect.params.items():
        assert bare_names().get(name, unit_of(name)) == param.unit, f"{effect.name}.{name} [{param.unit}]"


@pytest.mark.parametrize("kind", TABLES, ids=lambda kind: kind.__name__)
def test_fields_of_twin_tables_end_in_a_unit(kind: Any) -> None:
    for item in fields(kind):
        assert item.name in bare_names() or unit_of(item.name), f"{kind.__name__}.{item.name}"


def test_columns_of_a_sweep_are_listed_with_their_unit() -> None:
    listed = {name: row[1] for row in table("Columns of a sweep") for name in CODE.findall(row[0])}
    assert set(listed) == set(COLUMNS)
    for name in COLUMNS:
        assert name in bare_names() or unit_of(name) == listed[name], name


def test_factors_are_listed_by_the_name_that_people_read() -> None:
    listed = [(row[0], row[2], row[4], row[5].split()[0]) for row in table("Factors of the error model")]
    assert listed == [(f.label, f"`{f.name}`", f"`{f.key}.{f.param}`", f.shown_unit or "1") for f in FACTORS]


def leaves(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Every key of a JSON value, and the numbers that stand behind it."""
    if isinstance(value, dict):
        for name, item in value.items():
            yield name, None
            yield from leaves(item, name)
    elif isinstance(value, list):
        for item in value:
            yield from leaves(item, key)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield key, value


def undescribed(answer: Any) -> set[str]:
    """Keys that the page does not list, and names of numbers whose unit it does not know."""
    known = set(CODE.findall(PAGE)) | {effect.name for effect in CATALOGUE}
    known |= {name for effect in CATALOGUE for name in effect.params} | set(COLUMNS)
    missing = set()
    for key, number in leaves(answer):
        # Second instances of an effect have numbered parameters; rejected rows are keyed by their number.
        name = re.sub(r"(#|_)\d+$", "", key)
        if name.isdigit():
            continue
        if number is None and not {key, name} & known:
            missing.add(key)
        if number is not None and not {key, name} & set(bare_names()) and unit_of(name) is None:
            missing.add(key)
    return missing


def test_keys_of_diagnose_are_listed(tmp_path: Path) -> None:
    written = tmp_path / "found.json"
    halltwin("diagnose", ROOT / "scenarios/data/bench_sweep.csv", "--json", written)
    assert undescribed(json.loads(written.read_text(encoding="utf-8"))) == set()


def test_keys_of_monitor_are_listed(tmp_path: Path) -> None:
    """Of a series there and back, one of whose factors jumps: every key is there."""
    written, way = tmp_path / "found.json", 2.0 * np.pi * np.arange(60) / 60
    motion = Motion.from_angle(np.concatenate([way, way[::-1]]))
    for k in range(12):
        sensor = Chain().with_effect("hysteresis", lag_deg=0.1 if k < 8 else 0.4, memory_deg=5.0)
        sensor.with_effect("noise", rms_deg=0.01).simulate(motion, seed=k).write(tmp_path / f"s{k:02d}.csv")
    halltwin("monitor", tmp_path, "--json", written)
    answer = json.loads(written.read_text(encoding="utf-8"))
    assert answer["factors"]["zero_deg"]["forward"]["change"]["number"] == 9
    assert answer["factors"]["lag_deg"]["change"]["size"] == pytest.approx(0.3, abs=0.02)
    assert undescribed(answer) == set()


def test_keys_of_fleet_are_listed(tmp_path: Path) -> None:
    """Of a batch with a cause that all share, a device that stands apart, and a change: every key is there."""
    plan = Plan(count=40, cause="hysteresis", strength_deg=0.02, points=90, odd={4: ("offset", 30.0)}, moved=(25, 0.5))
    write(plan, tmp_path / "batch", seed=1)
    written = tmp_path / "found.json"
    halltwin("fleet", tmp_path / "batch", "-o", tmp_path / "study", "--json", written)
    answer = json.loads(written.read_text(encoding="utf-8"))
    assert all(answer[key] for key in ("causes", "apart", "changes", "corrections"))
    assert undescribed(answer) == set()


def test_a_new_key_would_be_missed() -> None:
    assert undescribed({"sweep": {"flux_Wb": 1.0, "rows": 3}, "rms_deg": 0.1}) == {"flux_Wb"}
