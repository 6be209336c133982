"""The table that ``halltwin export`` makes: what is asked for, what it is made of, and how it does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from diagnosis.correction.compensation import Correction, correction_of
from diagnosis.correction.cross_validation import Shaft, on
from diagnosis.correction.left_of_readings import of_held_out, of_readings, of_words, of_words_of
from diagnosis.correction.not_removed import NotRemoved, of_twin
from diagnosis.correction.straight_lines import Least
from diagnosis.correction.targets.known import target_of
from diagnosis.correction.targets.target import Table, Target
from diagnosis.correction.wanted import Wanted
from diagnosis.thermal.recording import Recording
from scenarios.commands.compensate_judge import Judged, held_out, on_others
from scenarios.commands.compensate_source import Readings
from scenarios.commands.protocol import COLDEST_C, HOTTEST_C
from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.decoded import Decoded
from twin.errors import UserError
from twin.limits import require_within
from twin.motion import Motion
from twin.shown import shown

TOLERANCE_DEG = 1e-4
"""Largest error from orders left out of the curve that a table follows: less than any of them tells."""
_WORDS = 65536
_SIMULATED = 720
_LEAST: tuple[Least, ...] = ("worst", "rms")


@dataclass(frozen=True)
class Asked:
    """Which table: its target, number of entries, what they are chosen for, the temperature [C], a name in the file."""

    target: Target
    entries: int
    least: Least
    temperature_c: float
    name: str

    @classmethod
    def checked(cls, target: str, least: str, temperature_c: float, name: str) -> Asked:
        """What is asked for. Raises UserError where there is no such table."""
        kind, entries = target_of(target)
        if least not in _LEAST:
            raise UserError(f"--least is {shown(least)}; expected worst or rms")
        kind.check_name(name)
        require_within("temperature", temperature_c, COLDEST_C, HOTTEST_C, "C")
        return cls(kind, entries, "worst" if least == "worst" else "rms", temperature_c, name)

    def table(self, wanted: Wanted) -> Table:
        """The table, as it is read back from its file."""
        return self.target.stored(wanted, self.entries, self.least)


@dataclass(frozen=True, eq=False)
class Source:
    """What a table is made of: readings, or where there are none a twin."""

    name: str
    readings: Readings | None
    twin: Chain
    temperature_c: float

    @cached_property
    def correction(self) -> Correction:
        """The curve that the table follows."""
        if self.readings is not None:
            return self.readings.correction
        return correction_of(self.twin, temperature_c=self.temperature_c, tolerance_deg=TOLERANCE_DEG)


@dataclass(frozen=True, eq=False)
class Exported:
    """A table with how it does: distances [deg] from its curve at all words, and on readings it never saw."""

    asked: Asked
    source: Source
    wanted: Wanted
    table: Table
    judged: Sequence[Judged]
    not_removed: Sequence[NotRemoved]

    @cached_property
    def away_deg(self) -> Array:
        """By how much the drive's angle (65536,) differs from the curve, at each 16-bit word."""
        word = TAU * np.arange(_WORDS) / _WORDS
        return np.degrees(wrap(self.asked.target.shaft(self.table, self.wanted, word) - self.wanted.shaft(word)))


def exported(wish: Asked, source: Source, others: Sequence[Decoded], *, seed: int) -> Exported:
    """The table of a source, judged on other sweeps, on blocks held out of its own, or on a simulated sweep."""
    wanted = Wanted.of(source.correction, wish.temperature_c)
    table = wish.table(wanted)

    def made_of_some(recording: Recording) -> Shaft:
        readings = source.readings
        assert readings is not None
        some = Wanted.of(readings.corrected(readings.calibrated(recording)), wish.temperature_c)
        stored = wish.table(some)
        return lambda reading, _: wish.target.shaft(stored, some, reading)

    def whole(reading: Array, _: Array) -> Array:
        return wish.target.shaft(table, wanted, reading)

    if source.readings is not None:
        judged = on_others(whole, others) if others else held_out(source.readings, made_of_some)
        # What a gross error does is no part of it.
        kept = source.readings.recording.part(~source.readings.calibration.gross)
        own = on(kept, whole).after_rad
        left = [
            *of_words(source.readings.as_read),
            *of_readings(kept, own, source.correction, wish.temperature_c),
        ]
        if not others:
            sound = judged[0].sound or judged[0]
            left += of_held_out((sound.without_gross() or sound).found, own, left)
    else:
        judged = on_others(whole, others or (_simulated(source.twin, wish.temperature_c, seed=seed),))
        if not others:
            judged = [replace(one, name="on a sweep simulated from it", title=source.name) for one in judged]
        left = of_twin(source.twin, wish.temperature_c, seed=seed)
    return Exported(wish, source, wanted, table, judged, [*left, *of_words_of(others)])


def _simulated(twin: Chain, temperature_c: float, *, seed: int) -> Decoded:
    """A sweep of the twin there and back at one temperature, at angles at which no table has an entry."""
    way = TAU * (np.arange(2 * _SIMULATED) + 1.0 / np.pi) / _SIMULATED
    motion = Motion.from_angle(
        np.concatenate([way, way[::-1]]),
        direction=np.repeat([1.0, -1.0], way.size),
        temperature_c=np.full(2 * way.size, temperature_c),
    )
    sweep = twin.simulate(motion, seed=seed)
    return Decoded(sweep, sweep, np.zeros(len(sweep), dtype=bool), np.zeros(len(sweep)))
