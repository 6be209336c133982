"""The name of a file as text that every output can hold."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path


def shown_path(path: str | Path) -> str:
    """A path as it was given; what is no UTF-8 or cannot be printed, such as a line break, becomes U+FFFD."""
    text = os.fsencode(path).decode("utf-8", errors="replace")
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in text)


def distinct_names(paths: Sequence[str | Path]) -> list[str]:
    """Of each path as many of its last parts as tell it from the others, as :func:`shown_path` shows them.

    Of paths that are the very same, all.
    """
    parts = [Path(path).parts for path in paths]
    few = dict.fromkeys(parts, 0)
    length, alike = 1, set(few)
    while alike:
        # Counted, as a folder may hold a hundred thousand files.
        counts = Counter(own[-length:] for own in few)
        told = {own for own in alike if length >= len(own) or counts[own[-length:]] == 1}
        few.update(dict.fromkeys(told, length))
        alike, length = alike - told, length + 1
    return [shown_path(Path(*own[-few[own] :])) if own else "" for own in parts]


def shown_name(path: str | Path) -> str:
    """The last part of a path, as :func:`shown_path` shows it."""
    return shown_path(Path(path).name)
