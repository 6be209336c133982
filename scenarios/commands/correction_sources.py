"""What a correction is made of, as it is named on the command line: one twin, or the sweeps of one sensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from diagnosis.report.motion import judged_words
from diagnosis.report.row_counts import counts_of, rejected_words
from scenarios.commands.inputs import SweepFiles, SweepsRead, in_motion, sweep_paths
from twin.decoded import Decoded, decoded
from twin.effect import Effect
from twin.errors import UserError
from twin.estimated_motion import EstimatedMotion
from twin.presets import is_twin
from twin.shown_name import shown_name


def is_one_twin(sources: Sequence[str | Path]) -> bool:
    """Whether the sources are one twin. Raises UserError where one of several is."""
    twins = [source for source in sources if is_twin(source)]
    if twins and len(sources) > 1:
        raise UserError(
            f"{shown_name(twins[0])} is a twin beside other sources; give one twin alone, or the sweeps of one sensor"
        )
    return bool(twins)


def files_of(sources: Sequence[str | Path]) -> list[Path]:
    """The files of sweeps; a single name that is no folder or pattern stands for itself, there or not."""
    only = Path(sources[0])
    if len(sources) == 1 and not only.is_dir() and (only.exists() or not set(str(only)) & set("*?[")):
        return [only]
    return sweep_paths([str(source) for source in sources])


def read_files(paths: Sequence[Path], how: SweepFiles) -> SweepsRead:
    """The sweeps, read as those that the correction is checked on."""
    if len(paths) > 1:
        return how.read(paths, spins=True)
    return SweepsRead(in_motion([how.recording(paths[0])]))


@dataclass(frozen=True, eq=False)
class Sound:
    """The sweeps of files, each as it was read and without the faults of its words; and the files left out."""

    decoded: tuple[Decoded, ...]
    read: SweepsRead

    @classmethod
    def of(cls, read: SweepsRead, effects: Sequence[Effect]) -> Sound:
        """What the words of sweeps tell."""
        return cls(tuple(decoded(sweep, effects) for sweep in read.sweeps), read)

    def lines(self, *, corrects: bool) -> list[str]:
        """What is said of readings that can be told back: those that a correction is made of are, others are not."""
        became = f"are {'told back to make the correction, and ' * corrects}judged as they are read"
        return [line for one in self.decoded for line in one.lines_saying(became)]

    @property
    def _without_reference(self) -> list[tuple[str, EstimatedMotion]]:
        """Names and motions of the logs that have none."""
        return [(one.name, one.estimated) for one in self.read.sweeps if one.estimated is not None]

    def motion_lines(self) -> list[str]:
        """What has to be kept in mind of those without a reference."""
        return [f"{name}: {judged_words(motion)}" for name, motion in self._without_reference]

    def aside_lines(self) -> list[str]:
        """Which logs without a reference hold rows that tell of no even turning."""
        return [
            f"{name}: {motion.rows_aside} rows without an even turning are left out"
            for name, motion in self._without_reference
            if motion.rows_aside
        ]

    def rejected_lines(self) -> list[str]:
        """Which sweeps hold rows that could not be used, or whose word says nothing of the angle."""
        counts = [(one.sweep.name, counts_of(one.usable, ())) for one in self.decoded if one.usable.rejected]
        return [f"{name}: {told['rows']} readings; {rejected_words(told)}" for name, told in counts]


def lines_of(given: Sound, checked: Sound) -> list[str]:
    """What is said of the sweeps that a correction is made of, and of those that it is tried on."""
    said = [*given.lines(corrects=True), *checked.lines(corrects=False), *checked.rejected_lines()]
    said += [*given.aside_lines(), *checked.aside_lines(), *checked.motion_lines()]
    return [*said, *given.read.lines, *checked.read.lines]
