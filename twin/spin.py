"""Spin: a log of a turning shaft in which the sensor's readings stand alone, without a reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Self

import numpy as np

from twin.angles import Array, IntArray
from twin.errors import SweepError
from twin.logs.turn_seen import is_turn, turns_seen
from twin.periods import checked_pole_pairs
from twin.sweep_checks import as_recorded, check_both_channels, rows_in_use

if TYPE_CHECKING:
    from twin.logs.guess import Guess

FEWEST_ROWS = 64
"""Readings of which a motion and an error are told; a turn of fewer tells neither."""
_STILL_DEG = 3.0
"""Span of the readings of a shaft that stands: what sensors scatter by, and words of eight bits flicker by."""


@dataclass(frozen=True, eq=False)
class Spin:
    """The used rows of a log without a reference, in the order in which they were taken.

    Attributes
    ----------
    measured_deg : ndarray
        What the sensor reads [deg], (n,).
    time_s : ndarray or None
        When [s], never falling; None where not recorded: the readings are taken to be evenly spaced.
    others : mapping of str to ndarray
        Further columns of the file format by name, (n,) each.
    rejected : mapping of int to str
        Numbers of the rows that cannot be used (first reading = 1), and why.
    name : str
        Of the file, or of the kind of thing that the columns came from.
    row_numbers : ndarray
        Numbers (n,) of the used rows.
    read_as : Guess or None
        Of a log under names of its own: the statement by which its columns were read.
    """

    measured_deg: Array
    time_s: Array | None
    others: Mapping[str, Array]
    rejected: Mapping[int, str] = field(default_factory=dict)
    name: str = "spin"
    row_numbers: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    read_as: Guess | None = None

    def __repr__(self) -> str:
        return f"Spin({self.name!r}, {len(self)} readings, columns {', '.join(self.columns)})"

    def __len__(self) -> int:
        return int(self.measured_deg.size)

    @property
    def rows(self) -> int:
        """Rows recorded, the rejected ones included."""
        return len(self) + len(self.rejected)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the recorded columns, and of the readings where they are those of the channels."""
        return (*(("time_s",) if self.time_s is not None else ()), "measured_deg", *self.others)

    @classmethod
    def from_columns(cls, columns: Mapping[str, Array], *, name: str = "spin", pole_pairs: int | None = None) -> Self:
        """Check the columns and leave out rows with missing cells.

        Parameters
        ----------
        columns : mapping of str to ndarray
            ``measured_deg``, or ``vx`` and ``vy``, and where recorded ``time_s`` and other columns of the file format,
            (n,) each, in the units of their names; NaN where a cell is missing.
        name : str, optional
            What messages call it.
        pole_pairs : int, optional
            How often the field at the sensor turns in a turn of the shaft; more than once is refused: without a
            reference nothing says where in its turn the shaft stands.

        Raises
        ------
        SweepError
            Where they cannot be used.
        """
        if checked_pole_pairs(pole_pairs) is not None:
            raise SweepError(
                f"{name}: no reference_deg, and a sensor of {pole_pairs} periods a turn; its periods are told by a "
                "reference alone: record one beside it, or leave the pole pairs out to explain the error over a period"
            )
        data = as_recorded(columns, name=name)
        if "measured_deg" not in data and {"vx", "vy"} <= set(data):
            _check_centred(data["vx"], data["vy"], name=name)
            data["measured_deg"] = np.degrees(np.arctan2(data["vy"], data["vx"]))
        if "measured_deg" not in data:
            raise SweepError(f"{name}: no cell of measured_deg holds a number; expected the sensor's readings")
        check_both_channels(data, name=name)
        keep, rejected = rows_in_use(data)
        used = {key: np.ascontiguousarray(values[keep]) for key, values in data.items()}
        measured, time = used.pop("measured_deg"), used.pop("time_s", None)
        _check(measured, time, rows=np.flatnonzero(keep) + 1, rejected=len(rejected), name=name)
        return cls(measured, time, used, rejected, name, np.flatnonzero(keep) + 1)


def _check(measured: Array, time: Array | None, *, rows: IntArray, rejected: int, name: str) -> None:
    if measured.size < FEWEST_ROWS:
        lost = f" ({rejected} rejected for missing or infinite cells)" if rejected else ""
        raise SweepError(
            f"{name}: {measured.size} usable rows{lost} and no reference_deg; without a reference expected at least "
            f"{FEWEST_ROWS} readings of a turning shaft with time_s; or add reference_deg"
        )
    if time is not None:
        _check_time(time, rows=rows, name=name)
    why = why_no_turn(measured)
    if why is not None:
        raise SweepError(
            f"{name}: no reference_deg, and by its readings {why}; without a reference expected a shaft that coasts or "
            "turns steadily for some whole turns; or add reference_deg"
        )


def _check_time(time: Array, *, rows: IntArray, name: str) -> None:
    back = np.flatnonzero(np.diff(time) < 0.0)
    if back.size:
        row = int(back[0]) + 1
        raise SweepError(
            f"{name}: row {rows[row]}, column time_s: found {time[row]:g} after {time[row - 1]:g}; without a reference "
            "the motion is told by the time: expected one that never falls: sort the rows, or split the log"
        )
    if time[-1] == time[0]:
        raise SweepError(f"{name}: column time_s: every row is {time[0]:g}; expected the time of each reading")


def _check_centred(vx: Array, vy: Array, *, name: str) -> None:
    """Raise SweepError for channels whose middle lies so far from zero that their angle goes round nothing."""
    for channel, values in (("vx", vx), ("vy", vy)):
        known = values[np.isfinite(values)]
        if known.size and (np.min(known) > 0.0 or np.max(known) < 0.0):
            middle = float(np.min(known) + np.max(known)) / 2.0
            raise SweepError(
                f"{name}: column {channel} goes from {np.min(known):g} to {np.max(known):g} and never changes its "
                f"sign, so that atan2(vy, vx) makes no turn; take the middle of its range off, about {middle:.4g}, "
                f'from either channel, as halltwin import does: --columns "time_s=NAME, vx=NAME-MIDDLE, '
                f'vy=NAME-MIDDLE"'
            )


def why_no_turn(measured_deg: Array) -> str | None:
    """What a shaft does whose readings (n,) [deg], one after another, make no whole turn; None where they do."""
    travel = np.unwrap(measured_deg, period=360.0)
    span = float(np.ptp(travel))
    if span >= 360.0:
        return None
    seen = turns_seen(measured_deg)
    if seen and not is_turn(360.0, seen[0]):
        return (
            f"these begin anew after {seen[0][0]:.4g} deg, which is no turn: another unit, or another number of "
            "counts, which halltwin doctor tells"
        )
    # A word of few bits that flickers stands still; so does what noise moves about one place.
    if span < _STILL_DEG:
        return f"the shaft stands still, at {float(np.median(travel)) % 360.0:.4g} deg"
    first, last = float(np.median(travel[: travel.size // 8 + 1])), float(np.median(travel[-(travel.size // 8 + 1) :]))
    if abs(last - first) > 0.7 * span:
        return f"the shaft turns by {span:.4g} deg in all, less than a turn"
    return f"the shaft rocks over {span:.4g} deg, and makes no whole turn"
