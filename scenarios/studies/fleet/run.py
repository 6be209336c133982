"""``halltwin fleet``: many devices, one file each; what they have in common, which stand apart, and since when."""

from __future__ import annotations

import hashlib
import json as json_module
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.population.batch import Batch
from diagnosis.population.device import Question
from diagnosis.population.looks import looked_at
from diagnosis.population.template import LOOKED_AT, Template, template_of
from diagnosis.report.provenance import Provenance
from scenarios.commands.fail_on import FoundError, asked, raise_found
from scenarios.commands.inputs import SweepFiles, none_usable, tell_how_read
from scenarios.commands.outputs import HTML, JSON, PARQUET, OutputFiles, json_text
from scenarios.studies.engine import run_study
from scenarios.studies.fleet.answer import FLEET, answer_of, in_answer
from scenarios.studies.fleet.job import (
    ANSWERS,
    EXPLAINED_FROM,
    MOST_DEVICES,
    Fleet,
    Found,
    Reading,
    answer_name,
)
from scenarios.studies.fleet.order import GIVEN, NAME, check_order, in_order, places_by
from scenarios.studies.fleet.result import Result
from scenarios.studies.identity import Identity
from scenarios.studies.machines import Machines
from scenarios.studies.study_folder import StudyFolder
from twin.catalogue import CATALOGUE
from twin.errors import UserError
from twin.shown_name import distinct_names
from twin.sweep import Sweep

APART, ALL, NONE = "apart", "all", "none"
_HEADER = 8
"""Characters of a digest that are shown where two batches differ."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What is asked: the order of production, which devices are explained in full, how outputs count, the seed."""

    order: str = NAME
    explained: str = APART
    output_sense: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        check_order(self.order)
        if self.explained not in (APART, ALL, NONE):
            raise UserError(f"--explain {self.explained}: expected {APART}, {ALL} or {NONE}")
        if self.output_sense not in (None, 1, -1):
            raise UserError(f"--output-sense is {self.output_sense}; expected 1 or -1")


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """What to write; None where not asked for. ``force``: also in place of files of others."""

    json: Path | None = None
    report: Path | None = None
    table: Path | None = None
    force: bool = False


