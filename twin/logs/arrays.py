"""Arrays of numbers in what is no table of rows: source text in C or Python, JSON, and lists of settings."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from twin.angles import Array
from twin.errors import SweepError
from twin.logs.firmware import REGISTERS, SIGNED, is_known
from twin.logs.own_tables import is_own
from twin.logs.table import INDEX, Table

FEWEST_ENTRIES = 8
_COMMENT = re.compile(r"//|/\*")
_BRACED = re.compile(r"\{([^{}]*)\}")
_LISTED = re.compile(r"\b([A-Za-z_]\w*)\s*=\s*(?:\w+(?:\.\w+)*\()?\s*\[([^\[\]]*)\]")
_BEFORE = re.compile(r"([A-Za-z_]\w*)\s*\[[^\[\]]*\][^;{}=]*=?\s*$|([A-Za-z_]\w*)\s*=?\s*$")
_MACRO = re.compile(r"#define\s+(\w+_(?:SHIFT|ZERO|SENSE))\s+\(?(-?\d{1,5})u?\b")
_LARGEST_BYTE = 127.0
_NAME_IN = 200
"""Characters before an array's numbers among which its name stands."""
_SETTING = re.compile(r"(?:conf\s+set\s+)?([A-Za-z_][\w.]*)\s+([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
_FIRST_ENTRY = re.compile(r"^[^\d\n][^\s,;]*(?: +set +[^\s,;]+)?\.0[ \t]+[-+.\d]", re.MULTILINE)
_ANY_SECTION = re.compile(r"^(?:#\*#\s*)?\[[^\[\]\n,;]+\]\s*$", re.MULTILINE)
_ENTRY = re.compile(r"(.+)\.(\d{1,9})")
_PLACE = re.compile(r"\d{1,9}")
_SECTION = re.compile(r"\[([^\[\]]+)\]")
_SAVED = "#*#"
"""What Klipper puts before the lines of its configuration that it writes itself."""
_LITERAL = re.compile(r"[+-]?(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)[fFlLuU]*")


def read_arrays(text: str, *, file: str) -> Table | None:
    """The table of a firmware in a text; None where it holds rows of cells. Raises SweepError."""
    head = text.lstrip("\ufeff \t\r\n")
    if head.startswith("<") and "</" in head:
        raise SweepError(
            f"{file}: holds settings (XML) and no readings; expected a log: record the angle against a reference, "
            "or give the table of a calibration"
        )
    found = _json(head) or _settings(text) or _sections(text) or _source(text)
    arrays = {name: np.asarray(values) for name, values in found.items() if len(values) >= FEWEST_ENTRIES}
    if not arrays:
        return None
    constants = {name: values[0] for name, values in found.items() if values and name not in arrays}
    # What leaves the range of floating point is infinite, and refused with the entry's name.
    with np.errstate(all="ignore"):
        made = _made(arrays, constants)
    return _table(made, constants, file=file)


def _json(head: str) -> dict[str, list[float]]:
    """Arrays of a JSON text by their paths; single numbers as arrays of one."""
    if not head.startswith(("{", "[")):
        return {}
    try:
        return dict(_walk(json.loads(head), ""))
    except (ValueError, RecursionError):
        return {}


def _walk(node: Any, path: str) -> Iterator[tuple[str, list[float]]]:
    if isinstance(node, dict) and node and all(_PLACE.fullmatch(key) for key in node):
        node = [node[key] for key in sorted(node, key=int)]
    if isinstance(node, list) and node and all(_is_plain(value) for value in node):
        yield path or "entry", [_real(value) for value in node]
    elif isinstance(node, dict | list):
        items = node.items() if isinstance(node, dict) else enumerate(node)
        for key, value in items:
            yield from _walk(value, f"{path}.{key}" if path else str(key))
    elif _is_plain(node):
        yield path, [_real(node)]


def _is_plain(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _real(value: float) -> float:
    """A number as floating point; a whole number beyond its range is infinite, as one with a point is."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _settings(text: str) -> dict[str, list[float]]:
    """Lines of a name and a number; those whose names end in 0, 1, 2 are the entries of an array."""
    found: dict[str, list[float]] = {}
    if not _FIRST_ENTRY.search(text):
        return found
    for line in text.splitlines():
        said = _SETTING.fullmatch(line.strip())
        if not said:
            continue
        entry = _ENTRY.fullmatch(said[1])
        values = found.setdefault(entry[1] if entry else said[1], [])
        if not entry or int(entry[2]) == len(values):
            values.append(float(said[2]))
    return found if any(len(values) >= FEWEST_ENTRIES for values in found.values()) else {}


def _sections(text: str) -> dict[str, list[float]]:
    """Lists of numbers in a configuration of sections, each list over as many lines as it takes."""
    found: dict[str, list[float]] = {}
    if not _ANY_SECTION.search(text):
        return found
    section, key = "", ""
    for line in text.splitlines():
        bare = line.removeprefix(_SAVED).strip()
        header = _SECTION.fullmatch(bare)
        said = re.match(r"([A-Za-z_]\w*)\s*[:=]\s*(.*)", bare)
        if header:
            section, key = header[1].strip(), ""
        elif section and said:
            key = f"{section.replace(' ', '.')}.{said[1]}"
            found[key] = _numbers(said[2]) or []
        elif key and bare:
            more = _numbers(bare)
            found[key] = found[key] + more if more else found[key]
            key = key if more else ""
    return {name: values for name, values in found.items() if values}


def _source(text: str) -> dict[str, list[float]]:
    """Arrays between braces, as in C, or between brackets, as in Python, under the name that is set to them."""
    if "{" not in text and not _LISTED.search(text):
        return {}
    text = _without_comments(text)
    found = {said[1]: [float(said[2])] for said in _MACRO.finditer(text)}
    for braced in _BRACED.finditer(text):
        said = _BEFORE.search(text[max(braced.start() - _NAME_IN, 0) : braced.start()])
        values = _numbers(braced[1])
        if said and values:
            found.setdefault(said[1] or said[2], values)
    for listed in _LISTED.finditer(text):
        values = _numbers(listed[2])
        if values:
            found.setdefault(listed[1], values)
    return found


def _without_comments(text: str) -> str:
    """A source text without what stands behind ``//``, and between ``/*`` and ``*/``."""
    kept, at = [], 0
    while begin := _COMMENT.search(text, at):
        mark = "\n" if begin[0] == "//" else "*/"
        end = text.find(mark, begin.end())
        kept.append(text[at : begin.start()])
        if end < 0:
            return " ".join(kept)
        at = end + len(mark)
    return " ".join([*kept, text[at:]])


def _numbers(text: str) -> list[float] | None:
    """The numbers of a list parted by commas; None where something else stands in it."""
    cells = [cell.strip() for cell in text.replace("\n", " ").split(",") if cell.strip()]
    if not all(_LITERAL.fullmatch(cell) for cell in cells):
        return None
    return [
        _real(int(cell.rstrip("lLuU"), 16)) if "x" in cell.lower() else float(cell.rstrip("fFlLuU")) for cell in cells
    ]


def _made(arrays: Mapping[str, Array], constants: Mapping[str, float]) -> dict[str, tuple[Array, str]]:
    """The arrays as numbers of one unit, with what was done to them for it.

    Whole numbers of moteus stand for parts of a scale beside them, those of C that halltwin writes count in a part of a
    code, and bytes may be signed.
    """
    made: dict[str, tuple[Array, str]] = {}
    for name, values in arrays.items():
        scale = constants.get(f"{name.rpartition('.')[0]}.compensation_scale", 0.0)
        shift = constants.get(f"{name.rpartition('_')[0].upper()}_SHIFT", 0.0)
        if name.endswith("compensation_table") and scale:
            made[name] = (values * scale / 127.0, f"{name} is taken times its scale, {scale:g}, over 127")
        elif name.endswith(("_entry", "_y")) and shift:
            made[name] = (values / np.exp2(shift), f"{name} is taken over 2^{shift:g}, its shift")
        elif name == "correction" and values.size == REGISTERS and np.max(values) > _LARGEST_BYTE:
            signed = np.where(values > _LARGEST_BYTE, values - 256.0, values)
            made[SIGNED] = (signed, f"{SIGNED} are the entries of {name}, taken as signed bytes")
        else:
            made[name] = (values, "")
    return made


def _table(arrays: Mapping[str, tuple[Array, str]], constants: Mapping[str, float], *, file: str) -> Table:
    """The arrays as long as the one that a firmware is known by, or as the longest. Raises SweepError."""
    zero = [name for name, (values, _) in arrays.items() if not np.any(values)]
    kept = {name: made for name, made in arrays.items() if name not in zero}
    if not kept:
        raise SweepError(
            f"{file}: all entries of {', '.join(zero[:3])} are 0, a table that corrects nothing; expected the table of "
            "a calibration"
        )
    known = [name for name in kept if is_known(name) or is_own(name, constants)]
    entries = max(len(kept[name][0]) for name in known or kept)
    used = {name: made for name, made in kept.items() if len(made[0]) == entries}
    left = [f"{name} (all entries are 0)" for name in zero]
    left += [f"{name} ({len(made[0])} entries)" for name, made in kept.items() if name not in used]
    notes = (f"a table of {entries} entries", *(note for _, note in used.values() if note))
    values = (np.arange(entries, dtype=np.float64), *(made[0] for made in used.values()))
    return Table(file, (INDEX, *used), values, notes=notes, left=tuple(left), entries=True, constants=constants)
