"""What the engine runs for a fleet: a look at every device, again for each cause that the batch shows; explanations.

Chunks are numbered through: those of the first look, those of the second, which knows the causes found by the first,
and so on; then one for each device that is explained in full.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.population.device import Question, blank, estimates
from scenarios.commands.outputs import json_text
from scenarios.studies.study_folder import StudyFolder, part_of
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.errors import SweepError, UserError
from twin.sweep import Sweep
from twin.whole_file import write_whole

MOST_DEVICES = 200_000
"""As many as the numbers of chunks have room for."""
EXPLAINED_FROM = 700_000
"""Number of the chunk that explains the first device."""
ANSWERS = "answers"
_CHUNKS, _LARGEST_CHUNK = 64, 50
"""A small batch is divided so that a few workers have work, a large one so that little is lost when it is stopped."""
_LONGEST_REASON = 400

Found = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How files are read: see :class:`scenarios.commands.inputs.SweepFiles`."""

    max_bytes: int = LARGEST_SWEEP_BYTES
    columns: str | None = None
    pole_pairs: int | None = None
    guess: bool = False

    def sweep(self, path: str, name: str) -> Sweep:
        """One device's sweep, by the reader of ``explain``. Raises SweepError."""
        return Sweep.read(
            path,
            max_bytes=self.max_bytes,
            name=name,
            columns=self.columns,
            pole_pairs=self.pole_pairs,
            guess=self.guess,
        )

    def of(self, devices: Sequence[Sweep]) -> Reading:
        """How all are read, where the first ``devices`` were read so. Raises SweepError where these differ."""
        ways = {sweep.read_as.text if sweep.read_as else "": sweep.name for sweep in devices}
        if len(ways) > 1:
            one, other = list(ways.items())[:2]
            raise SweepError(
                f"{one[1]} and {other[1]}: their columns are guessed to be {one[0] or 'a sweep'!r} and "
                f"{other[0] or 'a sweep'!r}; devices of a batch are read alike: say how by --columns, or part the files"
            )
        return replace(self, columns=next(iter(ways)) or self.columns, guess=False)


@dataclass(frozen=True, kw_only=True)
class Fleet:
    """The engine's job: files in the order of their devices, each with the name that messages call it by."""

    paths: tuple[str, ...]
    names: tuple[str, ...]
    reading: Reading
    question: Question
    look: int = 0
    order: str = ""
    seed: int = 0

    @property
    def each(self) -> int:
        """Devices in a chunk."""
        return min(max(ceil(len(self.paths) / _CHUNKS), 1), _LARGEST_CHUNK)

    @property
    def chunks(self) -> range:
        """Numbers of the chunks of this look."""
        count = ceil(len(self.paths) / self.each)
        return range(self.look * count, (self.look + 1) * count)

    def write(self, folder: StudyFolder, chunk: int) -> Sequence[Path]:
        """See :class:`scenarios.studies.job.Job`."""
        if chunk >= EXPLAINED_FROM:
            return self._explained(folder, chunk)
        start = (chunk - self.chunks.start) * self.each
        return folder.save(chunk, self.looked_at(range(start, min(start + self.each, len(self.paths))), chunk))

    def looked_at(self, devices: range, chunk: int) -> Found:
        """The figures of some devices, and of those that cannot be used the reason."""
        reasons, digests, ordered = [""] * len(devices), [""] * len(devices), np.full(len(devices), np.nan)
        sweeps: dict[int, Sweep] = {}
        for place, device in enumerate(devices):
            try:
                sweep = self.reading.sweep(self.paths[device], self.names[device])
            except UserError as error:
                reasons[place] = _reason(str(error), self.paths[device], self.names[device])
                continue
            sweeps[place] = sweep
            digests[place] = hashlib.sha256(sweep.reference_deg.tobytes() + sweep.measured_deg.tobytes()).hexdigest()
            column = sweep.columns.get(self.order)
            ordered[place] = np.nan if column is None else column[0]
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(chunk,)))
        found = {name: np.repeat(value[None], len(devices), axis=0) for name, value in blank(self.question).items()}
        if sweeps:
            places = list(sweeps)
            for name, values in estimates([sweeps[place] for place in places], self.question, rng=rng).items():
                found[name][places] = values
        return {
            **found,
            "reason": np.array(reasons, dtype=f"<U{_LONGEST_REASON}"),
            "digest": np.array(digests, dtype="<U64"),
            "ordered_by": ordered,
        }

    def _explained(self, folder: StudyFolder, chunk: int) -> Sequence[Path]:
        """The whole answer of ``explain`` for one device, as a file."""
        device = chunk - EXPLAINED_FROM
        with folder.workspace() as beside:
            (beside / ANSWERS).mkdir()
            write_whole(beside / ANSWERS / answer_name(device), json_text(self.explained(device)).encode())
            return folder.place(part_of(chunk), beside)

    def explained(self, device: int) -> dict[str, Any]:
        """What ``explain`` answers for a device; its day and command are those of the whole."""
        from diagnosis import explain

        path, name = self.paths[device], self.names[device]
        try:
            sweep = self.reading.sweep(path, name)
            answer = explain(sweep, pole_pairs=self.reading.pole_pairs, seed=self.seed).to_dict()
        except UserError as error:
            return {"file": name, "reason": _reason(str(error), path, name)}
        return {"file": name, **{key: value for key, value in answer.items() if key not in ("date", "command")}}


def answer_name(device: int) -> str:
    """The file that holds the answer of a device, by its number from 0."""
    return f"{device + 1:06d}.json"


def _reason(said: str, path: str, name: str) -> str:
    return said.removeprefix(f"{path}: ").removeprefix(f"{name}: ")[:_LONGEST_REASON]
