"""Where an answer comes from: what made it, when, and how to make it again."""

from __future__ import annotations

import os
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from typing import Any

from twin.errors import UserError
from twin.shown import shown

EPOCH = "SOURCE_DATE_EPOCH"
"""Environment variable that says, in seconds since 1970, which day it is taken to be; see reproducible-builds.org."""


@dataclass(frozen=True, kw_only=True)
class Provenance:
    """What made an answer: the version, the day (UTC), the seed, and the command line, None for a call from Python."""

    version: str
    date: str
    seed: int
    command: str | None = None

    @classmethod
    def today(cls, *, seed: int, command: str | None = None) -> Provenance:
        """The provenance of an answer that is made now. Raises UserError where the day is set to what is none."""
        return cls(version=version(), date=day(), seed=seed, command=command)

    def to_dict(self) -> dict[str, Any]:
        """As keys of an answer."""
        return {"version": self.version, "date": self.date, "seed": self.seed, "command": self.command}


def version() -> str:
    """The installed version of halltwin."""
    try:
        return metadata.version("halltwin")
    except metadata.PackageNotFoundError:
        return "not installed"


def check_day() -> None:
    """Refuse a day that is none, once for all that read it: modules of scipy and matplotlib do so as they are loaded.

    An empty one counts as unset. Raises UserError.
    """
    if not os.environ.get(EPOCH):
        os.environ.pop(EPOCH, None)
    day()


def day() -> str:
    """Today in UTC as YYYY-MM-DD: no time of day, so that the same input gives the same bytes all day long.

    Raises UserError where SOURCE_DATE_EPOCH is set and is no number of seconds.
    """
    given = os.environ.get(EPOCH)
    if not given:
        return datetime.now(UTC).date().isoformat()
    try:
        return datetime.fromtimestamp(int(given), UTC).date().isoformat()
    except (ValueError, OverflowError, OSError):
        raise UserError(f"{EPOCH} is {shown(given)}; expected whole seconds since 1970, or leave it unset") from None
