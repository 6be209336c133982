"""The journal: every reading and every event as it comes, so that a measurement goes on where it was broken off.

One JSON object a line. It lies beside the sweep while the measurement runs and stays as its log afterwards.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

from scenarios.bench.plan import Plan
from scenarios.bench.readings import Event, Reading
from twin.errors import UserError
from twin.whole_file import check_writable, write_beside

SCHEMA = "halltwin.bench/1"


def running_path(sweep: Path) -> Path:
    """The journal of a sweep that is not finished."""
    return sweep.with_name(f"{sweep.name}.journal.jsonl")


def finished_path(sweep: Path) -> Path:
    """The log of a finished sweep."""
    return sweep.with_name(f"{sweep.name}.log.jsonl")


class Journal:
    """Open for appending; a line is with the operating system before the next angle is driven to."""

    def __init__(self, sweep: Path, plan: Plan, *, twin: str, restart: bool) -> None:
        """Begin a journal, or take up the one of a broken run. Raises UserError where that one is of another plan."""
        check_writable(sweep)
        self._sweep = sweep
        self.path = running_path(sweep)
        head = {"schema": SCHEMA, "plan": plan.digest(), "twin": twin}
        if restart:
            self.path.unlink(missing_ok=True)
        self.readings = _taken_up(self.path, head)
        fresh = not self.path.exists()
        self._file: IO[str] = self.path.open("a", encoding="utf-8")
        if fresh:
            self._line(head)

    def keep(self, reading: Reading) -> None:
        """Write a reading."""
        self.readings.append(reading)
        self._line({"reading": asdict(reading)})

    def note(self, event: Event) -> None:
        """Write an event."""
        self._line({"event": asdict(event)})

    def finish(self, summary: dict[str, Any]) -> Path:
        """Write the summary and give the journal its lasting name."""
        self._line({"summary": summary})
        self._file.close()
        return self.path.rename(finished_path(self._sweep))

    def close(self) -> None:
        """Leave the journal for a later run, where there is something to go on from."""
        self._file.close()
        if not self.readings:
            self.path.unlink(missing_ok=True)

    def _line(self, content: dict[str, Any]) -> None:
        self._file.write(json.dumps(content) + "\n")
        self._file.flush()


def finished_readings(sweep: Path) -> list[Reading]:
    """The readings in the log of a finished sweep; none where there is no such log."""
    path = finished_path(sweep)
    if not path.exists():
        return []
    content = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return [Reading(**entry["reading"]) for entry in content if "reading" in entry]


def _taken_up(path: Path, head: dict[str, Any]) -> list[Reading]:
    """The readings of a broken run; a last line that was cut off is taken away."""
    if not path.exists():
        return []
    whole, newline, _ = path.read_text(encoding="utf-8").rpartition("\n")
    lines = whole.split("\n") if newline else []
    try:
        content = [json.loads(line) for line in lines]
    except json.JSONDecodeError as error:
        raise UserError(f"{path}: is no journal of the bench ({error}); move it away, or --restart") from None
    if not content:
        path.unlink()
        return []
    for key, value in head.items():
        if content[0].get(key) != value:
            raise UserError(
                f"{path}: belongs to another measurement (its {key} is {content[0].get(key)!r}, not {value!r}); "
                "give the same options to go on with it, or --restart"
            )
    write_beside(path, (whole + "\n").encode())
    return [Reading(**entry["reading"]) for entry in content if "reading" in entry]
