"""Files that are dropped on the page: kept under a name of ours in a folder of ours, called by the name they came with.

The name from outside is shown and written into answers; it is never a path.
"""

from __future__ import annotations

import secrets
import shutil
from pathlib import Path

from scenarios.lab.server import Upload
from twin.ending import ending_of
from twin.errors import UserError
from twin.shown import shown

_LONGEST_NAME = 150
_BLOCK_BYTES = 1 << 20


def kept(
    upload: Upload, folder: Path, *, stem: str, endings: tuple[str, ...], most: int | None = None
) -> tuple[Path, str]:
    """Where the file lies, and what it is called. Raises UserError for a name or size that no such file has."""
    name = plain_name(upload.name)
    ending = ending_of(name)
    if ending not in endings:
        raise UserError(f"{name}: expected a file ending in {' or '.join(endings)}; drop one that does")
    if most is not None and upload.size > most:
        raise UserError(f"{name}: holds more than {most / 1e6:g} MB; expected a smaller file")
    for before in folder.glob(f"{stem}-*"):
        before.unlink(missing_ok=True)
    # No name of a user's holds this one, so that messages can be told which file is meant: see as_called.
    path, left = folder / f"{stem}-{secrets.token_hex(8)}{ending}", upload.size
    with path.open("wb") as out:
        while left:
            block = upload.stream.read(min(left, _BLOCK_BYTES))
            if not block:
                raise UserError(f"{name}: came only in part; drop it again")
            out.write(block)
            left -= len(block)
    return path, name


def plain_name(given: str) -> str:
    """The name of a dropped file. Raises UserError for what is none: a path, a control character, too long a name."""
    if not given or len(given) > _LONGEST_NAME or not given.isprintable() or set(given) & set('/\\:*?"<>|'):
        raise UserError(f"{shown(given[:_LONGEST_NAME])}: is no name of a file; expected up to 150 plain letters")
    if given.startswith((".", "-")):
        raise UserError(f"{shown(given)}: begins with '{given[0]}'; rename the file and drop it again")
    return given


def as_called(error: UserError, path: Path, name: str) -> UserError:
    """The error of reading a dropped file, with the name that the file came with."""
    return UserError(str(error).replace(str(path), name).replace(path.name, name))


def emptied(folder: Path) -> Path:
    """The folder, anew."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return folder
