"""How a correction does: on held-out blocks and temperatures of its own readings, or on other sweeps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.correction.as_read import AsRead, as_read
from diagnosis.correction.both_ways import between_ways
from diagnosis.correction.cross_validation import BeforeAfter, Shaft, between, on, on_held_out, shafts_without
from diagnosis.report.motion import not_separable
from diagnosis.report.wording import plain
from diagnosis.thermal.levels import levels_of
from diagnosis.thermal.recording import Recording
from scenarios.commands.compensate_source import Readings
from scenarios.commands.fail_on import FoundError
from twin.decoded import Decoded
from twin.effect import BoolArray

_TOLD = 4
"""Digits to which errors are told that are larger with a correction."""
AS_READ = "words as they are read"
"""What readings are called with the faults of their words."""
WITHOUT_FAULTS = "without the faults of the words"
"""What readings are called from which these are taken off."""


@dataclass(frozen=True, eq=False)
class Judged:
    """Errors (n,) of a correction on readings: ``name`` says which ones, ``title`` what the picture calls them.

    ``own_zeros``: each turn's own zero counts for nothing, as where the reference was set anew. ``part``: the readings
    are among those of the one before that is none. ``alone``: of a temperature that the correction was made without.
    ``gross`` (n,): the readings that were set aside where the correction was made of these. ``lost`` (n,): those whose
    word says nothing of the angle. ``sound``: the same readings without the faults of their words, where they have any.
    ``with_torques``: torques turn the shaft by what is as good an error of the sensor.
    """

    name: str
    title: str
    found: BeforeAfter
    tested: Recording
    own_zeros: bool = False
    part: bool = False
    alone: bool = False
    gross: BoolArray | None = None
    lost: BoolArray | None = None
    sound: Judged | None = None
    with_torques: bool = False

    @property
    def several_turns(self) -> bool:
        """Whether the readings are of several turns or sweeps."""
        return bool(np.unique(self.tested.unit).size > 1)

    def without_gross(self) -> Judged | None:
        """The same without the readings that were set aside; None where none was."""
        if self.gross is None or not self.gross.any():
            return None
        kept = ~self.gross
        name = f"without the {np.count_nonzero(self.gross)} set aside"
        return replace(self, name=name, found=self.found.among(kept), tested=self.tested.part(kept), gross=None)

    def without_zeros(self) -> Judged:
        """The same with each turn's own zero taken out."""
        return replace(self, found=self.found.per_turn(self.tested.unit.astype(np.float64)), own_zeros=True)

    def without_lost(self) -> Judged:
        """The same without the readings whose word says nothing of the angle."""
        if self.lost is None or not self.lost.any() or self.lost.all():
            return self
        kept = ~self.lost
        name = f"{self.name}, {np.count_nonzero(self.lost)} readings that say nothing left out"
        return replace(self, name=name, found=self.found.among(kept), tested=self.tested.part(kept), lost=None)


def on_others(shaft: Shaft, sweeps: Sequence[Decoded]) -> list[Judged]:
    """A finished correction on other sweeps, each at its temperatures, as a drive reads their words."""
    judged = []
    for sweep in sweeps:
        readings = as_read([sweep])
        name, motion = sweep.sweep.name, sweep.sweep.estimated
        open_orders = [] if motion is None else not_separable(motion)
        found = on(readings.read, shaft)
        whole = Judged(f"on {name}", name, found, readings.read, with_torques=bool(open_orders))
        whole = _beside_sound(whole, readings, on(readings.told, shaft))
        judged += [whole, *_by_level(whole)]
    return judged


