"""How a sweep's columns were read from a log under names of its own, as plain values for the JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from twin.sweep import Sweep


def how_read(sweep: Sweep) -> dict[str, Any]:
    """The statement for ``--columns``, what was taken for granted, and the log's columns that are not used.

    The statement is null where the file has a sweep's own columns.
    """
    guess = sweep.read_as
    return {
        "read_as": guess and guess.text,
        "notes": list(guess.notes) if guess else [],
        "not_used": list(guess.unused) if guess else [],
    }
