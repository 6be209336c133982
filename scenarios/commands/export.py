"""halltwin export: a correction as the table that a drive or sensor loads, judged on readings it never saw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from diagnosis.report.provenance import Provenance
from scenarios.commands.compensate_judge import Judged, rows_of, say_where_worse
from scenarios.commands.compensate_source import readings_of
from scenarios.commands.compensate_text import made_of
from scenarios.commands.correction_sources import Sound, files_of, is_one_twin, lines_of, read_files
from scenarios.commands.export_made import TOLERANCE_DEG, Asked, Source, exported
from scenarios.commands.export_text import about, show, to_dict
from scenarios.commands.fail_on import EXPORT, asked
from scenarios.commands.inputs import SweepFiles, SweepsRead, check_panels
from scenarios.commands.outputs import JSON, PICTURE, OutputFiles, drive_table, json_text
from twin.chain import Chain
from twin.decoded import Decoded
from twin.effect import Effect
from twin.extensions import effects_with
from twin.presets import read_twin_or_preset
from twin.shown_name import shown_name

_NONE = SweepFiles()


@dataclass(frozen=True)
class Outputs:
    """What to write; None where not asked for. ``force``: also in place of files of others."""

    table: Path | None = None
    json: Path | None = None
    plot: Path | None = None
    force: bool = False


def run(
    sources: Sequence[str | Path],
    *,
    wish: Asked,
    outputs: Outputs,
    check: SweepFiles = _NONE,
    effect_files: Sequence[Path] = (),
    seed: int = 0,
    fail_on: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """Make the table of a twin or of sweeps, judge it, and write it.

    Raises FoundError, after all is written, where the table makes the error larger on a sweep of ``check``.
    """
    words = asked(fail_on, EXPORT)
    effects = effects_with(effect_files)
    of_a_twin = is_one_twin(sources)
    checked_on, paths = check.paths(), [Path(sources[0])] if of_a_twin else files_of(sources)
    given_files = [(outputs.table, drive_table(wish.target.ending)), (outputs.json, JSON), (outputs.plot, PICTURE)]
    inputs = [*paths, *checked_on, *effect_files]
    files = OutputFiles.checked(given_files, inputs=inputs, force=outputs.force)
    others = check.read_each(checked_on)
    check_panels(outputs.plot, len(others.sweeps) if checked_on else 1)
    given = SweepsRead(()) if of_a_twin else read_files(paths, check)
    words_of, checked = (Sound.of(one, effects) for one in (given, others))
    source = _source(sources, words_of.decoded, paths, effects=effects, temperature_c=wish.temperature_c, seed=seed)
    made = exported(wish, source, checked.decoded, seed=seed)
    provenance = Provenance.today(seed=seed, command=command)
    rows = rows_of(made.judged, other=bool(checked_on))
    try:
        show(made, made_of(source.readings, source.name, TOLERANCE_DEG), [(one.name, one.found) for one in rows])
        for line in lines_of(words_of, checked):
            print(line)
    finally:
        # Whatever becomes of what is printed.
        files.write(
            {
                outputs.table: lambda: made.table.text(about(made, provenance), wish.name),
                outputs.json: lambda: json_text(to_dict(made, provenance)),
                outputs.plot: lambda: _picture(made.judged),
            }
        )
    files.tell_written({} if outputs.table is None else {outputs.table: f"{len(made.table)} entries"})
    say_where_worse(made.judged, fails=bool(checked_on or words))
    SweepsRead((*given.sweeps, *others.sweeps), (*given.unusable, *others.unusable)).raise_unusable()


def _source(
    sources: Sequence[str | Path],
    given: Sequence[Decoded],
    paths: Sequence[Path],
    *,
    effects: tuple[Effect, ...],
    temperature_c: float,
    seed: int,
) -> Source:
    """What the table is made of."""
    name = shown_name(paths[0]) if len(paths) == 1 else f"{len(given)} sweeps"
    if not given:
        return Source(name, None, read_twin_or_preset(sources[0], effects=effects), temperature_c)
    readings = readings_of(given, tolerance_deg=TOLERANCE_DEG, seed=seed)
    return Source(name, readings, Chain(effects=effects), temperature_c)


def _picture(judged: Sequence[Judged]) -> Any:
    from scenarios.commands.compensate_plot import before_after_figure

    return before_after_figure([one for one in judged if not one.part])
