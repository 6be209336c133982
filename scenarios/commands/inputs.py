"""Sweep files as people name them: single files, globs, folders; of several, those that can be used."""

from __future__ import annotations

import glob
import hashlib
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

from scenarios.commands.fail_on import FoundError
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.ending import ending_of
from twin.errors import SweepError, UserError
from twin.logs.asked_back import in_words
from twin.logs.guess import Guess
from twin.recording_file import read_recording
from twin.shown_name import distinct_names
from twin.spin import Spin
from twin.sweep import Sweep

ENDINGS = (".csv", ".csv.gz", ".parquet")


def sweep_paths(names: Sequence[str]) -> list[Path]:
    """The files that names stand for, in the order given; those of a folder or glob by name.

    Raises UserError for a name that stands for nothing.
    """
    found: list[Path] = []
    for name in names:
        path = Path(name)
        if path.is_dir():
            inside = sorted(item for item in path.iterdir() if ending_of(item) in ENDINGS)
            if not inside:
                raise UserError(f"{name}: no sweep in this folder; expected files ending in {', '.join(ENDINGS)}")
            found += inside
        elif path.exists():
            found.append(path)
        else:
            matched = sorted(Path(item) for item in glob.glob(name, recursive=True))
            if not matched:
                raise UserError(f"{name}: no such file, folder or pattern with a match")
            found += matched
    return found


def check_panels(picture: Path | None, sweeps: int) -> None:
    """Refuse a picture of no sweep, or of more than can be told apart, before any work is done. Raises UserError."""
    from diagnosis.report.diagnose_plot import MOST_PANELS

    if picture is None or 1 <= sweeps <= MOST_PANELS:
        return
    if sweeps == 0:
        raise UserError(f"{picture.name}: nothing to draw; give sweeps to --check the twin's correction on")
    raise UserError(f"{picture.name}: {sweeps} sweeps do not fit in one picture; draw at most {MOST_PANELS}")


@dataclass(frozen=True)
class Unusable:
    """A file that is no sweep, and why not."""

    file: str
    reason: str


_PATTERN = frozenset("*?[")
"""Characters that make a name a pattern."""
_NAMED = 3
"""Files that the last line names; what is printed before it lists all, with the reasons."""


@dataclass(frozen=True, eq=False)
class SweepsRead:
    """The sweeps of several files in their order, and the files that were left out."""

    sweeps: tuple[Sweep, ...]
    unusable: tuple[Unusable, ...] = ()

    @property
    def lines(self) -> list[str]:
        """Which files hold the same, and which were left out, as a person reads it."""
        alike = [f"the same readings, not several measurements: {', '.join(names)}" for names in the_same(self.sweeps)]
        return [*alike, *(f"not used: {one.file}: {one.reason}" for one in self.unusable)]

    def listed(self) -> list[dict[str, str]]:
        """The files that were left out, for the JSON."""
        return [{"file": one.file, "reason": one.reason} for one in self.unusable]

    def raise_unusable(self) -> None:
        """Raise FoundError where a file was left out: the command has answered without it."""
        if self.unusable:
            count = len(self.unusable)
            names = ", ".join(one.file for one in self.unusable[:_NAMED]) + (", ..." if count > _NAMED else "")
            raise FoundError(f"{count} of {count + len(self.sweeps)} files could not be used: {names}")


def the_same(sweeps: Sequence[Sweep | Spin]) -> list[list[str]]:
    """Names of sweeps that hold the very same readings, group by group."""
    groups: dict[bytes, list[str]] = {}
    for sweep in sweeps:
        beside = sweep.reference_deg if isinstance(sweep, Sweep) else sweep.time_s
        key = hashlib.sha256((b"" if beside is None else beside.tobytes()) + sweep.measured_deg.tobytes()).digest()
        groups.setdefault(key, []).append(sweep.name)
    return [names for names in groups.values() if len(names) > 1]


