"""How a correction does: on held-out blocks and temperatures of its own readings, or on other sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.correction.cross_validation import BeforeAfter, Shaft, between, cross_validated, on
from diagnosis.thermal.levels import levels_of
from diagnosis.thermal.recording import Recording, joined
from scenarios.commands.compensate_source import Readings
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


def held_out(readings: Readings) -> list[Judged]:
    """The correction that readings make, on parts of them that it was not made of."""
    recording = readings.recording
    level = levels_of(recording)
    build = readings.shaft_of
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
