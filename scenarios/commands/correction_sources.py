"""What a correction is made of, as it is named on the command line: one twin, or the sweeps of one sensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from diagnosis.report.row_counts import counts_of, rejected_words
from scenarios.commands.inputs import SweepFiles, SweepsRead, sweep_paths
from twin.decoded import decoded
from twin.effect import Effect
from twin.errors import UserError
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
    return SweepsRead((how.read_one(paths[0]),)) if len(paths) == 1 else how.read(paths)


def sound(read: SweepsRead, effects: Sequence[Effect]) -> tuple[SweepsRead, list[str]]:
    """The sweeps without the faults of their words, and what is said of readings that were told back."""
    each = [decoded(sweep, effects) for sweep in read.sweeps]
    return replace(read, sweeps=tuple(one.usable for one in each)), [line for one in each for line in one.lines]


def rejected_lines(others: SweepsRead) -> list[str]:
    """Which sweeps of ``--check`` hold rows that could not be used."""
    counts = [(one.name, counts_of(one, ())) for one in others.sweeps if one.rejected]
    return [f"{name}: {told['rows']} readings; {rejected_words(told)}" for name, told in counts]