@dataclass(frozen=True)
class SweepFiles:
    """Sweeps as they are named on the command line, and how each is read.

    ``max_bytes``: how many bytes it may hold after decompression; ``columns``: what becomes of the columns of a log;
    ``pole_pairs``: how often the field at the sensor turns in a turn of the shaft.
    """

    names: Sequence[str] = ()
    max_bytes: int = LARGEST_SWEEP_BYTES
    columns: str | None = None
    pole_pairs: int | None = None

    def paths(self) -> list[Path]:
        """See :func:`sweep_paths`."""
        return sweep_paths(self.names)

    @property
    def one(self) -> Path | None:
        """The file, where a single one is named; None where there may be several."""
        path = Path(self.names[0])
        if len(self.names) > 1 or path.is_dir() or (_PATTERN & set(self.names[0]) and not path.exists()):
            return None
        return path

    def read(self, paths: Sequence[Path], *, spins: bool = False) -> SweepsRead:
        """See :func:`read_sweeps`."""
        return read_sweeps(paths, max_bytes=self.max_bytes, columns=self.columns, spins=spins)

    def read_each(self, paths: Sequence[Path]) -> SweepsRead:
        """The same of sweeps that need not be of one device: a log without a reference has a motion of its own."""
        return read_sweeps(paths, max_bytes=self.max_bytes, columns=self.columns, spins=True, together=False)

    def read_one(self, path: Path, *, name: str | None = None) -> Sweep:
        """One of the files, under the name that messages call it by. Raises SweepError."""
        found = Sweep.read(path, name=name, pole_pairs=self.pole_pairs, **self._reading())
        tell_how_read([found], self.columns)
        return found

    def recording(self, path: Path, *, name: str | None = None) -> Sweep | Spin:
        """The same; one without a reference as the spin that it is."""
        found = read_recording(path, name=name, pole_pairs=self.pole_pairs, **self._reading())
        tell_how_read([found], self.columns)
        return found

    def _reading(self) -> _Reading:
        return {"max_bytes": self.max_bytes, "columns": self.columns, "guess": True}


class _Reading(TypedDict):
    """How a file is read, whatever it holds."""

    max_bytes: int
    columns: str | None
    guess: bool


def tell_how_read(recordings: Sequence[Sweep | Spin], stated: str | None) -> None:
    """Print on stderr by which guess logs were read, those that were read alike in one line; none if it was stated."""
    names: dict[Guess, list[str]] = {}
    for recording in recordings if stated is None else ():
        if recording.read_as is not None:
            names.setdefault(recording.read_as, []).append(recording.name)
    for guess, files in names.items():
        said = [
            f"read as {in_words([guess.text])}",
            *(f"taken for granted: {note}" for note in guess.notes),
            *([f"not used: {', '.join(guess.unused)}"] if guess.unused else []),
        ]
        more = f" and {len(files) - _NAMED} more" if len(files) > _NAMED else ""
        print(f"{', '.join(files[:_NAMED])}{more}: {'; '.join(said)}", file=sys.stderr)


def none_usable(first: UserError, files: int) -> SweepError:
    """The error that ends a command of so many files where none can be used: why the first cannot."""
    more = f" (and none of the other {files - 1} files can be used)" if files > 1 else ""
    return SweepError(f"{first}{more}")


def read_sweeps(
    paths: Sequence[Path],
    *,
    max_bytes: int = LARGEST_SWEEP_BYTES,
    columns: str | None = None,
    spins: bool = False,
    together: bool = True,
) -> SweepsRead:
    """Read these files; one that is no sweep is left out and listed. Raises SweepError where none can be used.

    ``spins``: logs without a reference will do, with the motion that is estimated from all of them ``together``, as
    logs of one device, or from each by itself.
    """
    sweeps: list[Sweep | Spin] = []
    unusable = []
    read = read_recording if spins else Sweep.read
    first: SweepError | None = None
    for path, name in zip(paths, distinct_names(paths), strict=True):
        try:
            sweeps.append(read(path, max_bytes=max_bytes, name=name, columns=columns, guess=True))
        except SweepError as error:
            first = first or error
            unusable.append(Unusable(name, str(error).removeprefix(f"{path}: ").removeprefix(f"{name}: ")))
    if first is not None and not sweeps:
        raise none_usable(first, len(paths))
    tell_how_read(sweeps, columns)
    groups = [sweeps] if together else [[sweep] for sweep in sweeps]
    return SweepsRead(tuple(one for group in groups for one in in_motion(group)), tuple(unusable))


def in_motion(recordings: Sequence[Sweep | Spin]) -> tuple[Sweep, ...]:
    """Those without a reference with the motion estimated from all of them; a line says so meanwhile."""
    with_reference = [one for one in recordings if isinstance(one, Sweep)]
    if len(with_reference) == len(recordings):
        return tuple(with_reference)
    from diagnosis.blas_threads import one_blas_thread
    from diagnosis.progress import Progress
    from diagnosis.spin.of_log import with_motion
    from scenarios.commands.progress import progress_line

    with progress_line() as hear, one_blas_thread():
        return tuple(with_motion(recordings, begins=lambda stage: hear(Progress(stage, 0.0))))
