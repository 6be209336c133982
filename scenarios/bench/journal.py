"""The journal: every reading and every event as it comes, so that a measurement goes on where it was broken off.

One JSON object a line, sealed against damage: the settings of the measurement, then readings, events, and the SHA-256
of each file that is about to be written, by which a later run knows it again. The journal lies beside the sweep while
the measurement runs and stays as its log afterwards.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
from collections.abc import Mapping
from dataclasses import asdict
from io import FileIO
from pathlib import Path
from typing import Any

from scenarios.bench.journal_reader import SCHEMA, Kept, check_own, read_journal
from scenarios.bench.plan import Plan
from scenarios.bench.readings import Event, Reading
from scenarios.bench.sealed_lines import sealed
from scenarios.commands.settings import Settings, difference
from twin.errors import UserError
from twin.regular_file import digest, opened
from twin.whole_file import check_writable

OPTIONS = {
    "plan.points": "--points",
    "plan.turns": "--turns",
    "plan.both_directions": "--both-directions",
    "plan.speeds_rpm": "--speed-rpm",
    "plan.temperatures_c": "--temperatures",
    "plan.settle_s": "--settle",
    "channels": "--channels",
    "chamber": "--chamber",
    "interface": "--interface",
    "channel": "--channel",
    "bus_options": "--bus-option",
    "faults": "--fault",
    "effects": "--effects",
    "twin": "the twin's",
    "correction": "the correction",
    "seed": "--seed",
    "version": "halltwin",
}
"""What the settings of a measurement are called by who gives them."""


def running_path(sweep: Path) -> Path:
    """The journal of a sweep that is not finished."""
    return sweep.with_name(f"{sweep.name}.journal.jsonl")


def finished_path(sweep: Path) -> Path:
    """The log of a finished sweep."""
    return sweep.with_name(f"{sweep.name}.log.jsonl")


def _plain_or_nothing(path: Path) -> None:
    """Raise UserError where a link, a folder, a pipe or a device bears the name."""
    with contextlib.suppress(FileNotFoundError):
        os.close(opened(path))


class Journal:
    """Open for appending; a line is with the operating system before the next angle is driven to.

    Whoever opens it closes it, or has it finished; without a reading it leaves no file.
    """

    def __init__(self, sweep: Path, plan: Plan, *, twin: str, settings: Settings, restart: bool) -> None:
        """Begin a journal, or take up the one of a broken run.

        ``twin`` is what is measured, in words; ``settings`` are all besides the plan that the readings depend on.
        Raises UserError where there is a journal of other settings that holds readings, a damaged one, or something
        else.
        """
        check_writable(sweep)
        self._plan = plan
        self.path, self.log = running_path(sweep), finished_path(sweep)
        check_own(self.path)
        _plain_or_nothing(self.log)
        asked = {"plan": asdict(plan), **settings}
        if restart:
            self.path.unlink(missing_ok=True)
        kept = _taken_up(self.path, asked)
        self.readings, self._size, self._seal = kept.readings, kept.size, kept.seal
        # Without a buffer: what fails, fails here, and nothing is written later.
        self._file = _opened(self.path)
        try:
            # A line that was cut off goes, and so does a head that no reading followed.
            self._file.truncate(self._size)
            if not self._size:
                self._line({"schema": SCHEMA, "plan": plan.digest(), "twin": twin, "settings": asked})
        except BaseException:
            self.close()
            raise

    @property
    def complete(self) -> bool:
        """Whether every reading of the plan is there."""
        return len(self.readings) == self._plan.readings

    def keep(self, reading: Reading) -> None:
        """Write a reading. Raises UserError."""
        self._line({"reading": asdict(reading)})
        self.readings.append(reading)

    def note(self, event: Event) -> None:
        """Write an event. Raises UserError."""
        self._line({"event": asdict(event)})

    def will_write(self, contents: Mapping[Path, bytes]) -> None:
        """Say what is about to be written beside the journal, so that a later run knows it again. Raises UserError."""
        for path, content in contents.items():
            self._wrote(path.name, hashlib.sha256(content).hexdigest())

    def will_finish(self, other: Journal) -> None:
        """Take over from another journal what it wrote, itself as its log included. Raises UserError."""
        for name, digests in sorted(read_journal(other.path).wrote.items()):
            for content_digest in sorted(digests):
                self._wrote(name, content_digest)
        self._wrote(other.log.name, digest(other.path))

    def summarise(self, summary: dict[str, Any]) -> None:
        """Write the summary. Raises UserError."""
        self._line({"summary": summary})

    def finish(self) -> None:
        """Give the journal its lasting name.

        Raises UserError where another file has taken its name, or its lasting name is that of no plain file.
        """
        ours = os.fstat(self._file.fileno())
        self._file.close()
        there = os.stat(self.path, follow_symlinks=False) if os.path.lexists(self.path) else None
        if there is None or not os.path.samestat(ours, there):
            raise UserError(
                f"{self.path}: another file has taken the journal's place while the bench ran; the sweep is written, "
                "the record of its readings is lost"
            )
        _plain_or_nothing(self.log)
        self.path.replace(self.log)

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

    def _wrote(self, name: str, content_digest: str) -> None:
        self._line({"wrote": name, "sha256": content_digest})

    def _line(self, content: dict[str, Any]) -> None:
        line, seal = sealed(content, self._seal)
        try:
            if self._file.write(line) != len(line):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError as error:
            with contextlib.suppress(OSError):
                self._file.truncate(self._size)
            raise UserError(f"{self.path}: cannot be written ({error.strerror}); make room; {self.kept()}") from None
        self._size, self._seal = self._size + len(line), seal


def _opened(path: Path) -> FileIO:
    """A journal to append to, made where there is none. Raises UserError."""
    try:
        return FileIO(opened(path, os.O_RDWR | os.O_APPEND | os.O_CREAT), "ab")
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); make room, or give another path") from None


def _taken_up(path: Path, asked: Settings) -> Kept:
    """What a broken run has left; nothing where it comes to nothing. Raises UserError."""
    kept = read_journal(path)
    if not kept.readings:
        return Kept()
    begun = kept.head.get("settings")
    other = difference(begun, asked, OPTIONS) if isinstance(begun, dict) else "other settings"
    if other:
        raise UserError(
            f"{path}: was begun with {other}; give the same options to go on with it, or --restart to begin anew"
        )
    return kept
