"""The terminal that a command prints to."""

from __future__ import annotations

import shutil


def terminal_width() -> int:
    """Characters in a line: of the terminal, or what COLUMNS says; 80 in a pipe."""
    return max(shutil.get_terminal_size((80, 24)).columns, 40)
