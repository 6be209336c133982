"""What may be handed in: a sweep as a file, a Sweep, or columns by name, checked as those of a file are; a seed."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from decimal import Decimal
from numbers import Real
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

if TYPE_CHECKING:
    from twin.angles import Array
    from twin.chain import Chain
    from twin.effect import Effect
    from twin.spin import Spin
    from twin.sweep import Sweep

_MISSING = frozenset({"NoneType", "NAType", "NaTType"})
"""Types of a cell that holds no reading: None, and what pandas puts there."""


class Columns(Protocol):
    """Columns by name: a dict of arrays, a pandas DataFrame, an xarray Dataset, an opened .npz file."""

    def keys(self) -> Iterable[Any]:
        """The names."""
        ...

    def __getitem__(self, name: Any, /) -> Any:
        """The column of this name: one number a reading."""
        ...


SweepLike: TypeAlias = "str | os.PathLike[str] | Sweep | Columns"
"""What :func:`diagnosis.explain` and :func:`diagnosis.diagnose` take as a sweep."""
TwinLike: TypeAlias = "str | os.PathLike[str] | Chain"
"""What they take as a twin: a twin file, a preset's name, or a chain."""


def as_sweeps(
    sources: Sequence[SweepLike | Spin],
    *,
    pole_pairs: int | None = None,
    columns: str | None = None,
    begins: Callable[[str], object] = lambda stage: None,
) -> list[Sweep]:
    """Several sweeps, see :func:`as_sweep`; files that share a name bear as much of their paths as tells them apart.

    A log without a reference is one with the motion that is estimated from its readings
    (:func:`diagnosis.spin.of_log.with_motion`), of which ``begins`` hears before.
    """
    from dataclasses import replace

    from diagnosis.spin.of_log import with_motion
    from twin.shown_name import distinct_names

    read = [_recording(source, pole_pairs, spin=True, columns=columns) for source in sources]
    sweeps = with_motion(read, begins=begins)
    files = [place for place, source in enumerate(sources) if isinstance(source, str | os.PathLike)]
    names = distinct_names([os.fspath(sources[place]) for place in files])  # type: ignore[arg-type]
    for place, name in zip(files, names, strict=True):
        sweeps[place] = replace(sweeps[place], name=name)
    return sweeps


def as_sweep(source: SweepLike, *, pole_pairs: int | None = None, columns: str | None = None) -> Sweep:
    """The sweep that is meant.

    Parameters
    ----------
    source : str, os.PathLike, Sweep, or columns by name
        A file (CSV, ``.csv.gz``, Parquet); a :class:`twin.Sweep`, taken as it is; or anything that has ``keys()`` and
        gives a column for each: a dict of arrays, a pandas DataFrame (levels of its index count as columns where
        they bear the name of one), an xarray Dataset (coordinates count as columns). Names and units are those of
        the file format; other columns are ignored. A missing cell is NaN, None or what pandas puts there.
    pole_pairs : int, optional
        How often the field at the sensor turns in a turn of the shaft, where an angle or the channels do so too.
    columns : str, optional
        Which columns of a file are those of a sweep, as ``--columns`` says it.

    Returns
    -------
    twin.Sweep
        Its checked columns; rows with missing cells are rejected, and listed in ``rejected`` by their number.

    Raises
    ------
    twin.SweepError
        A ``ValueError``: where it cannot be used as a sweep. The message says in one line which column and row,
        what was found, what was expected and what to do.
    """
    from twin.sweep import Sweep

    found = _recording(source, pole_pairs, spin=False, columns=columns)
    assert isinstance(found, Sweep)
    return found


def _recording(source: SweepLike | Spin, pole_pairs: int | None, *, spin: bool, columns: str | None) -> Sweep | Spin:
    """The sweep that is meant, or where ``spin`` is allowed and there is no reference, the spin. Raises SweepError."""
    from twin.errors import SweepError
    from twin.recording_file import read_recording
    from twin.spin import Spin
    from twin.sweep import Sweep
    from twin.sweep_columns import COLUMNS, REQUIRED, is_spin, lacking

    if isinstance(source, str | os.PathLike):
        read = read_recording if spin else Sweep.read
        return read(os.fspath(source), pole_pairs=pole_pairs, columns=columns)
    if columns is not None:
        raise SweepError(
            f"columns says how a file is read, and the sweep is of the type {type(source).__name__}; leave it out"
        )
    if isinstance(source, Sweep):
        return _of_the_shaft(source, pole_pairs)
    if spin and isinstance(source, Spin):
        return source
    name = type(source).__name__
    if not (hasattr(source, "keys") and hasattr(source, "__getitem__")):
        raise SweepError(
            f"found an object of the type {name} where a sweep is expected; give a path, a Sweep, or columns by name "
            "(dict of arrays, pandas DataFrame, xarray Dataset)"
        )
    table = _with_index(source, COLUMNS)
    names = _names(table)
    known = set(map(str, names))
    if missing := lacking(known, spin=spin):
        found = ", ".join(map(str, names)) or "no column"
        raise SweepError(f"{name}: {missing}; found {found}; rename the column or add it")
    spin = spin and is_spin(known)
    data = _columns(table, [key for key in COLUMNS if key in names], name=name)
    first = next(key for key in data if key in (*REQUIRED, "vx"))
    rows = data[first].size
    for key, values in data.items():
        if values.size != rows:
            raise SweepError(
                f"{name}: column {key} holds {values.size} values and {first} {rows}; "
                "expected one for each reading, NaN where there is none"
            )
    if spin:
        return Spin.from_columns(data, name=name, pole_pairs=pole_pairs)
    return Sweep.from_columns(data, name=name, pole_pairs=pole_pairs)


