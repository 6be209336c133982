"""How the firmwares that are known apply their tables: what an entry holds, in which unit, and where it stands."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from twin.angles import Array

ERROR, CORRECTION, ANGLE, READING = "error", "correction", "angle", "reading"
"""What an entry holds: how far the reading lies above the true angle, what is added to the reading, the true angle at a
reading, or the reading at a true angle."""


@dataclass(frozen=True)
class Rule:
    """How a firmware applies a table.

    ``holds`` says what an entry is. Its ``factors`` turn it into degrees, or its ``unit`` does; ``addend`` [deg] is
    what a correction of 0 is stored as. ``middle``: an entry stands for the middle of its step, not for the beginning.
    """

    firmware: str
    holds: str
    unit: str | None = None
    factors: tuple[tuple[str, float], ...] = ()
    addend: float = 0.0
    middle: bool = False

    @property
    def said(self) -> str:
        """In words what is taken for granted."""
        where = ", each at the middle of its step" if self.middle else ""
        what = {
            ERROR: "entries are taken off the reading",
            CORRECTION: "entries are added to the reading",
            ANGLE: "entries are the true angle at a reading",
            READING: "entries are the reading at even angles",
        }[self.holds]
        return f"taken as a table of {self.firmware}: {what}{where}"


TORQUES = re.compile(r"(?:.*\.)?(?:cogging_map|anticogging_map|cogging_dq_comp|force_lookup)")
"""Tables against cogging: they hold torques or currents."""
_CODES = (("*", 360.0), ("/", 65_536.0))
_CODES_OF_14_BIT = (("*", 360.0), ("/", 16_384.0))
_CODES_OF_12_BIT = (("*", 360.0), ("/", 4096.0))
REGISTERS, SIGNED = 32, "correction_bytes"
"""How many registers the MA600's table of corrections has, a byte each; what they are called once they are signed."""
_MIDDLE, _LARGEST_CODE = 32_768.0, 65_536.0
_LISTED: tuple[tuple[str, Callable[[Array], bool], Rule], ...] = (
    ("calibrationLut", lambda entries: not _whole(entries), Rule("SimpleFOC", ERROR, unit="rad")),
    (
        "calibrationLut",
        lambda entries: _whole(entries) and _between(entries, _MIDDLE / 2.0, _MIDDLE * 1.5),
        Rule("SimpleFOC", ERROR, factors=_CODES, addend=180.0),
    ),
    (
        r"(?:\w*_)?offset_lut",
        lambda entries: _whole(entries),
        Rule("the mini cheetah's drive, of 16384 counts a turn", CORRECTION, factors=_CODES_OF_14_BIT),
    ),
    (
        r"(?:.*\.)?compensation_table",
        lambda entries: not _whole(entries) and entries.size == 32,
        Rule("moteus", CORRECTION, unit="rev", middle=True),
    ),
    (
        r"(?:.*\.)?compensation_table",
        lambda entries: not _whole(entries) and entries.size == 256,
        Rule("moteus", CORRECTION, unit="rev"),
    ),
    (
        r"angle\..*\.calibrate",
        lambda entries: _between(entries, 0.0, _LARGEST_CODE),
        Rule("Klipper", READING, factors=_CODES),
    ),
    (
        SIGNED,
        lambda entries: entries.size == REGISTERS and _between(entries, -128.0, 127.0),
        Rule("the MA600", CORRECTION, factors=_CODES_OF_12_BIT),
    ),
    (
        "lookup",
        lambda entries: entries.size == 16_384 and not _whole(entries) and _between(entries, 0.0, 360.0),
        Rule("Mechaduino", ANGLE),
    ),
)
"""Of each firmware the name of its table, what its entries look like, and how it applies them."""


def is_known(name: str) -> bool:
    """Whether a firmware is known by the name of its table."""
    return any(re.fullmatch(pattern, name, re.IGNORECASE) for pattern, _, _ in _LISTED)


def rule_of(name: str, entries: Array) -> Rule | None:
    """How a table (n,) of this name is applied; None where no firmware is known that has such a one."""
    fitting = (rule for pattern, fits, rule in _LISTED if re.fullmatch(pattern, name, re.IGNORECASE) and fits(entries))
    return next(fitting, None)


def _whole(entries: Array) -> bool:
    return bool(np.all(entries % 1.0 == 0.0))


def _between(entries: Array, low: float, high: float) -> bool:
    return bool(np.all((entries >= low) & (entries <= high)))
