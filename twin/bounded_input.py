"""Input of unknown size: a file, pipe or device, plain or gzip, read in blocks up to a limit after decompression."""

from __future__ import annotations

import gzip
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import UserError
from twin.shown import shown

LARGEST_SWEEP_BYTES = 2_000_000_000
"""Most bytes of a sweep, decompressed: ten million readings in nine columns take 1.1 GB as text."""
LARGEST_TEXT_BYTES = 20_000_000
"""Most bytes of a twin file or an answer: a twin of a thousand turns takes 0.1 MB, the longest answer seen 0.5 MB."""
BLOCK_BYTES = 1 << 20
_GZIP = b"\x1f\x8b"
_UNITS = {"": 1, "B": 1, "KB": 1_000, "MB": 1_000_000, "GB": 1_000_000_000}


def bytes_of(size: str | float) -> int:
    """A size as people write it, in bytes: ``500MB``, ``2 GB``, ``1e9``. Raises UserError."""
    found = re.fullmatch(r"\s*([0-9.]+(?:[eE][0-9]+)?)\s*([kKmMgG]?[bB]?)\s*", str(size))
    try:
        count = float(found[1]) * _UNITS[found[2].upper()] if found else -1.0
    except (KeyError, ValueError):
        count = -1.0
    if not 1.0 <= count <= 1e15:
        raise UserError(f"max-size is {shown(size)}; expected a size from 1 to 1e15 bytes, such as 500MB or 2GB")
    return int(count)


def checked_bytes(most: Any) -> int:
    """Most bytes of a sweep as a call from Python gives it. Raises UserError for what is no whole number from 1."""
    number = isinstance(most, int | float | np.integer) and not isinstance(most, bool)
    if not number or not 1 <= most <= 1e15 or most != int(most):
        raise UserError(f"max_bytes is {shown(most)}; expected a whole number of bytes from 1 to 1e15")
    return int(most)


def blocks(path: Path, *, most: int, expected: str, raised_by: str = "") -> Iterator[bytes]:
    """The bytes of an input in blocks, decompressed where they are gzip by their first two bytes, whatever the name.

    Parameters
    ----------
    path : Path
        A file, pipe or device.
    most : int
        Bytes after decompression beyond which the input is refused.
    expected : str
        What a message says is expected, e.g. "a twin TOML".
    raised_by : str, optional
        Which options raise ``most``, for the message.

    Raises
    ------
    UserError
        Where it cannot be read, is damaged, or is longer than ``most``.
    """
    read = 0
    try:
        with path.open("rb") as raw:
            stream = gzip.GzipFile(fileobj=raw) if raw.peek(2)[:2] == _GZIP else raw
            while block := stream.read(min(BLOCK_BYTES, most + 1 - read)):
                read += len(block)
                if read > most:
                    raise UserError(
                        f"{path.name}: holds more than {most / 1e6:g} MB"
                        f"{'' if stream is raw else ' after decompression'}; expected {expected}"
                        f"{f'; {raised_by} raises the limit' if raised_by else ''}"
                    )
                yield block
    except FileNotFoundError:
        raise UserError(f"{path}: no such file; give the path of {expected}") from None
    except IsADirectoryError:
        raise UserError(f"{path}: is a folder; give the path of {expected}") from None
    except (OSError, EOFError, zlib.error) as error:
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"{path.name}: cannot be read ({reason}); expected {expected}, plain or gzip") from None
    except ValueError as error:
        # A zero byte in a name: no file can bear it.
        if isinstance(error, UserError):
            raise
        raise UserError(f"{shown(str(path))}: is no name of a file ({error}); give the path of {expected}") from None


def whole(path: Path, *, most: int = LARGEST_TEXT_BYTES, expected: str) -> bytes:
    """All bytes of an input at once: see :func:`blocks`."""
    return b"".join(blocks(path, most=most, expected=expected))
