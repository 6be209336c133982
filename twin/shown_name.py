"""The name of a file as text that every output can hold."""

from __future__ import annotations

import os
from pathlib import Path


def shown_path(path: str | Path) -> str:
    """A path as it was given; what is no UTF-8 or cannot be printed, such as a line break, becomes U+FFFD."""
    text = os.fsencode(path).decode("utf-8", errors="replace")
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in text)


def shown_name(path: str | Path) -> str:
    """The last part of a path, as :func:`shown_path` shows it."""
    return shown_path(Path(path).name)
