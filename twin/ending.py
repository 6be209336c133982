"""What a file's name ends in: one function tells it, for all that is read, written and marked."""

from __future__ import annotations

from pathlib import Path

_PACKED = ".gz"


def ending_of(path: str | Path) -> str:
    """The ending of a name in small letters, such as ``.json``; ``.csv.gz`` where it is packed; "" without one.

    A name that is nothing but an ending, such as ``.json``, has that ending.
    """
    name = Path(path).name.lower()
    packed = _PACKED if name.endswith(_PACKED) and name != _PACKED else ""
    _, dot, last = name.removesuffix(packed).rpartition(".")
    return f"{dot}{last}{packed}" if dot else packed
