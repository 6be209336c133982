"""``halltwin explain``: what the simulation gets wrong about a measured sweep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from diagnosis import Explanation, explain
from diagnosis.report.console import show
from diagnosis.report.page import page
from diagnosis.setup.checks import KINDS
from scenarios.commands.fail_on import DOCTOR, EXPLAIN, asked, in_explanation, raise_found
from scenarios.commands.inputs import SweepFiles, the_same
from scenarios.commands.interrupt import INTERRUPTED
from scenarios.commands.known import Known
from scenarios.commands.outputs import HTML, JSON, PICTURE, TOML, OutputFiles, json_text
from scenarios.commands.progress import progress_line
from twin.catalogue import unnamed
from twin.effect import Effect
from twin.errors import UserError
from twin.extensions import effects_with
from twin.files import twin_text
from twin.presets import read_twin_or_preset
from twin.shown_name import distinct_names
from twin.spin import Spin
from twin.sweep import Sweep

EACH = "halltwin.explain_each/1"
"""Schema of the JSON of several sweeps one by one."""


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """What to write; None where not asked for. ``force``: also in place of files of others."""

    json: Path | None = None
    report: Path | None = None
    extended: Path | None = None
    plot: Path | None = None
    force: bool = False


@dataclass(frozen=True, kw_only=True)
class Search:
    """How it is searched: effects of one's own, the computing time for each recording, the seed."""

    effect_files: Sequence[Path] = ()
    budget_s: float
    seed: int

    def __post_init__(self) -> None:
        if not self.budget_s > 0.0:
            raise UserError(f"--budget is {self.budget_s:g}; expected seconds of computing above 0, or inf for no end")


def run(
    sweeps: SweepFiles,
    *,
    each: bool = False,
    known: Known,
    outputs: Outputs,
    search: Search,
    fail_on: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """The command: print the answer, write what was asked for. Raises UserError before anything is written."""
    effects = effects_with(search.effect_files)
    words = _asked(fail_on, effects)
    paths = sweeps.paths() if sweeps.one is None else [sweeps.one]
    one_by_one = each and len(paths) > 1
    if one_by_one:
        _check_one_by_one(outputs, known)
    files = OutputFiles.checked(
        [(outputs.json, JSON), (outputs.report, HTML), (outputs.extended, TOML), (outputs.plot, PICTURE)],
        inputs=[*paths, known.twin, *search.effect_files],
        force=outputs.force,
    )
    # Before a long recording is read: a name that is none needs no waiting for.
    held = None if known.twin is None else read_twin_or_preset(known.twin, effects=effects)
    given: dict[str, Any] = {"twin": held, "mounting": known.mounting(), "pole_pairs": sweeps.pole_pairs}
    given |= {"effects": search.effect_files, "seed": search.seed, "budget_s": search.budget_s}
    read = [sweeps.recording(p, name=name) for p, name in zip(paths, distinct_names(paths), strict=True)]
    if one_by_one:
        _one_by_one(read, given, files=files, json=outputs.json, command=command, words=words)
        return
    _check_different(read)
    found = _explained(read[0] if len(read) == 1 else read, **given)
    found = replace(found, made=replace(found.made, command=command))
    answer = found.to_dict()
    try:
        show(answer)
    finally:
        # Whatever becomes of what is printed: the search took minutes.
        files.write(contents_of(found, answer, outputs))
    files.tell_written()
    if _interrupted(answer):
        raise SystemExit(INTERRUPTED)
    raise_found(words, in_explanation(answer))


def contents_of(found: Explanation, answer: Mapping[str, Any], outputs: Outputs) -> dict[Path | None, Any]:
    """What each output holds; ``answer`` is that of ``found`` as plain values."""
    return {
        outputs.json: lambda: json_text(answer),
        outputs.report: lambda: page(found.discovery, answer),
        outputs.extended: lambda: twin_text(found.extended),
        outputs.plot: found.plot,
    }


def _check_one_by_one(outputs: Outputs, known: Known) -> None:
    """Refuse files that hold one answer where there are several. Raises UserError."""
    for path in (outputs.report, outputs.extended, outputs.plot):
        if path is not None:
            raise UserError(f"{path.name}: holds one sweep's answer; with --each give --json alone, or one sweep")
    if known.turned is not None:
        raise UserError("mounting: says how recordings that are explained together differ; leave it out with --each")


def _check_different(sweeps: Sequence[Sweep | Spin]) -> None:
    """Refuse the very same readings given twice: they would count as evidence twice. Raises UserError."""
    for names in the_same(sweeps):
        raise UserError(f"{', '.join(names)}: the same readings; expected several recordings: give each once")


def _one_by_one(
    sweeps: Sequence[Sweep | Spin],
    given: Mapping[str, Any],
    *,
    files: OutputFiles,
    json: Path | None,
    command: str | None,
    words: Sequence[str],
) -> None:
    """Explain each sweep by itself; the JSON holds all answers."""
    answers: list[dict[str, Any]] = []
    try:
        for sweep in sweeps:
            found = _explained(sweep, **given)
            answers.append(replace(found, made=replace(found.made, command=command)).to_dict())
            if len(answers) > 1:
                print()
            show(answers[-1])
            if _interrupted(answers[-1]):
                break
    finally:
        files.write({json: lambda: json_text({"schema": EACH, "answers": answers})})
    files.tell_written()
    if _interrupted(answers[-1]):
        raise SystemExit(INTERRUPTED)
    raise_found(words, {kind: count for answer in answers for kind, count in in_explanation(answer).items()})


def _interrupted(answer: Mapping[str, Any]) -> bool:
    """Whether a person has ended the search: one that ran out of its budget is an answer as asked for."""
    cut = answer["cut_short"]
    return cut is not None and cut["by"] == "interrupt"


def _asked(given: Sequence[str], effects: Sequence[Effect]) -> tuple[str, ...]:
    """What is to be failed on: kinds of findings, causes by name, one's own among them, and those of the set-up."""
    causes = [effect.name for effect in effects if not effect.baseline and not unnamed(effect.name)]
    return asked(given, (*EXPLAIN, *causes, *DOCTOR, *KINDS))


def _explained(sweep: Sweep | Spin | Sequence[Sweep | Spin], **given: Any) -> Explanation:
    """The answer, with a line that says where the search stands; Ctrl-C gives the answer so far, twice none."""
    with progress_line("Ctrl-C: the answer so far") as listener:
        return explain(sweep, **given, progress=listener, on_interrupt="answer")
