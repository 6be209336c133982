"""Sweep: what the bench records, and the checks that make it usable."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from twin.angles import Array, radians, wrap_deg
from twin.errors import UserError
from twin.motion import Motion

if TYPE_CHECKING:
    from typing import Self

COLUMNS = (
    "time_s",
    "reference_deg",
    "measured_deg",
    "direction",
    "speed_rpm",
    "turn",
    "temperature_c",
    "vx",
    "vy",
)
REQUIRED = ("reference_deg", "measured_deg")
MAY_BE_MISSING = frozenset({"temperature_c"})
FEWEST_ROWS = 8
_LARGEST = 1e12


class SweepError(UserError):
    """The sweep cannot be used; the message says in one line where, what was found and what was expected."""


@dataclass(frozen=True, eq=False)
class Sweep:
    """The used rows of a recording, all columns of shape (n,), in the order in which they were taken.

    ``rejected`` maps the numbers of the rows left out (first reading = 1) to the reason; ``rows`` counts both.
    ``line`` says where a row stands in the file, for messages.
    """

    reference_deg: Array
    measured_deg: Array
    time_s: Array | None = None
    direction: Array | None = None
    speed_rpm: Array | None = None
    turn: Array | None = None
    temperature_c: Array | None = None
    vx: Array | None = None
    vy: Array | None = None
    rejected: Mapping[int, str] = field(default_factory=dict)
    name: str = "sweep"

    def __len__(self) -> int:
        return int(self.reference_deg.size)

    @property
    def rows(self) -> int:
        """Rows recorded, the rejected ones included."""
        return len(self) + len(self.rejected)

    @property
    def columns(self) -> dict[str, Array]:
        """The recorded columns by name, in the order of the file format."""
        found = {name: getattr(self, name) for name in COLUMNS}
        return {name: values for name, values in found.items() if values is not None}

    @classmethod
    def from_columns(cls, columns: Mapping[str, Array], *, name: str = "sweep") -> Self:
        """Check the columns (each (n,), in the units of their names) and leave out rows with missing cells.

        Raises SweepError where they cannot be used as a sweep.
        """
        for needed in REQUIRED:
            if needed not in columns:
                found = ", ".join(columns) or "none"
                raise SweepError(f"{name}: column {needed} is missing; found {found}; rename the column or add it")
        if ("vx" in columns) != ("vy" in columns):
            have, lack = ("vx", "vy") if "vx" in columns else ("vy", "vx")
            raise SweepError(f"{name}: column {have} stands without {lack}; give both channels or none")
        data = {key: np.asarray(columns[key], dtype=np.float64) for key in COLUMNS if key in columns}
        for key, values in data.items():
            with np.errstate(invalid="ignore"):
                huge = np.flatnonzero(np.isfinite(values) & (np.abs(values) > _LARGEST))
            if huge.size:
                row = int(huge[0])
                raise SweepError(
                    f"{name}: row {row + 1}, column {key}: {values[row]:g} is no plausible value; "
                    f"expected at most {_LARGEST:g}"
                )
        # A column without a single reading was not recorded.
        data = {key: v for key, v in data.items() if key in REQUIRED or np.isfinite(v).any()}
        if ("vx" in data) != ("vy" in data):
            data = {key: v for key, v in data.items() if key not in ("vx", "vy")}
        rejected: dict[int, str] = {}
        keep = np.ones(data["reference_deg"].size, dtype=bool)
        for key, values in data.items():
            if key in MAY_BE_MISSING:
                continue
            bad = np.flatnonzero(~np.isfinite(values) & keep)
            keep[bad] = False
            rejected.update({int(row) + 1: f"{key} missing or not finite" for row in bad})
        used = {key: np.ascontiguousarray(values[keep]) for key, values in data.items()}
        _check_usable(used, name=name, rejected=len(rejected))
        return cls(**used, rejected=dict(sorted(rejected.items())), name=name)

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
    def read(cls, path: str | Path) -> Self:
        """Read a sweep file (CSV, also .gz; Parquet with pyarrow installed). Raises SweepError."""
        from twin.sweep_file import read_columns

        return cls.from_columns(read_columns(Path(path)), name=Path(path).name)

    def write(self, path: str | Path) -> None:
        """Write the used rows as CSV (gzip where the name ends in .gz), beside and then renamed."""
        from twin.sweep_file import write_columns

        write_columns(Path(path), self.columns)

    def motion(self) -> Motion:
        """The conditions of each reading, with the reference's reading as shaft angle."""
        return Motion.from_angle(
            radians(self.reference_deg),
            time_s=self.time_s,
            direction=self.direction,
            speed_rad_s=None if self.speed_rpm is None else self.speed_rpm * (2.0 * np.pi / 60.0),
            turn=self.turn,
            temperature_c=self.temperature_c,
            has_channels=self.vx is not None,
        )


def _check_usable(data: Mapping[str, Array], *, name: str, rejected: int) -> None:
    reference, measured = data["reference_deg"], data["measured_deg"]
    n = reference.size
    if n < FEWEST_ROWS:
        lost = f" ({rejected} rejected for missing cells)" if rejected else ""
        raise SweepError(f"{name}: {n} usable rows{lost}; expected at least {FEWEST_ROWS} readings over the circle")
    if np.ptp(reference) == 0.0:
        raise SweepError(
            f"{name}: column reference_deg: every row is {reference[0]:g} deg; expected readings at different angles"
        )
    if np.ptp(measured) == 0.0:
        raise SweepError(
            f"{name}: column measured_deg: every row is {measured[0]:g} deg while the reference moves; "
            "expected a sensor that follows; check the sensor's link"
        )
    if np.ptp(reference) <= 6.4 and np.ptp(measured) <= 6.4:
        raise SweepError(
            f"{name}: columns reference_deg and measured_deg span {np.ptp(reference):.3g} and {np.ptp(measured):.3g}: "
            "that looks like radians; expected degrees"
        )
    if np.unique(np.round(wrap_deg(reference), 3)).size < FEWEST_ROWS:
        count = np.unique(np.round(wrap_deg(reference), 3)).size
        raise SweepError(f"{name}: column reference_deg: {count} different angles; expected at least {FEWEST_ROWS}")
    follows = max(abs(np.mean(np.exp(1j * radians(measured - sense * reference)))) for sense in (1.0, -1.0))
    if follows < 0.6:
        raise SweepError(
            f"{name}: measured_deg does not follow reference_deg (correlation on the circle {follows:.2f}, expected "
            "above 0.6); check that both columns belong to one sweep and are in degrees"
        )
