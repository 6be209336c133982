"""The arrays of a study's chunks, one .npz a chunk, read with every promise about them checked."""

from __future__ import annotations

import zipfile
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.errors import UserError
from twin.regular_file import opened

Arrays = dict[str, np.ndarray[Any, Any]]


def joined(files: Sequence[Path], required: Collection[str]) -> Arrays:
    """The arrays of all files, one after the other along their first axis, those with these names among them.

    Raises UserError.
    """
    parts: list[Arrays] = []
    for file in files:
        part = _arrays(file)
        if not part.keys() >= set(required) or not _alike(part, parts[0] if parts else part):
            raise UserError(f"{file}: does not hold the arrays of a chunk; delete it and run the same command again")
        parts.append(part)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _alike(part: Arrays, first: Arrays) -> bool:
    """Whether the arrays of a chunk have equally many rows, and those of the first chunk's shape and kind."""
    if part.keys() != first.keys() or not all(values.ndim for values in part.values()):
        return False
    shapes = all(part[name].shape[1:] == first[name].shape[1:] for name in part)
    return shapes and len({len(values) for values in part.values()}) == 1


def _arrays(file: Path) -> Arrays:
    try:
        with open(opened(file), "rb") as raw:
            # Without this a chunk of zeros could claim to be as long as it likes.
            with zipfile.ZipFile(raw) as archive:
                if sum(item.file_size for item in archive.infolist()) > LARGEST_SWEEP_BYTES:
                    raise UserError(f"{file}: holds more than {LARGEST_SWEEP_BYTES / 1e6:g} MB; move it away")
            raw.seek(0)
            with np.load(raw, allow_pickle=False) as content:
                return {name: content[name] for name in content.files}
    except UserError:
        raise
    # numpy and zipfile raise what their parsers raise.
    except (Exception, MemoryError) as error:
        raise UserError(
            f"{file}: cannot be read ({type(error).__name__}); run the same command again to compute it anew"
        ) from None
