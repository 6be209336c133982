"""What an earlier run wrote into its journal, read line by line with every entry checked."""

from __future__ import annotations

import contextlib
import itertools
import os
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, BinaryIO

from scenarios.bench.plan import MOST_READINGS
from scenarios.bench.readings import Reading
from scenarios.bench.sealed_lines import unsealed
from scenarios.commands.settings import flat
from twin.bounded_input import LARGEST_SWEEP_BYTES, LARGEST_TEXT_BYTES
from twin.errors import UserError
from twin.regular_file import opened

SCHEMA = "halltwin.bench/1"
_BEGINS = f'{{"schema": "{SCHEMA}"'.encode()
_WHOLE, _FLAGS, _OPTIONAL = ("index", "direction", "turn"), ("index_seen", "corrected"), ("temperature_c", "vx", "vy")
"""Entries of a reading: whole numbers, true or false, and such as may be missing. All others are numbers."""
_LARGEST = 1e10
"""No entry of a reading is larger: three hundred years in seconds."""


@dataclass
class Kept:
    """What a journal holds: its first entry, the readings, the SHA-256 of each file that its run wrote, by name.

    ``size`` bytes of it are whole lines, the last of them with this ``seal``.
    """

    head: dict[str, Any] = field(default_factory=dict)
    readings: list[Reading] = field(default_factory=list)
    wrote: dict[str, set[str]] = field(default_factory=dict)
    size: int = 0
    seal: str = ""


def read_journal(path: Path) -> Kept:
    """What a journal holds, without a line that was cut off at its end; nothing where there is none.

    Raises UserError where it is none of the bench's, or is damaged.
    """
    kept = Kept()
    _read_into(kept, path)
    return kept


def written_by_run(path: Path) -> dict[str, set[str]]:
    """The SHA-256 of each file that the run of a journal wrote, by name, as far as the journal can be read."""
    kept = Kept()
    with contextlib.suppress(UserError):
        _read_into(kept, path)
    return kept.wrote


def check_own(path: Path) -> None:
    """Raise UserError where there is something that is no journal of the bench; it may be damaged, or nothing."""
    try:
        with open(opened(path), "rb") as file:
            _check_begins(path, file)
    except FileNotFoundError:
        return
    except OSError as error:
        raise _unreadable(path, error) from None


def _read_into(kept: Kept, path: Path) -> None:
    """Take up line after line. Raises UserError."""
    try:
        with open(opened(path), "rb") as file:
            _check_begins(path, file)
            if os.fstat(file.fileno()).st_size > LARGEST_SWEEP_BYTES:
                raise UserError(f"{path}: holds more than {LARGEST_SWEEP_BYTES / 1e6:g} MB; move it away, or --restart")
            for number in itertools.count(1):
                line = file.readline(LARGEST_TEXT_BYTES)
                if not line.endswith(b"\n") and len(line) < LARGEST_TEXT_BYTES:
                    return
                try:
                    _take_up(line, kept)
                except ValueError as error:
                    raise UserError(
                        f"{path}: line {number} is damaged: {error}; move the file away, or --restart"
                    ) from None
    except FileNotFoundError:
        return
    except OSError as error:
        raise _unreadable(path, error) from None


def _check_begins(path: Path, file: BinaryIO) -> None:
    """Raise UserError where a file does not begin as a journal does, be it cut off."""
    begins = file.read(len(_BEGINS))
    file.seek(0)
    if not _BEGINS.startswith(begins):
        raise UserError(f"{path}: is no journal of the bench; move it away")


def _unreadable(path: Path, error: OSError) -> UserError:
    return UserError(f"{path}: cannot be read ({error.strerror}); move it away")


def _take_up(line: bytes, kept: Kept) -> None:
    """Take up a whole line. Raises ValueError."""
    entry, seal = unsealed(line[:-1], kept.seal)
    if not kept.size:
        flat(entry)
        kept.head = entry
    elif "reading" in entry:
        kept.readings.append(_reading(entry["reading"], len(kept.readings)))
    elif "wrote" in entry:
        kept.wrote.setdefault(str(entry["wrote"]), set()).add(str(entry.get("sha256")))
    kept.size, kept.seal = kept.size + len(line), seal


def _reading(content: Any, index: int) -> Reading:
    """The reading that is due, every entry of its kind. Raises ValueError."""
    names = [item.name for item in fields(Reading)]
    if not isinstance(content, dict) or content.keys() != set(names):
        raise ValueError("a reading has not the entries of one")
    for name, value in content.items():
        if name in _FLAGS:
            fits = isinstance(value, bool)
        elif isinstance(value, bool) or not isinstance(value, int | float):
            fits = value is None and name in _OPTIONAL
        else:
            fits = -_LARGEST < value < _LARGEST and (name not in _WHOLE or isinstance(value, int))
        if not fits:
            raise ValueError(f"{name} is no such value")
    if content["index"] != index or index >= MOST_READINGS or content["direction"] not in (-1, 1):
        raise ValueError(f"expected the reading of place {index}")
    return Reading(**content)
