"""Sweep: what the bench records, and the checks that make it usable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

import numpy as np

from twin.angles import Array, IntArray, radians, wrap_deg
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.errors import SweepError
from twin.following import FOLLOWS_DEG, distance_deg, follows, spread_deg
from twin.log import LOG
from twin.logs.read import advice, read_log
from twin.motion import RPM, Motion
from twin.recordings import Recordings
from twin.shown_name import shown_name
from twin.sweep_columns import COLUMNS, MAY_BE_MISSING, OF_SETUP, PLAUSIBLE, REQUIRED, SMALLEST_AMPLITUDE
from twin.sweep_file import write_columns
from twin.sweep_reader import read_columns

FEWEST_ROWS = 8
_ONE_ANGLE_DEG = 0.1
"""Angles closer than this count as one: a jig's stop, read again."""


@dataclass(frozen=True, eq=False)
class Sweep:
    """The used rows of a recording, all columns of shape (n,), in the order in which they were taken.

    Made by :meth:`read`, :meth:`from_columns` or a simulation (:meth:`twin.Chain.simulate`); the constructor itself
    checks nothing.

    Attributes
    ----------
    reference_deg, measured_deg : ndarray
        What the reference and the sensor read [deg], (n,); any range, wrapped or not.
    time_s, direction, speed_rpm, turn, temperature_c, air_gap_mm, mounting_deg, vx, vy : ndarray or None
        Further columns (n,), None where not recorded: time [s], +1 or -1, speed, number of the turn or sweep,
        temperature [C] (NaN where missing), air gap [mm], by how much the sensor is turned about the shaft [deg], and
        the two channels in any unit.
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
    rejected: Mapping[int, str] = field(default_factory=dict)
    name: str = "sweep"
    row_numbers: IntArray | None = None
    set_aside: int = 0
    recordings: Recordings | None = None

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
        return replace(self, **columns, row_numbers=self.numbers[rows], set_aside=aside, recordings=recordings)

    @property
    def columns(self) -> dict[str, Array]:
        """The recorded columns by name, in the order of the file format."""
        found = {name: getattr(self, name) for name in COLUMNS}
        return {name: values for name, values in found.items() if values is not None}

    @classmethod
    def from_columns(cls, columns: Mapping[str, Array], *, name: str = "sweep") -> Self:
        """Check the columns and leave out rows with missing cells.

        Parameters
        ----------
        columns : mapping of str to ndarray
            Columns of the file format by name, (n,) each, in the units of their names; NaN where a cell is missing.
            Others are ignored.
        name : str, optional
            What messages call it.

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
        for needed in REQUIRED:
            if needed not in columns:
                found = ", ".join(columns) or "none"
                raise SweepError(f"{name}: column {needed} is missing; found {found}; rename the column or add it")
        data = {key: np.asarray(columns[key], dtype=np.float64) for key in COLUMNS if key in columns}
        for key, values in data.items():
            _check_plausible(key, values, name=name)
        # A column without a single reading was not recorded.
        data = {key: v for key, v in data.items() if key in REQUIRED or np.isfinite(v).any()}
        if ("vx" in data) != ("vy" in data):
            have, lack = ("vx", "vy") if "vx" in data else ("vy", "vx")
            raise SweepError(f"{name}: column {have} stands without {lack}; expected both channels or none: add {lack}")
        rejected: dict[int, str] = {}
        keep = np.ones(data["reference_deg"].size, dtype=bool)
        for key, values in data.items():
            if key in MAY_BE_MISSING:
                continue
            bad = np.flatnonzero(~np.isfinite(values) & keep)
            keep[bad] = False
            rejected.update({int(row) + 1: f"{key} missing or not finite" for row in bad})
        used: dict[str, Any] = {key: np.ascontiguousarray(values[keep]) for key, values in data.items()}
        _check_usable(used, name=name, rejected=len(rejected))
        _check_follows(used["measured_deg"], used["reference_deg"], name=name)
        if "vx" in used:
            _check_channels(used["vx"], used["vy"], used["measured_deg"], name=name)
        return cls(**used, rejected=dict(sorted(rejected.items())), name=name, row_numbers=np.flatnonzero(keep) + 1)

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
    ) -> Self:
        """Read a sweep file and check it.

        Parameters
        ----------
        path : str or Path
            CSV, plain or gzip, or Parquet where pyarrow is installed; its content says which. With ``columns`` a log
            of any dialect, XLSX, MAT, NPZ, HDF5 or Parquet.
        max_bytes, name : int and str, optional
            Most bytes of the file after decompression; what messages call it, if not by the file's name.
        columns : str, optional
            Which columns of a log are those of a sweep, in which unit, such as
            ``"reference_deg=enc_counts*360/40000, measured_deg=angle:rad"``; None: it has those of a sweep.

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
        if columns is not None:
            found = cls.from_columns(read_log(Path(path), columns=columns, max_bytes=max_bytes).columns, name=called)
        else:
            try:
                found = cls.from_columns(read_columns(Path(path), max_bytes=max_bytes), name=called)
            except SweepError as error:
                raise SweepError(f"{error}{advice(Path(path))}") from None
        used = ", ".join(found.columns)
        LOG.info("read %s: %d rows, %d rejected; %s", found.name, found.rows, len(found.rejected), used)
        return found

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
        if self.recordings is not None:
            rows, alone = np.arange(len(self)), replace(self, recordings=None)
            parts = [alone.part(rows[one]).motion() for one in self.recordings.slices]
            return Motion.joined(parts, self.recordings.setups)
        return Motion.from_angle(
            radians(self.reference_deg),
            time_s=self.time_s,
            direction=self.direction,
            speed_rad_s=None if self.speed_rpm is None else self.speed_rpm * RPM,
            turn=self.turn,
            temperature_c=self.temperature_c,
            has_channels=self.vx is not None,
        )


def _check_plausible(key: str, values: Array, *, name: str) -> None:
    """Refuse the first cell (n,) that no bench can have meant; what is missing or infinite is not judged here."""
    known = np.isfinite(values)
    if key == "direction":
        wrong = known & (np.abs(values) != 1.0)
        expected = "+1 or -1; leave the column out where the direction was not recorded"
    else:
        low, high = PLAUSIBLE[key]
        wrong = known & ((values < low) | (values > high))
        expected = f"{low:g} to {high:g}; leave the cell empty where there is no reading"
        if key in OF_SETUP and not wrong.any():
            first = values[np.argmax(known)]
            wrong, expected = known & (values != first), f"{first:g} as before: one number for the whole recording"
        if key == "turn" and not wrong.any():
            wrong = known & (values != np.round(values))
            expected = "a whole number: which sweep or revolution the reading belongs to"
    if wrong.any():
        row = int(np.argmax(wrong))
        raise SweepError(f"{name}: row {row + 1}, column {key}: found {values[row]:g}; expected {expected}")


def _check_usable(data: Mapping[str, Array], *, name: str, rejected: int) -> None:
    """Enough rows at enough angles, in degrees, and a sensor that moves."""
    reference, measured = data["reference_deg"], data["measured_deg"]
    n = reference.size
    if n < FEWEST_ROWS:
        lost = f" ({rejected} rejected for missing or infinite cells)" if rejected else ""
        raise SweepError(f"{name}: {n} usable rows{lost}; expected at least {FEWEST_ROWS} readings over the circle")
    if np.max(np.abs(wrap_deg(reference - reference[0]))) < _ONE_ANGLE_DEG:
        raise SweepError(
            f"{name}: column reference_deg: every row is {reference[0]:g} deg; expected readings at different angles"
        )
    if np.max(np.abs(wrap_deg(measured - measured[0]))) == 0.0:
        raise SweepError(
            f"{name}: column measured_deg: every row is {measured[0]:g} deg while the reference moves; "
            "expected a sensor that follows; check the sensor's link"
        )
    if np.ptp(reference) <= 6.4 and np.ptp(measured) <= 6.4:
        raise SweepError(
            f"{name}: columns reference_deg and measured_deg span {np.ptp(reference):.3g} and {np.ptp(measured):.3g}: "
            "that looks like radians or turns; expected degrees: convert both columns"
        )
    count = np.unique(np.round(wrap_deg(reference) / _ONE_ANGLE_DEG)).size
    if count < FEWEST_ROWS:
        raise SweepError(f"{name}: column reference_deg: {count} different angles; expected at least {FEWEST_ROWS}")


def _check_follows(measured: Array, reference: Array, *, name: str) -> None:
    """Refuse columns (n,) [deg] that do not go round together, with the reason where it can be seen."""
    to_deg = 180.0 / np.pi
    if follows(measured, reference):
        if _repeats_every_radian_turn(measured, reference):
            raise SweepError(
                f"{name}: columns reference_deg and measured_deg: the error repeats every 6.283 over a span of "
                f"{np.ptp(reference):.4g}: that looks like radians; expected degrees: convert both columns"
            )
        return
    for wrong, (scale_measured, scale_reference) in {
        "column reference_deg": (1.0, to_deg),
        "column measured_deg": (to_deg, 1.0),
        "columns reference_deg and measured_deg": (to_deg, to_deg),
    }.items():
        if follows(scale_measured * measured, scale_reference * reference):
            raise SweepError(
                f"{name}: {wrong}: the two columns agree only if this is in radians (they span "
                f"{np.ptp(reference):.4g} and {np.ptp(measured):.4g}); expected degrees: convert it"
            )
    for pole_pairs in range(2, 13):
        if follows(measured, pole_pairs * reference):
            raise SweepError(
                f"{name}: measured_deg turns {pole_pairs} times as fast as reference_deg; expected both in degrees of "
                "the same shaft: unwrap and divide the faster one"
            )
    raise SweepError(
        f"{name}: measured_deg does not follow reference_deg (typically {distance_deg(measured, reference):.0f} deg "
        f"off, in the better counting sense; expected below {FOLLOWS_DEG:g}); "
        "check that both columns belong to one sweep and are in degrees"
    )


def _check_channels(vx: Array, vy: Array, measured: Array, *, name: str) -> None:
    """Refuse channels (n,) whose angle is not what the sensor reports: a radius taken from them would say nothing."""
    for key, values in (("vx", vx), ("vy", vy)):
        if np.max(np.abs(values)) < SMALLEST_AMPLITUDE:
            raise SweepError(
                f"{name}: column {key}: no reading is larger than {np.max(np.abs(values)):.3g}; expected a signal of "
                f"at least {SMALLEST_AMPLITUDE:g} in its unit: scale both channels, or leave them out"
            )
        if np.ptp(values) == 0.0:
            raise SweepError(
                f"{name}: column {key}: every row is {values[0]:g} while the reference moves; "
                "expected the channel's signal: mend it, or leave vx and vy out"
            )
    if follows(np.degrees(np.arctan2(vy, vx)), measured):
        return
    middle = [float(np.min(values) + np.max(values)) / 2.0 for values in (vx, vy)]
    hint = "check the columns, or leave vx and vy out"
    if follows(np.degrees(np.arctan2(vy - middle[1], vx - middle[0])), measured):
        hint = f"the channels stand at about {middle[0]:.4g} and {middle[1]:.4g} in mid-range: take that off both"
    raise SweepError(
        f"{name}: columns vx, vy: atan2(vy, vx) does not follow measured_deg; expected the two channels that the angle "
        f"is computed from, zero at zero field; {hint}"
    )


def _repeats_every_radian_turn(measured: Array, reference: Array) -> bool:
    """Whether the error (n,) repeats every 2 pi rather than every 360: several turns in radians also follow.

    Asked only of sweeps that hold two turns if they are in radians, and less than one in degrees.
    """
    if not 4.0 * np.pi <= np.ptp(reference) <= 340.0 or reference.size < 20:
        return False
    sense = min((1.0, -1.0), key=lambda s: spread_deg(measured - s * reference))
    to_deg = 180.0 / np.pi
    in_radians = _left_by_two_orders(to_deg * (measured - sense * reference), to_deg * reference) / to_deg
    return 3.0 * in_radians < _left_by_two_orders(measured - sense * reference, reference)


def _left_by_two_orders(error: Array, reference: Array) -> float:
    """Typical (median) error [deg] that orders 0 to 2 leave of errors (n,) [deg]; single wild readings do not count."""
    turn = radians(reference)
    orders = np.stack([np.ones_like(turn), np.cos(turn), np.sin(turn), np.cos(2 * turn), np.sin(2 * turn)], axis=1)
    error = wrap_deg(error - np.degrees(np.angle(np.mean(np.exp(1j * radians(error))))))
    kept = np.ones(error.size, dtype=bool)
    left = np.abs(error)
    for _ in range(3):
        left = np.abs(error - orders @ np.linalg.lstsq(orders[kept], error[kept], rcond=None)[0])
        kept = left <= 5.0 * np.median(left)
    return float(np.median(left))
