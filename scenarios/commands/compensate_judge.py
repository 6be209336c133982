"""How a correction does: on held-out blocks and temperatures of its own readings, or on other sweeps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.correction.cross_validation import BeforeAfter, Shaft, between, cross_validated, on
from diagnosis.report.wording import plain
from diagnosis.thermal.levels import levels_of
from diagnosis.thermal.recording import Recording, joined
from scenarios.commands.compensate_source import Readings
from scenarios.commands.fail_on import FoundError
from twin.effect import BoolArray
from twin.sweep import Sweep


@dataclass(frozen=True, eq=False)
class Judged:
    """Errors (n,) of a correction on readings: ``name`` says which ones, ``title`` what the picture calls them.

    ``own_zeros``: each turn's own zero counts for nothing, as where the reference was set anew. ``part``: the readings
    are among those of the one before that is none. ``alone``: of a temperature that the correction was made without.
    ``gross`` (n,): the readings that were set aside where the correction was made of these.
    """

    name: str
    title: str
    found: BeforeAfter
    tested: Recording
    own_zeros: bool = False
    part: bool = False
    alone: bool = False
    gross: BoolArray | None = None

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


def on_others(shaft: Shaft, sweeps: Sequence[Sweep]) -> list[Judged]:
    """A finished correction on other sweeps, each at its temperatures."""
    judged = []
    for sweep in sweeps:
        recording = joined([sweep])
        whole = Judged(f"on {sweep.name}", sweep.name, on(recording, shaft), recording)
        judged += [whole, *_by_level(whole)]
    return judged


def held_out(readings: Readings, build: Callable[[Recording], Shaft] | None = None) -> list[Judged]:
    """The correction that readings make, on parts of them that it was not made of.

    ``build`` makes of some of the readings what is judged, where that is not the correction itself.
    """
    recording = readings.recording
    level = levels_of(recording)
    build = build or readings.shaft_of
    numbers = level.of_reading if readings.over_temperature else np.zeros_like(recording.unit)
    found = cross_validated(recording, numbers, build)
    gross, zeros = readings.calibration.gross, readings.own_zeros
    whole = Judged("on held-out blocks", readings.title, found, recording, zeros, gross=gross)
    if not readings.over_temperature:
        return [whole]
    judged = [whole, *_by_level(whole)]
    for k, one in between(recording, numbers, build).items():
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
        apart, kept = other or one.several_turns, one.without_gross()
        rows.append(one)
        if apart:
            rows.append(replace(one.without_zeros(), name="  each turn's own zero taken out"))
        if kept is not None:
            rows.append(replace(kept.without_zeros() if apart else kept, name=f"  {'and ' * apart}{kept.name}"))
    return rows


def say_where_worse(judged: Sequence[Judged], *, fails: bool) -> None:
    """Say on which readings the correction makes the error larger; raise FoundError there where that is a failure.

    Judged with each turn's own zero taken out: a reference that was mounted anew says nothing about the correction.
    """
    larger = []
    for one in judged:
        before, after = one.without_zeros().found.rms_deg
        if after > before:
            larger.append(f"{one.name} ({plain(before, 4)} -> {plain(after, 4)} deg RMS, own zero taken out)")
    if larger:
        said = f"the correction makes the error larger {', '.join(larger)}; do not load it"
        if fails:
            raise FoundError(said)
        print(said)


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
        )
        for k in range(len(level))
    ]