def held_out(readings: Readings, build: Callable[[Recording], Shaft] | None = None) -> list[Judged]:
    """The correction that readings make, on parts of them that it was not made of, as a drive reads their words.

    ``build`` makes of some of the readings what is judged, where that is not the correction itself.
    """
    given, make = readings.as_read, build or readings.shaft_of
    recording = given.read
    level = levels_of(recording)
    numbers = level.of_reading if readings.over_temperature else np.zeros_like(recording.unit)

    def without(rows: BoolArray) -> Shaft:
        return make(between_ways(given.kept_of(rows)))

    shafts = shafts_without(numbers, without)
    name = f"on held-out blocks{', torques included' if readings.not_separable else ''}"
    whole = Judged(name, readings.title, on_held_out(recording, shafts), recording, readings.own_zeros)
    gross = readings.calibration.gross
    whole = _beside_sound(whole, given, on_held_out(given.told, shafts), gross=gross)
    if not readings.over_temperature:
        return [whole]
    judged = [whole, *_by_level(whole)]
    for k, one in between(recording, numbers, without).items():
        name = f"{level.temperature_c[k]:.1f} C, made without it"
        rows = recording.part(numbers == k)
        judged.append(
            Judged(f"at {name}", f"{readings.title}, {name}", one, rows, readings.own_zeros, part=True, alone=True)
        )
    return judged


def rows_of(judged: Sequence[Judged], *, other: bool) -> list[Judged]:
    """As it is and, where the reference may have found its zero anew, with each turn's own zero taken out.

    Of the readings that the correction is made of also without their gross errors, which all others count.
    """
    rows = []
    for one in judged:
        if one.part:
            rows.append(replace(one.without_zeros() if other or one.own_zeros else one, name=f"  {one.name}"))
            continue
        apart = other or one.several_turns or one.sound is not None
        rows.append(one)
        if apart:
            rows.append(replace(one.without_zeros(), name="  each turn's own zero taken out"))
        if one.sound is not None:
            sound = one.sound.without_zeros() if apart else one.sound
            rows.append(replace(sound, name=f"  {'and ' * apart}{WITHOUT_FAULTS}"))
        kept = (one.sound or one).without_gross()
        if kept is not None:
            rows.append(replace(kept.without_zeros() if apart else kept, name=f"  {'and ' * apart}{kept.name}"))
    return rows


def say_where_worse(judged: Sequence[Judged], *, fails: bool) -> None:
    """Say on which readings the correction makes the error larger; raise FoundError there where that is a failure.

    Judged with each turn's own zero taken out: a reference that was mounted anew says nothing about the correction. No
    more does a word that says nothing of the angle; all others count as the drive reads them. Where torques may be what
    is larger, that is said, and no failure.
    """
    larger: list[str] = []
    not_told: list[str] = []
    for one in judged:
        one = one.without_lost()
        before, after = one.without_zeros().found.rms_deg
        told = plain(before, _TOLD), plain(after, _TOLD)
        # What is the same as it is told is no larger: beside a stuck top bit no table does anything.
        if after > before and told[0] != told[1]:
            words = f"{one.name} ({told[0]} -> {told[1]} deg RMS, own zero taken out)"
            (not_told if one.with_torques else larger).append(words)
    if not_told:
        print(f"larger with the correction {', '.join(not_told)}: by the sensor or by torques, which it does not tell")
    if larger:
        said = f"the correction makes the error larger {', '.join(larger)}; do not load it"
        if fails:
            raise FoundError(said)
        print(said)


def _beside_sound(whole: Judged, given: AsRead, told: BeforeAfter, *, gross: BoolArray | None = None) -> Judged:
    """Readings with the same ones beside them without the faults of their words, where they have any.

    Not where a correction is of other readings, and these are told back: they may be so with another zero than its own.
    """
    if not given.faults:
        return replace(whole, gross=gross)
    if gross is None and given.told_back.any():
        return replace(whole, name=f"{whole.name}, {AS_READ}", lost=given.lost)
    kept = ~given.lost
    name = f"{whole.name}, {WITHOUT_FAULTS}"
    sound = replace(whole, name=name, found=told.among(kept), tested=given.kept, gross=gross)
    return replace(whole, name=f"{whole.name}, {AS_READ}", lost=given.lost, sound=sound)


def _by_level(whole: Judged) -> list[Judged]:
    """The same errors temperature by temperature, where there are several."""
    level = levels_of(whole.tested)
    if len(level) < 2:
        return []
    return [
        replace(
            whole,
            name=f"at {level.temperature_c[k]:.1f} C",
            found=whole.found.among(level.of_reading == k),
            tested=whole.tested.part(level.of_reading == k),
            part=True,
            gross=None,
            lost=None if whole.lost is None else whole.lost[level.of_reading == k],
            sound=None,
        )
        for k in range(len(level))
    ]