def _of_the_shaft(sweep: Sweep, pole_pairs: int | None) -> Sweep:
    """A sweep with the angles of the shaft, see :func:`twin.periods.of_the_shaft`."""
    from dataclasses import replace

    from twin.periods import checked_pole_pairs, of_the_shaft

    periods = checked_pole_pairs(pole_pairs)
    if periods is None:
        return sweep
    return replace(sweep, **{"vx": None, "vy": None, **of_the_shaft(sweep.columns, periods, name=sweep.name)})


def _columns(table: Any, names: Sequence[str], *, name: str) -> dict[str, Array]:
    """The columns of a sweep (n,) that a table holds. Raises SweepError where a cell is no number."""
    from twin.errors import SweepError
    from twin.sweep_columns import TOLD_BY_SENSOR

    columns: dict[str, Array] = {}
    for key in names:
        try:
            columns[key] = _values(table[key], f"{name}: column {key}")
        except SweepError:
            # As in a file: a status in words tells of a reading, and is none.
            if key not in TOLD_BY_SENSOR:
                raise
    return columns


def as_twin(twin: TwinLike | None, *, effects: tuple[Effect, ...] | None = None) -> Chain | None:
    """The twin that is meant, with these effects, None: the catalogue's. Raises UserError where it is none."""
    from dataclasses import replace

    from twin.catalogue import CATALOGUE
    from twin.chain import Chain
    from twin.errors import UserError
    from twin.presets import read_twin_or_preset

    if twin is None:
        return None
    if isinstance(twin, Chain):
        chain = twin if effects is None else replace(twin, effects=effects)
        return chain if chain.magnet is None else chain.with_magnet(chain.magnet)
    if not isinstance(twin, str | os.PathLike):
        raise UserError(
            f"twin is of the type {type(twin).__name__}; expected the path of a twin file, a preset's name, or a Chain"
        )
    return read_twin_or_preset(os.fspath(twin), effects=CATALOGUE if effects is None else effects)


def checked_seed(seed: int) -> int:
    """The seed of a call of the interface. Raises UserError where it is none."""
    from twin.errors import UserError
    from twin.shown import shown

    if isinstance(seed, bool) or not hasattr(seed, "__index__") or seed.__index__() < 0:
        raise UserError(f"seed is {shown(seed)}; expected a whole number, 0 or more")
    return seed.__index__()


def _with_index(source: Any, known: Iterable[str]) -> Any:
    """A DataFrame with the levels of its index as columns where one bears the name of a column; others unchanged."""
    levels = getattr(getattr(source, "index", None), "names", ())
    return source.reset_index() if any(level in known for level in levels) else source


def _names(source: Any) -> list[Any]:
    """The names of the columns, those of a Dataset's coordinates included."""
    return list(dict.fromkeys([*source.keys(), *getattr(source, "coords", ())]))


def _values(column: Any, where: str) -> Array:
    """A column's numbers (n,), NaN where there is none. Raises SweepError for what is no number."""
    import numpy as np

    from twin.errors import SweepError

    # A list is taken cell by cell: as an array, one text among its numbers would make all of them text.
    cells = np.asarray(column, dtype=object if isinstance(column, list | tuple) else None)
    if isinstance(column, np.ma.MaskedArray):
        cells = cells.astype(object)
        cells[np.ma.getmaskarray(column)] = None
    if cells.ndim != 1:
        raise SweepError(f"{where} has the shape {cells.shape}; expected one number for each reading, in one dimension")
    if cells.dtype.kind in "iuf":
        return cells.astype(np.float64)
    if cells.dtype.kind in "mM":
        raise SweepError(f"{where} holds times of the type {cells.dtype}; expected plain numbers: convert to seconds")
    return np.array([_cell(cell, row, where) for row, cell in enumerate(cells.tolist(), 1)], dtype=np.float64)


def _cell(cell: Any, row: int, where: str) -> float:
    """The number of one cell."""
    from twin.errors import SweepError
    from twin.shown import shown

    if type(cell).__name__ in _MISSING:
        return float("nan")
    if isinstance(cell, Real | Decimal) and not isinstance(cell, bool):
        # A whole number may be larger than all floating-point numbers, a decimal may be a signalling NaN.
        with suppress(OverflowError, ValueError):
            return float(cell)
    raise SweepError(
        f"{where}, row {row}: found {shown(cell, 40)} ({type(cell).__name__}); "
        "expected a number, or NaN where a reading is missing: convert the column"
    )
