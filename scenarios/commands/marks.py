"""The mark by which the program knows a file that it wrote and that nobody has changed since.

A mark is one sentence with the SHA-256 of all that the file holds besides: a comment in TOML, CFG, C, CSS, HTML, SVG
and PDF, the entry ``written_by`` in JSON, a text chunk in PNG. CSV and Parquet stay plain, because many programs read
them that know no comments: their mark is an extended attribute of the file, where the system has those. A file that
was edited, or that someone else wrote in the same format, bears no mark that fits: it is the user's.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import struct
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from twin.ending import ending_of

_SAID = b"written by halltwin; SHA-256 of all else: "
_DIGEST = re.compile(re.escape(_SAID) + b"([0-9a-f]{64})")
_REACH = 512
"""Bytes at the beginning or the end of a file in which its mark lies."""
_BLOCK = 1 << 20
_PLAIN = (".csv", ".csv.gz", ".parquet")
_ATTRIBUTE = "user.halltwin.sha256"


@dataclass(frozen=True)
class _Form:
    """How a format carries a sentence: the bytes around it, and what follows it; None where it comes first."""

    entry: Callable[[bytes], bytes]
    closing: bytes | None = None


def _png_text(said: bytes) -> bytes:
    """A text chunk of PNG."""
    body = b"tEXtComment\0" + said
    return struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))


_HASH = _Form(lambda said: b"# " + said + b"\n")
_C = _Form(lambda said: b"/* " + said + b" */\n")
_XML = _Form(lambda said: b"<!-- " + said + b" -->\n", closing=b"")
_FORMS = {
    ".toml": _HASH,
    ".cfg": _HASH,
    ".h": _C,
    ".hh": _C,
    ".hpp": _C,
    ".css": _C,
    ".html": _XML,
    ".htm": _XML,
    ".svg": _XML,
    ".pdf": _Form(lambda said: b"% " + said + b"\n", closing=b""),
    ".json": _Form(lambda said: b',\n "written_by": "' + said + b'"', closing=b"\n}\n"),
    ".png": _Form(_png_text, closing=struct.pack(">I", 0) + b"IEND" + struct.pack(">I", zlib.crc32(b"IEND"))),
}


def marked(path: Path, content: bytes) -> bytes:
    """The content with its mark, in the format that the path's ending says; CSV as it is."""
    if _is_plain(path):
        return content
    form = _FORMS[ending_of(path)]
    mark = form.entry(_SAID + hashlib.sha256(content).hexdigest().encode())
    if form.closing is None:
        return mark + content
    if not content.endswith(form.closing):
        raise ValueError(f"content for {path.name} does not end with {form.closing!r}")
    return content[: len(content) - len(form.closing)] + mark + form.closing


def mark_written(path: Path, content: bytes) -> None:
    """Mark a file that holds this content, where its format bears no mark and the system has extended attributes."""
    if _is_plain(path) and hasattr(os, "setxattr"):
        # Not every disk keeps them: without a mark the file counts as the user's.
        with contextlib.suppress(OSError):
            os.setxattr(path, _ATTRIBUTE, hashlib.sha256(content).hexdigest().encode())


def is_own(path: Path) -> bool:
    """Whether a file bears a mark that fits its content. Raises OSError."""
    if _is_plain(path):
        return _attribute_fits(path)
    form = _FORMS.get(ending_of(path))
    if form is None:
        return False
    with path.open("rb") as file:
        return _fits(file, form)


def _is_plain(path: Path) -> bool:
    """Whether files with this ending hold nothing but what their readers ask for."""
    return ending_of(path) in _PLAIN


def _attribute_fits(path: Path) -> bool:
    """Whether a file has the attribute that its content had when it was written."""
    if not hasattr(os, "getxattr"):
        return False
    try:
        said = os.getxattr(path, _ATTRIBUTE)
    except OSError:
        return False
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest().encode() == said


def _fits(file: BinaryIO, form: _Form) -> bool:
    """Whether the mark stands where it belongs, and all else gives its digest; read block by block."""
    if form.closing is None:
        found = _DIGEST.search(file.read(_REACH))
        start = 0
    else:
        size = file.seek(0, 2)
        file.seek(max(0, size - _REACH))
        found = _DIGEST.search(file.read())
        start = size - len(form.closing)
    if found is None:
        return False
    mark = form.entry(found[0])
    if form.closing is not None:
        start -= len(mark)
    digest = hashlib.sha256()
    file.seek(0)
    for size in _blocks(start):
        digest.update(file.read(size))
    if start < 0 or file.read(len(mark)) != mark:
        return False
    while block := file.read(_BLOCK):
        digest.update(block)
    return digest.hexdigest().encode() == found[1]


def _blocks(size: int) -> list[int]:
    whole, rest = divmod(max(size, 0), _BLOCK)
    return [_BLOCK] * whole + [rest]
