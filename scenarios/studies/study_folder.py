"""The folder of a study: what it is of, which chunks are done, and small results as one .npz a chunk.

``study.json`` names the study, the version of the program, the seed and all settings; a run with others is refused.
``done/000012`` marks chunk 12 as complete. ``chunks/000012.npz`` holds its arrays where a study keeps them so.
"""

from __future__ import annotations

import io
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import UserError
from twin.whole_file import write_beside

_IDENTITY = "study.json"


def version() -> str:
    """The version of the program that results are made by."""
    try:
        return metadata.version("halltwin")
    except metadata.PackageNotFoundError:
        return "source tree"


@dataclass(frozen=True)
class StudyFolder:
    """See the module's text. ``path`` is absolute, so that workers elsewhere on a shared file system find it."""

    path: Path

    @classmethod
    def open(cls, path: Path, *, study: str, seed: int, settings: Mapping[str, Any]) -> StudyFolder:
        """Begin a study in this folder, or go on with it. Raises UserError where it holds another one."""
        folder = cls(path.absolute())
        identity = {"study": study, "version": version(), "seed": seed, "settings": settings}
        text = json.dumps(identity, indent=1, sort_keys=True, allow_nan=False) + "\n"
        record = folder.path / _IDENTITY
        if record.exists():
            folder._refuse_other(json.loads(text))
            folder._clear_unfinished()
            return folder
        if folder.path.exists() and (not folder.path.is_dir() or any(folder.path.iterdir())):
            raise UserError(f"{path}: exists and is no study; give the name of a new folder")
        try:
            (folder.path / "done").mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UserError(f"{path}: cannot be made ({error.strerror}); give another path") from None
        write_beside(record, text.encode())
        return folder

    def _refuse_other(self, asked: Mapping[str, Any]) -> None:
        try:
            found = json.loads((self.path / _IDENTITY).read_text(encoding="utf-8"))
            flat_found, flat_asked = _flat(found), _flat(asked)
        except (OSError, ValueError, AttributeError):
            raise UserError(f"{self.path}: {_IDENTITY} cannot be read; give another folder") from None
        for name in sorted(flat_found.keys() | flat_asked.keys(), key=lambda key: (key.count("."), key)):
            if flat_found.get(name) != flat_asked.get(name):
                there, here = (_short(flat.get(name)) for flat in (flat_found, flat_asked))
                raise UserError(
                    f"{self.path}: was begun with {name} {there}, this run has {here}; give another folder, "
                    "or the same settings to go on"
                )

    def _clear_unfinished(self) -> None:
        """Take away what a killed run left beside its files: zarr's and our own temporary names."""
        for pattern in ("*.partial", ".*.part"):
            for left in self.path.rglob(pattern):
                left.unlink(missing_ok=True)

    # ---- chunks ---------------------------------------------------------------------------------------------------

    def is_done(self, chunk: int) -> bool:
        """Whether the chunk is complete."""
        return self._mark(chunk).exists()

    def mark(self, chunk: int) -> None:
        """Say that the chunk is complete."""
        self._mark(chunk).touch()

    def _mark(self, chunk: int) -> Path:
        return self.path / "done" / f"{chunk:06d}"

    def save(self, chunk: int, arrays: Mapping[str, np.ndarray[Any, Any]]) -> None:
        """Write a chunk's arrays as .npz, whole or not at all. Raises OSError."""
        out = io.BytesIO()
        np.savez(out, allow_pickle=False, **arrays)
        target = self.path / "chunks" / f"{chunk:06d}.npz"
        target.parent.mkdir(exist_ok=True)
        beside = target.with_name(f".{target.name}.{os.getpid()}.part")
        try:
            beside.write_bytes(out.getvalue())
            os.replace(beside, target)
        finally:
            beside.unlink(missing_ok=True)

    def load(self, chunks: int) -> dict[str, np.ndarray[Any, Any]]:
        """The arrays of all chunks, one after the other along their first axis."""
        parts = []
        for chunk in range(chunks):
            with np.load(self.path / "chunks" / f"{chunk:06d}.npz", allow_pickle=False) as content:
                parts.append({name: content[name] for name in content.files})
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _flat(content: Mapping[str, Any]) -> dict[str, Any]:
    """Nested settings by dotted name; the settings themselves without their own prefix."""
    out: dict[str, Any] = {}
    for key, value in content.items():
        if isinstance(value, Mapping):
            prefix = "" if key == "settings" else f"{key}."
            out.update({f"{prefix}{name}": inner for name, inner in _flat(value).items()})
        else:
            out[key] = value
    return out


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
