"""Sweep files as people name them: single files, globs, folders."""

from __future__ import annotations

import glob
from collections.abc import Sequence
from pathlib import Path

from twin.errors import UserError

ENDINGS = (".csv", ".csv.gz", ".parquet")


def sweep_paths(names: Sequence[str]) -> list[Path]:
    """The files that names stand for, in the order given; those of a folder or glob by name.

    Raises UserError for a name that stands for nothing.
    """
    found: list[Path] = []
    for name in names:
        path = Path(name)
        if path.is_dir():
            inside = sorted(item for item in path.iterdir() if item.name.endswith(ENDINGS))
            if not inside:
                raise UserError(f"{name}: no sweep in this folder; expected files ending in {', '.join(ENDINGS)}")
            found += inside
        elif path.exists():
            found.append(path)
        else:
            matched = sorted(Path(item) for item in glob.glob(name, recursive=True))
            if not matched:
                raise UserError(f"{name}: no such file, folder or pattern with a match")
            found += matched
    return found
