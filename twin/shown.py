"""Values and exceptions as they may stand in a message: short, and whatever their own code does."""

from __future__ import annotations

from typing import Any

LONGEST_VALUE, LONGEST_ERROR = 40, 200


def shown(value: Any, most: int = LONGEST_VALUE) -> str:
    """A value as it may stand in a message: not longer than ``most`` characters."""
    try:
        text = repr(value)
    except Exception:
        # Python writes out no whole number of more than 4300 digits; a class of the user's own may raise anything.
        text = f"a {type(value).__name__} that cannot be shown"
    return text if len(text) <= most else text[:most] + "..."


def shown_error(error: BaseException, at: str = "") -> str:
    """The name of an exception's class, where it was raised, and what it says, in one line."""
    try:
        said = " ".join(str(error).split())
    except Exception:
        said = "what it says cannot be shown"
    said = said if len(said) <= LONGEST_ERROR else said[:LONGEST_ERROR] + "..."
    return f"{type(error).__name__}{at}: {said}"
