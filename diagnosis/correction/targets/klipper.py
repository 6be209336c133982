"""Klipper: the list ``calibrate`` of an angle section, from which the host solves its own table of 64 entries.

The list holds the sensor's angle (a turn is 65,536) at each full step of the motor. The host finds 64 whole numbers by
least squares, straight lines between which lead from the sensor's angle to the step. The list that is written is the
one of which it finds the best 64: the angles at which these lines meet the steps.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.correction.straight_lines import Least, Nodes, best_whole_numbers
from diagnosis.correction.targets.target import Target, hash_comment, rows
from diagnosis.correction.wanted import Wanted
from twin.angles import TAU, Array, IntArray
from twin.errors import UserError
from twin.shown import shown

_TURN = 65536
_BUCKETS = 64
_WIDE = _TURN // _BUCKETS
_FULL_STEPS = 200
_FIRST = "first entry: full step"


@dataclass(frozen=True, eq=False)
class Klipper:
    """Sensor angles (n,) at the full steps, the first at the ``first_step`` of the reference."""

    angle: Array
    first_step: int

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> Klipper:
        """The list of which Klipper makes the best table."""
        unit, step = TAU / _TURN, _TURN / entries
        nodes = Nodes.even(_BUCKETS)
        # What the table holds, up to whole steps: the reading, corrected, counted from the zero of the reference.
        zero = wanted.zero_rad / unit * wanted.slope
        best = best_whole_numbers(nodes, lambda at: wanted.added(at) - zero % step * unit, unit, least=least)
        line = _WIDE * np.arange(_BUCKETS + 1) + np.append(best, best[0])
        # Full steps lie where the lines meet multiples of a step.
        lowest = int(np.ceil(line[0] / step))
        targets = step * (lowest + np.arange(entries))
        line = _as_solved(line - targets[0])
        angle = np.interp(targets - targets[0], line, _WIDE * np.arange(_BUCKETS + 1.0))
        number = wanted.slope * (lowest + np.arange(entries) - int(zero // step))
        return cls._listed(angle, number % entries)

    @classmethod
    def _listed(cls, angle: Array, number: IntArray) -> Klipper:
        """In the order of the steps, from a fourth of them on: the phases of the motor come round every four."""
        order = np.argsort(number)
        start = int(number[0]) // 4 * 4 if _ascends(number) else int(number[-1]) // 4 * 4
        return cls(np.round(np.roll(angle[order], -start), 3), start)

    @classmethod
    def read(cls, text: str) -> Klipper:
        """The list of a file, and the step at which its comment says that it begins."""
        listed = re.search(r"^calibrate:((?:.|\n)*)", text, re.MULTILINE)
        first = re.findall(rf"^# {_FIRST} (\d+)", text, re.MULTILINE)
        if listed is None or not first:
            raise ValueError("no list, or no first step")
        return cls(np.array([float(word) for word in listed[1].replace(",", " ").split()]), int(first[-1]))

    def __len__(self) -> int:
        return int(self.angle.size)

    @property
    def reversed(self) -> bool:
        """Whether Klipper takes the sensor to count against the steps."""
        return bool(self.angle[-2] > self.angle[-1])

    @cached_property
    def table(self) -> IntArray:
        """The 65 whole numbers that Klipper solves from the list.

        Raises UserError where the steps do not tell them all.
        """
        angle = self.angle[::-1] if self.reversed else self.angle
        angle = np.roll(angle, -int(np.argmin(angle)))
        bucket = (np.floor(angle + 0.5).astype(np.int64) % _TURN) // _WIDE
        share = (angle - bucket * _WIDE) / _WIDE
        rows_of = np.arange(len(self))
        lines = np.zeros((len(self), _BUCKETS))
        lines[rows_of, bucket] = 1.0 - share
        lines[rows_of, (bucket + 1) % _BUCKETS] = share
        step = _TURN * rows_of / len(self) - np.where(bucket + 1 >= _BUCKETS, share * _TURN, 0.0)
        found, _, rank, _ = np.linalg.lstsq(lines, step, rcond=None)
        if rank < _BUCKETS:
            raise UserError(
                f"the sensor turns so unevenly that too few of {len(self)} full steps fall into some of the {_BUCKETS} "
                "parts of its turn for which Klipper solves an entry; place the sensor better, and measure again"
            )
        solved = np.trunc(found + 0.5).astype(np.int64)
        return np.append(solved, solved[0] + _TURN)

    def corrected(self, reading_rad: Array) -> Array:
        """In whole numbers, as on the host; counted from the zero of the reference, as the steps do."""
        angle = np.round(np.asarray(reading_rad) / TAU * _TURN).astype(np.int64) % _TURN
        bucket, part = angle // _WIDE, angle % _WIDE
        ends = self.table[bucket], self.table[bucket + 1]
        found = ends[0] + ((part * (ends[1] - ends[0]) + _WIDE // 2) // _WIDE)
        lowest = self.first_step + int(np.argmin(self.angle))
        return np.asarray(TAU * ((-found if self.reversed else found) / _TURN + lowest / len(self)))

    def text(self, about: Sequence[str], name: str) -> str:
        """A section to include in printer.cfg."""
        listed = rows([f"{value:.3f}" for value in self.angle], 8)
        return (
            f"{hash_comment(about)}# {_FIRST} {self.first_step} of {len(self)}, counted from the reference's zero\n"
            f"[angle {name}]\ncalibrate:\n    {listed}\n"
        )


def check_section(name: str) -> None:
    """Refuse a name that no section of printer.cfg can bear. Raises UserError."""
    if not re.fullmatch(r"[\w.+-]+", name, re.ASCII):
        raise UserError(
            f"--name is {shown(name)}, which names no section of printer.cfg; expected letters A to Z, digits, "
            "and _ - + . without blanks"
        )


def _ascends(number: IntArray) -> bool:
    """Whether step numbers (n,), which go once round, go up."""
    return bool((number[1] - number[0]) % number.size == 1)


def _as_solved(line: IntArray | Array) -> Array:
    """The lines with which Klipper's rounding ends at these whole numbers: it cuts what is below zero towards zero."""
    shifted = np.asarray(line, dtype=np.float64)
    shifted[0] -= shifted[0] < 0
    shifted[-1] = shifted[0] + _TURN
    return shifted


TARGET = Target(
    name="klipper",
    what="Klipper, list calibrate of an [angle] section (klipper:N for a motor of N full steps)",
    ending=".cfg",
    axis="entry k at full step k of the motor, which is the reference's axis",
    sign="the sensor's angle there; Klipper solves 64 entries from it, linear in between",
    unit="1/65536 of a turn",
    entries=_FULL_STEPS,
    fewest=_FULL_STEPS,
    most=1000,
    step=4,
    absolute=True,
    fitted=Klipper.fitted,
    read=Klipper.read,
    check_name=check_section,
    load="[include] it behind the section of that name (--name) in printer.cfg; the reference's zero must be a full "
    "step of phase 0 and count as the motor does, else ANGLE_CALIBRATE on the printer is the way",
)
