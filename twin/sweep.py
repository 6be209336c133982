"""Sweep: what the bench records, and the checks that make it usable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from twin.angles import Array, IntArray, radians
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.errors import ColumnMissing
from twin.estimated_motion import EstimatedMotion
from twin.log import LOG
from twin.motion import RPM, Motion
from twin.periods import checked_pole_pairs, of_the_shaft
from twin.reading_grid import step_of_grid_deg
from twin.recordings import Recordings
from twin.shown_name import shown_name
from twin.sweep_checks import (
    as_recorded,
    check_both_channels,
    check_channels,
    check_follows,
    check_usable,
    rows_in_use,
)
from twin.sweep_columns import COLUMNS, REQUIRED, lacking
from twin.sweep_file import write_columns
from twin.sweep_reader import read_sweep

if TYPE_CHECKING:
    from twin.logs.guess import Guess


@dataclass(frozen=True, eq=False)
class Sweep:
    """The used rows of a recording, all columns of shape (n,), in the order in which they were taken.

    Made by :meth:`read`, :meth:`from_columns` or a simulation (:meth:`twin.Chain.simulate`); the constructor itself
    checks nothing.

    Attributes
    ----------
    reference_deg, measured_deg : ndarray
        What the reference and the sensor read [deg], (n,); any range, wrapped or not.
    time_s, direction, speed_rpm, turn, temperature_c, air_gap_mm, mounting_deg, vx, vy, current_a : ndarray or None
        Further columns (n,), None where not recorded: time [s], +1 or -1, speed, number of the turn or sweep,
        temperature [C] (NaN where missing), air gap [mm], by how much the sensor is turned about the shaft [deg], the
        two channels in any unit, and the motor's current [A] (NaN where missing).
    magnitude, agc, status, frame : ndarray or None
        What the sensor says of itself (n,), NaN where missing: the field's magnitude and the gain that makes up for
        it, in any unit, a status word, and a counter of frames.
    rejected : mapping of int to str
        Numbers of the rows that cannot be used (first reading = 1), and why.
    name : str
        Of the file, or of the kind of thing the columns came from.
    row_numbers : ndarray or None
        Numbers (n,) of the used rows; None: they follow one another.
    set_aside : int
        Usable rows of the recording that this part of it does not hold.
    recordings : Recordings or None
        Of several recordings of one device, joined: which one each row belongs to. None: all are of one.
    senses : tuple of int or None
        Who counts which way, (s, h) of :class:`twin.Chain`, where channels said it that were not kept.
    estimated : EstimatedMotion or None
        Where no reference was recorded: ``reference_deg`` is the motion that was estimated from the readings, and this
        how freely the shaft may have moved beside it.
    read_as : Guess or None
        Of a log under names of its own: the statement by which its columns were read, see :mod:`twin.logs.statement`.
    """

    reference_deg: Array
    measured_deg: Array
    time_s: Array | None = None
    direction: Array | None = None
    speed_rpm: Array | None = None
    turn: Array | None = None
    temperature_c: Array | None = None
    air_gap_mm: Array | None = None
    mounting_deg: Array | None = None
    vx: Array | None = None
    vy: Array | None = None
    current_a: Array | None = None
    magnitude: Array | None = None
    agc: Array | None = None
    status: Array | None = None
    frame: Array | None = None
    rejected: Mapping[int, str] = field(default_factory=dict)
    name: str = "sweep"
    row_numbers: IntArray | None = None
    set_aside: int = 0
    recordings: Recordings | None = None
    senses: tuple[int, int] | None = None
    estimated: EstimatedMotion | None = None
    read_as: Guess | None = None

    def __repr__(self) -> str:
        left = "" if self.rows == len(self) else f" of {self.rows}"
        return f"Sweep({self.name!r}, {len(self)}{left} readings, columns {', '.join(self.columns)})"

    def __len__(self) -> int:
        return int(self.reference_deg.size)

    @property
    def rows(self) -> int:
        """Rows recorded, the rejected ones included."""
        return len(self) + len(self.rejected) + self.set_aside

    @property
    def numbers(self) -> IntArray:
        """Number (n,) of each row in the recording, the first being 1."""
        return np.arange(1, len(self) + 1) if self.row_numbers is None else self.row_numbers

    def part(self, rows: IntArray) -> Self:
        """The recording with some of its used rows alone.

        Parameters
        ----------
        rows : ndarray
            Places (m,) of the rows among the used ones, from 0.

        Returns
        -------
        Sweep
            These rows under their own numbers; the others are counted in ``set_aside``.
        """
        columns: dict[str, Any] = {name: values[rows] for name, values in self.columns.items()}
        aside = self.set_aside + len(self) - rows.size
        recordings = None if self.recordings is None else self.recordings.part(rows)
        estimated = None if self.estimated is None else self.estimated.part(rows)
        return replace(
            self,
            **columns,
            row_numbers=self.numbers[rows],
            set_aside=aside,
            recordings=recordings,
            estimated=estimated,
        )

    @property
    def columns(self) -> dict[str, Array]:
        """The recorded columns by name, in the order of the file format."""
        found = {name: getattr(self, name) for name in COLUMNS}
        return {name: values for name, values in found.items() if values is not None}

    @property
    def reading_grid_deg(self) -> float | None:
        """Step [deg] of the readings where they were chosen, as the index of a table is, and not what came out.

        A firmware's table has an entry for each of 64 even readings; they lie on a grid because the table does, and say
        nothing of how finely the sensor resolves. None: the readings are those that came out.
        See :func:`twin.reading_grid.step_of_grid_deg`.
        """
        return step_of_grid_deg(self.measured_deg, self.reference_deg)

    @classmethod
    def from_columns(cls, columns: Mapping[str, Array], *, name: str = "sweep", pole_pairs: int | None = None) -> Self:
        """Check the columns and leave out rows with missing cells.

        Parameters
        ----------
        columns : mapping of str to ndarray
            Columns of the file format by name, (n,) each, in the units of their names; NaN where a cell is missing.
            Others are ignored.
        name : str, optional
            What messages call it.
        pole_pairs : int, optional
            How often the field at the sensor turns in a turn of the shaft, where an angle or the channels do so too:
            see :mod:`twin.periods`.

        Returns
        -------
        Sweep
            The rows that can be used; the others stand in ``rejected``.

        Raises
        ------
        SweepError
            Where they cannot be used as a sweep.

        Examples
        --------
        >>> import numpy as np
        >>> from twin import Sweep
        >>> angle_deg = np.arange(0.0, 360.0, 10.0)
        >>> Sweep.from_columns({"reference_deg": angle_deg, "measured_deg": angle_deg + 30.0})
        Sweep('sweep', 36 readings, columns reference_deg, measured_deg)
        """
        if missing := lacking(columns):
            found = ", ".join(columns) or "none"
            raise ColumnMissing(f"{name}: {missing}; found {found}; rename the column or add it")
        data = as_recorded(columns, name=name, required=REQUIRED)
        check_both_channels(data, name=name)
        keep, rejected = rows_in_use(data)
        whole = bool(keep.all())
        used: dict[str, Any] = {
            key: np.ascontiguousarray(values if whole else values[keep]) for key, values in data.items()
        }
        check_usable(used, name=name, rejected=len(rejected))
        if (periods := checked_pole_pairs(pole_pairs)) is not None:
            used = of_the_shaft(used, periods, name=name)
        following_deg = check_follows(used["measured_deg"], used["reference_deg"], name=name)
        if "vx" in used:
            check_channels(used["vx"], used["vy"], following_deg, name=name)
        return cls(**used, rejected=rejected, name=name, row_numbers=None if whole else np.flatnonzero(keep) + 1)

    @classmethod
    def from_motion(cls, motion: Motion, *, reference_deg: Array, measured_deg: Array, channels: Array | None) -> Self:
        """The sweep of a simulation: the columns that ``motion`` says were recorded."""
        has = motion.columns
        return cls(
            reference_deg=reference_deg,
            measured_deg=measured_deg,
            time_s=motion.time_s if "time_s" in has else None,
            direction=motion.direction if "direction" in has else None,
            speed_rpm=np.degrees(motion.speed_rad_s) / 6.0 if "speed_rpm" in has else None,
            turn=motion.turn.astype(np.float64) if "turn" in has else None,
            temperature_c=motion.temperature_c if "temperature_c" in has else None,
            current_a=motion.current_a if "current_a" in has else None,
            vx=None if channels is None else channels[0],
            vy=None if channels is None else channels[1],
            name="simulated",
        )

    @classmethod
    def read(
        cls,
        path: str | Path,
        *,
        max_bytes: int = LARGEST_SWEEP_BYTES,
        name: str | None = None,
        columns: str | None = None,
        pole_pairs: int | None = None,
        guess: bool = False,
    ) -> Self:
        """Read a sweep file and check it.

        Parameters
        ----------
        path : str or Path
            CSV, plain or gzip, or Parquet where pyarrow is installed; its content says which. With ``columns`` a log
            of any dialect, a file of another program or a firmware's table, as ``halltwin import`` reads them.
        max_bytes, name : int and str, optional
            Most bytes of the file after decompression; what messages call it, if not by the file's name.
        columns : str, optional
            Which columns of a log are those of a sweep, in which unit, such as
            ``"reference_deg=enc_counts*360/40000, measured_deg=angle:rad"``; None: it has those of a sweep.
        pole_pairs : int, optional
            See :meth:`from_columns`.
        guess : bool, optional
            Read a log under names of its own by the one statement that fits it, which ``read_as`` then holds; False:
            such a log is refused with the statement as advice.

        Returns
        -------
        Sweep
            The rows that can be used.

        Raises
        ------
        SweepError
            Where the file cannot be read or used: which line and column, what was found, expected, and to do.
        """
        called = name or shown_name(path)
        checked = partial(cls.from_columns, name=called, pole_pairs=pole_pairs)
        found, read_as = read_sweep(Path(path), checked, columns=columns, max_bytes=max_bytes, guess=guess)
        used = ", ".join(found.columns)
        LOG.info("read %s: %d rows, %d rejected; %s", found.name, found.rows, len(found.rejected), used)
        return replace(found, read_as=read_as)

    def write(self, path: str | Path) -> None:
        """Write the used rows as CSV, whole or not at all.

        Parameters
        ----------
        path : str or Path
            The file; one that ends in ``.gz`` is compressed.

        Raises
        ------
        twin.errors.UserError
            Where it cannot be written.
        """
        write_columns(Path(path), self.columns)

    def motion(self) -> Motion:
        """The conditions of each reading, with the reference's reading as shaft angle.

        Returns
        -------
        Motion
            What was not recorded is inferred where the rows allow it, see :meth:`Motion.from_angle`.
        """
        return self._motion

    @cached_property
    def _motion(self) -> Motion:
        if self.recordings is not None:
            rows, alone = np.arange(len(self)), replace(self, recordings=None)
            parts = [alone.part(rows[one]).motion() for one in self.recordings.slices]
            return Motion.joined(parts, self.recordings.setups)
        motion = Motion.from_angle(
            radians(self.reference_deg),
            time_s=self.time_s,
            direction=self.direction,
            speed_rad_s=None if self.speed_rpm is None else self.speed_rpm * RPM,
            turn=self.turn,
            temperature_c=self.temperature_c,
            current_a=self.current_a,
            has_channels=self.vx is not None,
        )
        return replace(motion, estimated=self.estimated)
