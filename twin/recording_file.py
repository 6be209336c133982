"""Reading a recording: a sweep, or where the file holds no reference a spin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from twin.angles import Array
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.log import LOG
from twin.shown_name import shown_name
from twin.spin import Spin
from twin.sweep import Sweep
from twin.sweep_columns import is_spin
from twin.sweep_reader import read_sweep


def read_recording(
    path: str | Path,
    *,
    max_bytes: int = LARGEST_SWEEP_BYTES,
    name: str | None = None,
    columns: str | None = None,
    pole_pairs: int | None = None,
    guess: bool = False,
) -> Sweep | Spin:
    """Read a file as :meth:`twin.Sweep.read` does; one without ``reference_deg`` is a :class:`~twin.spin.Spin`.

    Raises
    ------
    SweepError
        Where the file cannot be read or used.
    """
    called = name or shown_name(path)

    def checked(found: Mapping[str, Array]) -> Sweep | Spin:
        return recording_of(found, name=called, pole_pairs=pole_pairs)

    found, read_as = read_sweep(Path(path), checked, columns=columns, max_bytes=max_bytes, spin=True, guess=guess)
    used = ", ".join(found.columns)
    LOG.info("read %s: %d rows, %d rejected; %s", found.name, found.rows, len(found.rejected), used)
    return replace(found, read_as=read_as)


def recording_of(columns: Mapping[str, Array], *, name: str, pole_pairs: int | None = None) -> Sweep | Spin:
    """Columns by name, (n,) each, as a sweep, or as a spin where none of them is a reference. Raises SweepError."""
    kind = Spin if is_spin(columns) else Sweep
    return kind.from_columns(columns, name=name, pole_pairs=pole_pairs)
