"""The journal: every reading and every event as it comes, so that a measurement goes on where it was broken off.

One JSON object a line. It lies beside the sweep while the measurement runs and stays as its log afterwards.
"""

from __future__ import annotations

import contextlib
import errno
import json
import math
import os
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from scenarios.bench.plan import Plan
from scenarios.bench.readings import Event, Reading
from twin.errors import UserError
from twin.whole_file import check_writable

SCHEMA = "halltwin.bench/1"
_WHOLE, _FLAGS, _OPTIONAL = ("index", "direction", "turn"), ("index_seen", "corrected"), ("temperature_c", "vx", "vy")
"""Entries of a reading: whole numbers, true or false, and such as may be missing. All others are numbers."""


def running_path(sweep: Path) -> Path:
    """The journal of a sweep that is not finished."""
    return sweep.with_name(f"{sweep.name}.journal.jsonl")


def finished_path(sweep: Path) -> Path:
    """The log of a finished sweep."""
    return sweep.with_name(f"{sweep.name}.log.jsonl")


class Journal:
    """Open for appending; a line is with the operating system before the next angle is driven to.

    Whoever opens it closes it, or has it finished; without a reading it leaves no file.
    """

    def __init__(self, sweep: Path, plan: Plan, *, twin: str, restart: bool) -> None:
        """Begin a journal, or take up the one of a broken run.

        Raises UserError where that one is of another plan and holds readings, or is damaged.
        """
        check_writable(sweep)
        self._sweep = sweep
        self._plan = plan
        self.path = running_path(sweep)
        head = {"schema": SCHEMA, "plan": plan.digest(), "twin": twin}
        if restart:
            self.path.unlink(missing_ok=True)
        self.readings, self._size = _taken_up(self.path, head, plan.readings)
        # Without a buffer: what fails, fails here, and nothing is written later.
        self._file = self.path.open("ab", buffering=0)
        try:
            # A line that was cut off goes, and so does a head that no reading followed.
            self._file.truncate(self._size)
            if not self._size:
                self._line(head)
        except BaseException:
            self.close()
            raise

    @property
    def complete(self) -> bool:
        """Whether every reading of the plan is there."""
        return {reading.index for reading in self.readings} >= {stop.index for stop in self._plan.stops()}

    def keep(self, reading: Reading) -> None:
        """Write a reading. Raises UserError."""
        self._line({"reading": asdict(reading)})
        self.readings.append(reading)

    def note(self, event: Event) -> None:
        """Write an event. Raises UserError."""
        self._line({"event": asdict(event)})

    def finish(self, summary: dict[str, Any]) -> Path:
        """Write the summary and give the journal its lasting name. Raises UserError."""
        self._line({"summary": summary})
        self._file.close()
        return self.path.replace(finished_path(self._sweep))

    def close(self) -> None:
        """Leave the journal for a later run, where there is something to go on from."""
        if not self._file.closed and not self.readings:
            self.path.unlink(missing_ok=True)
        self._file.close()

    def kept(self) -> str:
        """What a run that broke off leaves, and how to go on."""
        if not self.readings:
            return "nothing is measured yet: run again with the same options"
        return (
            f"{len(self.readings)} of {self._plan.readings} readings are kept in {self.path}: run again with the same "
            "options to go on"
        )

    def _line(self, content: dict[str, Any]) -> None:
        line = (json.dumps(content) + "\n").encode()
        try:
            if self._file.write(line) != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError as error:
            with contextlib.suppress(OSError):
                self._file.truncate(self._size)
            raise UserError(f"{self.path}: cannot be written ({error.strerror}); make room; {self.kept()}") from None
        self._size += len(line)


def _taken_up(path: Path, head: dict[str, Any], readings: int) -> tuple[list[Reading], int]:
    """The readings of a broken run, and how many bytes of its journal hold; none where it comes to nothing."""
    try:
        raw = path.read_bytes()
    except FileNotFoundError:
        return [], 0
    whole = raw[: raw.rfind(b"\n") + 1]
    begins = json.dumps({"schema": SCHEMA}).removesuffix("}").encode()
    if not raw.startswith(begins[: len(raw)]):
        raise UserError(f"{path}: is no journal of the bench; move it away, or --restart")
    entries = []
    for number, line in enumerate(whole.splitlines(), 1):
        try:
            entries.append(_entry(line, readings))
        except (ValueError, RecursionError) as error:
            said = "is no JSON" if isinstance(error, json.JSONDecodeError | UnicodeDecodeError) else str(error)
            raise UserError(f"{path}: line {number} is damaged: {said}; move the file away, or --restart") from None
    found = [entry["reading"] for entry in entries if "reading" in entry]
    if not found:
        return [], 0
    for key, value in head.items():
        if entries[0].get(key) != value:
            raise UserError(
                f"{path}: belongs to another measurement (its {key} is {entries[0].get(key)!r}, not {value!r}); "
                "give the same options to go on with it, or --restart"
            )
    return found, len(whole)


def _entry(line: bytes, readings: int) -> dict[str, Any]:
    """A line of a journal, its reading as such. Raises ValueError."""
    entry = json.loads(line)
    if not isinstance(entry, dict):
        raise ValueError("is no object")
    return {**entry, "reading": _reading(entry["reading"], readings)} if "reading" in entry else entry


def _reading(content: Any, readings: int) -> Reading:
    """A reading whose every entry is of its kind. Raises ValueError."""
    names = [item.name for item in fields(Reading)]
    if not isinstance(content, dict) or content.keys() != set(names):
        raise ValueError("a reading has not the entries of one")
    for name, value in content.items():
        if name in _FLAGS:
            fits = isinstance(value, bool)
        elif isinstance(value, bool) or not isinstance(value, int | float):
            fits = value is None and name in _OPTIONAL
        else:
            fits = math.isfinite(value) and (name not in _WHOLE or isinstance(value, int))
        if not fits:
            raise ValueError(f"{name} is {str(value)[:40]!r}")
    if not 0 <= content["index"] < readings or content["direction"] not in (-1, 1):
        raise ValueError("a reading that the plan does not hold")
    return Reading(**content)
