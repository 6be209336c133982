"""Text as files hold it: bytes that no text holds, encodings, cells between separators, words for a missing number."""

from __future__ import annotations

import csv
import re

MISSING = frozenset({"", "nan", "na", "n/a", "null", "none", "-", "inf", "+inf", "-inf", "infinity", "-infinity"})
"""What stands in a cell without a reading, in small letters."""
_BINARY = re.compile("[\x00-\x08\x0e-\x1a]")


def utf8_or_latin1(raw: bytes) -> tuple[str, str]:
    """Bytes as text, and the name of the encoding: only comments and names can tell the two."""
    try:
        return raw.decode(), "UTF-8"
    except UnicodeDecodeError:
        return raw.decode("latin-1"), "Latin-1"


def no_text(text: str, before: int = 0) -> str:
    """Which line, behind ``before`` others, holds a byte that no text holds, in words; empty where none does."""
    binary = _BINARY.search(text)
    if not binary:
        return ""
    line = before + text.count("\n", 0, binary.start()) + 1
    return f"line {line} holds the byte {ord(binary[0])}, so this is no text file"


def cells_of(line: str, separator: str) -> list[str]:
    """The cells of a line; the csv module is asked only where there are quotes for it to undo."""
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error:
        return [line]
