"""``halltwin explain``: what the simulation gets wrong about a measured sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from diagnosis import Explanation, explain
from diagnosis.report.console import show
from diagnosis.report.page import page
from scenarios.commands.fail_on import EXPLAIN, asked, in_explanation, raise_found
from scenarios.commands.interrupt import INTERRUPTED
from scenarios.commands.known import Known
from scenarios.commands.outputs import HTML, JSON, PICTURE, TOML, OutputFiles, json_text
from scenarios.commands.progress import progress_line
from twin.bounded_input import LARGEST_SWEEP_BYTES
from twin.catalogue import unnamed
from twin.effect import Effect
from twin.extensions import effects_with
from twin.files import twin_text
from twin.presets import read_twin_or_preset
from twin.sweep import Sweep


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """What to write; None where not asked for. ``force``: also in place of files of others."""

    json: Path | None = None
    report: Path | None = None
    extended: Path | None = None
    plot: Path | None = None
    force: bool = False


def run(
    path: Path,
    *,
    known: Known,
    outputs: Outputs,
    effect_files: Sequence[Path] = (),
    seed: int,
    fail_on: Sequence[str] = (),
    command: str | None = None,
    max_bytes: int = LARGEST_SWEEP_BYTES,
) -> None:
    """The command: print the answer, write what was asked for. Raises UserError before anything is written."""
    effects = effects_with(effect_files)
    words = _asked(fail_on, effects)
    files = OutputFiles.checked(
        [(outputs.json, JSON), (outputs.report, HTML), (outputs.extended, TOML), (outputs.plot, PICTURE)],
        inputs=[path, known.twin, *effect_files],
        force=outputs.force,
    )
    # Before a long recording is read: a name that is none needs no waiting for.
    held = None if known.twin is None else read_twin_or_preset(known.twin, effects=effects)
    given = {"twin": held, "mounting": known.mounting(), "effects": effect_files}
    found = _explained(Sweep.read(path, max_bytes=max_bytes), **given, seed=seed)
    found = replace(found, made=replace(found.made, command=command))
    answer = found.to_dict()
    try:
        show(answer)
    finally:
        # Whatever becomes of what is printed: the search took minutes.
        files.write(
            {
                outputs.json: lambda: json_text(answer),
                outputs.report: lambda: page(found.discovery, answer),
                outputs.extended: lambda: twin_text(found.extended),
                outputs.plot: found.plot,
            }
        )
    files.tell_written()
    if answer["cut_short"] is not None:
        raise SystemExit(INTERRUPTED)
    raise_found(words, in_explanation(answer))


def _asked(given: Sequence[str], effects: Sequence[Effect]) -> tuple[str, ...]:
    """What is to be failed on: kinds of findings, and causes by name, one's own among them."""
    causes = [effect.name for effect in effects if not effect.baseline and not unnamed(effect.name)]
    return asked(given, (*EXPLAIN, *causes))


def _explained(sweep: Sweep, **given: Any) -> Explanation:
    """The answer, with a line that says where the search stands; Ctrl-C gives the answer so far, twice none."""
    with progress_line("Ctrl-C: the answer so far") as listener:
        return explain(sweep, **given, progress=listener, on_interrupt="answer")
