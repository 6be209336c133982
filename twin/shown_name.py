"""The name of a file as text that every output can hold."""

from __future__ import annotations

import os
from pathlib import Path


def shown_name(path: str | Path) -> str:
    """The last part of a path; bytes in it that are no UTF-8, as old disks have them, become the replacement mark."""
    return os.fsencode(Path(path).name).decode("utf-8", errors="replace")