def run(
    given: SweepFiles,
    folder: Path,
    *,
    what: Asked,
    outputs: Outputs,
    machines: Machines,
    fail_on: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """The command: look at every device, print what the batch shows, write what was asked for. Raises UserError."""
    from scenarios.studies.fleet.table import show

    words = asked(fail_on, (*FLEET, *(effect.name for effect in CATALOGUE if not effect.baseline)))
    made = Provenance.today(seed=what.seed, command=command)
    paths = in_order(given.paths(), what.order)
    if not 2 <= len(paths) <= MOST_DEVICES:
        count = f"{len(paths)} file{'s' * (len(paths) != 1)}"
        raise UserError(f"found {count}; expected 2 to {MOST_DEVICES:,}, one for each device")
    files = OutputFiles.checked(
        [(outputs.json, JSON), (outputs.report, HTML), (outputs.table, PARQUET)], inputs=paths, force=outputs.force
    )
    check_parquet(outputs.table)
    found = fleet(given, paths, folder, what=what, machines=machines)
    answer = {**answer_of(found, what.order), **made.to_dict()}
    try:
        show(answer)
    finally:
        files.write(
            {
                outputs.json: lambda: json_text(answer),
                outputs.report: lambda: _page(found, answer),
                outputs.table: lambda: _parquet(found),
            }
        )
    files.tell_written()
    raise_found(words, in_answer(answer))
    unusable = answer["devices"]["unusable"]
    if unusable:
        raise FoundError(f"{len(unusable)} of {len(paths)} files could not be used: {_some(unusable)}")


def fleet(given: SweepFiles, paths: Sequence[Path], output: Path, *, what: Asked, machines: Machines) -> Result:
    """The study itself, or the rest of one that was begun."""
    names = distinct_names(paths)
    identity = Identity(
        study="fleet",
        seed=what.seed,
        settings={
            "files": len(paths),
            "content": digest_of(paths),
            "order": what.order,
            "columns": given.columns or "",
            "pole_pairs": given.pole_pairs or 0,
            "output_sense": what.output_sense or 0,
        },
        options={
            "files": "the number of files",
            "content": "the files' content",
            "order": "--order",
            "columns": "--columns",
            "pole_pairs": "--pole-pairs",
            "output_sense": "--output-sense",
        },
    )
    asked = Reading(max_bytes=given.max_bytes, columns=given.columns, pole_pairs=given.pole_pairs, guess=True)
    first = first_usable(paths, names, asked)
    reading = asked.of(first)
    tell_how_read(first, given.columns)
    template = template_of(first, told_sense=what.output_sense, seed=what.seed)
    with StudyFolder.opened(output, identity) as folder:
        job = Fleet(
            paths=tuple(str(path.absolute()) for path in paths),
            names=tuple(names),
            reading=reading,
            question=template.question,
            order=what.order if what.order not in (NAME, GIVEN) else "",
            seed=what.seed,
        )
        found = looks(job, folder, template, machines)
        chosen = _to_explain(found, what.explained)
        numbers = [EXPLAINED_FROM + device for device in chosen]
        run_study(job, folder, chunks=numbers, items=len(numbers), unit="explanations", machines=machines)
        answers = {device: _answer(folder.path / ANSWERS / answer_name(device)) for device in chosen}
        return replace(found, explained=answers)


def looks(job: Fleet, folder: StudyFolder, template: Template, machines: Machines) -> Result:
    """Look at all devices until the batch shows no further cause."""
    reasons: dict[str, str] = {}

    def look(number: int, question: Question) -> Batch:
        asked_now = replace(job, question=question, look=number)
        run_study(asked_now, folder, chunks=asked_now.chunks, items=len(job.paths), unit="devices", machines=machines)
        batch, why = batch_of(asked_now, folder.load(asked_now.chunks, ("reason", "digest", "ordered_by")))
        reasons.update({name: str(reason) for name, reason in zip(batch.names, why, strict=True) if reason})
        return batch

    found = looked_at(template, look)
    return Result(
        population=found.population,
        template=template,
        names=found.batch.names,
        devices=tuple(int(device) for device in found.batch.arrays["device"]),
        reasons=reasons,
        looks=found.looks,
        ended=found.ended,
    )


def batch_of(job: Fleet, rows: Found) -> tuple[Batch, np.ndarray[Any, Any]]:
    """The devices in the order of production, and why each cannot be used; empty where it can."""
    reasons = rows["reason"].astype(object)
    first: dict[str, str] = {}
    for device, content in enumerate(rows["digest"]):
        if content and content in first:
            reasons[device] = f"holds the same readings as {first[content]}; each device counts once"
        elif content:
            first[content] = job.names[device]
            if not np.isfinite(rows["fitted"][device]).all():
                count = f"{rows['rows'][device]:.0f} readings"
                reasons[device] = f"{count} do not tell all of its parameters; take more, all round the turn"
    figures: dict[str, Any] = {n: v for n, v in rows.items() if n not in ("reason", "digest", "ordered_by")}
    figures["device"] = np.arange(len(job.names))
    figures["fitted"] = np.where((reasons == "")[:, None], rows["fitted"], np.nan)
    order = places_by(rows["ordered_by"]) if job.order else np.arange(len(job.names))
    names = tuple(job.names[device] for device in order)
    return Batch(names, job.question, {name: values[order] for name, values in figures.items()}), reasons[order]


def first_usable(paths: Sequence[Path], names: Sequence[str], reading: Reading) -> list[Sweep]:
    """The first devices that can be read. Raises SweepError where none can."""
    sweeps: list[Sweep] = []
    first: UserError | None = None
    for path, name in zip(paths, names, strict=True):
        try:
            sweeps.append(reading.sweep(str(path), name))
        except UserError as error:
            first = first or error
        if len(sweeps) == LOOKED_AT:
            break
    if first is not None and not sweeps:
        raise none_usable(first, len(paths))
    return sweeps


def digest_of(paths: Sequence[Path]) -> str:
    """One digest of the names and contents of all files, so that a study is not gone on with on others."""
    whole = hashlib.sha256()
    for path in paths:
        whole.update(path.name.encode(errors="surrogateescape") + b"\0")
        try:
            with open(path, "rb") as file:
                whole.update(hashlib.file_digest(file, "sha256").digest())
        except OSError as error:
            whole.update(str(error.errno).encode())
    return whole.hexdigest()[: 2 * _HEADER]


def check_parquet(table: Path | None) -> None:
    """Refuse a table that cannot be written, before the work. Raises UserError."""
    if table is None:
        return
    try:
        import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: F401
    except ImportError:
        needs = "needs pyarrow; pip install '.[formats]' in the checkout, or leave --table out"
        raise UserError(f"{table}: {needs}") from None


def _to_explain(found: Result, which: str) -> list[int]:
    """Numbers of the files that are explained in full."""
    batch = found.population.batch
    if which == NONE:
        return []
    places = range(len(batch)) if which == ALL else [one.device for one in found.population.apart]
    return [int(batch.arrays["device"][place]) for place in places]


def _answer(path: Path) -> dict[str, Any]:
    return dict(json_module.loads(path.read_text(encoding="utf-8")))


def _some(unusable: Sequence[Mapping[str, str]]) -> str:
    return ", ".join(one["file"] for one in unusable[:3]) + (", ..." if len(unusable) > 3 else "")


def _page(found: Result, answer: Mapping[str, Any]) -> str:
    from scenarios.studies.fleet.page import page

    return page(found, answer)


def _parquet(found: Result) -> bytes:
    from scenarios.studies.fleet.devices import parquet

    return parquet(found)
