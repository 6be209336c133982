"""halltwin compensate: a continuous correction as C header, table or TOML, with its error on readings it never saw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from diagnosis.correction.compensation import Correction, correction_of, correction_over
from diagnosis.correction.compensation_c import check_prefix, header
from diagnosis.correction.correction_file import to_dict
from diagnosis.correction.left_of_readings import of_words_of
from diagnosis.report.motion import correction_words
from scenarios.commands.compensate_judge import Judged, held_out, on_others, rows_of, say_where_worse
from scenarios.commands.compensate_source import Readings, readings_of
from scenarios.commands.compensate_table import table, temperatures_c
from scenarios.commands.compensate_text import made_of, show
from scenarios.commands.correction_sources import Sound, files_of, is_one_twin, lines_of, read_files
from scenarios.commands.fail_on import COMPENSATE, asked
from scenarios.commands.inputs import SweepFiles, SweepsRead, check_panels
from scenarios.commands.intervals import interval
from scenarios.commands.left_words import left_words
from scenarios.commands.outputs import HEADER, PICTURE, TABLE, TOML, OutputFiles
from scenarios.commands.protocol import COLDEST_C, HOTTEST_C
from twin.catalogue import find
from twin.chain import Chain
from twin.decoded import Decoded
from twin.errors import UserError
from twin.extensions import effects_with
from twin.limits import require_within
from twin.presets import read_twin_or_preset
from twin.shown_name import shown_name

_FEWEST_POINTS = 4
_MOST_POINTS = 65536
_COARSEST_DEG = 10.0
_NONE = SweepFiles()
_AT = "25"
"""Temperature [C] that a twin is corrected for where none is given."""


@dataclass(frozen=True)
class Outputs:
    """What to write; None where not asked for. ``points`` is the length of the table.

    ``force``: also in place of files of others.
    """

    header: Path | None = None
    table: Path | None = None
    points: int = 64
    toml: Path | None = None
    plot: Path | None = None
    prefix: str = "halltwin"
    force: bool = False


def run(
    sources: Sequence[str | Path],
    *,
    outputs: Outputs,
    check: SweepFiles = _NONE,
    temperature: str | None = None,
    tolerance_deg: float = 1e-3,
    effect_files: Sequence[Path] = (),
    seed: int = 0,
    fail_on: Sequence[str] = (),
) -> None:
    """Correction of a twin or of sweeps; errors on the sweeps of ``check``, or on what is held out of those given.

    Raises FoundError, after all is written, where the correction makes the error larger on a sweep of ``check``.
    """
    words = asked(fail_on, COMPENSATE)
    _check_points_and_prefix(outputs)
    low_c, high_c = interval("temperature", _AT if temperature is None else temperature, example="-40:125")
    require_within("temperature", [low_c, high_c], COLDEST_C, HOTTEST_C, "C")
    require_within("tolerance", tolerance_deg, 0.0, _COARSEST_DEG, "deg")
    effects = effects_with(effect_files)
    of_twin = is_one_twin(sources)
    if temperature is not None and not of_twin:
        raise UserError(
            "--temperature is for a twin, and these are sweeps; leave it out: the correction follows the temperatures "
            "of their column temperature_c"
        )
    twin = read_twin_or_preset(sources[0], effects=effects) if of_twin else Chain(effects=effects)
    checked_on, paths = check.paths(), [Path(sources[0])] if of_twin else files_of(sources)
    files = _files(outputs, inputs=[*paths, *checked_on, *effect_files])
    others = check.read_each(checked_on)
    given = SweepsRead(()) if of_twin else read_files(paths, check)
    words_of, checked = (Sound.of(one, effects) for one in (given, others))
    check_panels(outputs.plot, len(others.sweeps) if checked_on or of_twin else 1)
    readings = None if of_twin else readings_of(words_of.decoded, tolerance_deg=tolerance_deg, seed=seed)
    correction = _of_twin(twin, low_c, high_c, tolerance_deg) if readings is None else readings.correction
    judged = _judge(correction, readings, checked.decoded)
    source = shown_name(paths[0]) if len(paths) == 1 else f"{len(given.sweeps)} sweeps"
    rows = rows_of(judged, other=bool(checked_on))
    shown = [one.without_zeros() for one in judged] if checked_on else judged
    try:
        show(made_of(readings, source, tolerance_deg), correction, [(one.name, one.found) for one in rows])
        for line in (*_left_of(checked), *lines_of(words_of, checked)):
            print(line)
    finally:
        # Whatever becomes of what is printed.
        _write(files, outputs, correction, source=source, judged=shown, readings=readings, tolerance_deg=tolerance_deg)
    _tell_written(files, outputs, correction, tolerance_deg)
    say_where_worse(judged, fails=bool(checked_on or words))
    SweepsRead((*given.sweeps, *others.sweeps), (*given.unusable, *others.unusable)).raise_unusable()


def _check_points_and_prefix(outputs: Outputs) -> None:
    """Refuse a table of too few or too many points, and a prefix of no C name. Raises UserError."""
    if not _FEWEST_POINTS <= outputs.points <= _MOST_POINTS:
        raise UserError(f"points is {outputs.points}; expected {_FEWEST_POINTS} to {_MOST_POINTS}")
    check_prefix(outputs.prefix)


def _of_twin(twin: Chain, low_c: float, high_c: float, tolerance_deg: float) -> Correction:
    """The correction of a twin at one temperature, or over a span; which effects follow it is said where it is one."""
    if high_c > low_c:
        return correction_over(lambda _: twin, low_c, high_c, tolerance_deg=tolerance_deg)
    following = [key for key in twin.values if "temperature_c" in find(key, twin.effects).needs]
    if following:
        print(f"{', '.join(following)}: corrected as at {low_c:g} C; --temperature low:high makes one that follows")
    return correction_of(twin, temperature_c=low_c, tolerance_deg=tolerance_deg)


def _files(outputs: Outputs, *, inputs: Sequence[Path]) -> OutputFiles:
    """The files to write. Raises UserError where one of them cannot or must not be written."""
    asked = [(outputs.header, HEADER), (outputs.table, TABLE), (outputs.toml, TOML), (outputs.plot, PICTURE)]
    return OutputFiles.checked(asked, inputs=inputs, force=outputs.force)


def _left_of(checked: Sound) -> list[str]:
    """What faults of words leave of the sweeps that the correction is tried on."""
    return [f"not removed: {left_words(one)}" for one in of_words_of(checked.decoded)]


def _judge(correction: Correction, readings: Readings | None, others: Sequence[Decoded]) -> list[Judged]:
    if others:
        return on_others(correction.shaft, others)
    return [] if readings is None else held_out(readings)


def _write(
    files: OutputFiles,
    outputs: Outputs,
    correction: Correction,
    *,
    source: str,
    judged: Sequence[Judged],
    readings: Readings | None,
    tolerance_deg: float,
) -> None:
    about = [] if readings is None else correction_words(readings.estimated)
    files.write(
        {
            outputs.header: lambda: header(
                correction, source=f"from {source}", prefix=outputs.prefix, about=about, counted=not about
            ),
            outputs.table: lambda: table(correction, outputs.points, tolerance_deg),
            outputs.toml: lambda: _toml(correction, readings),
            outputs.plot: lambda: _picture(judged, readings),
        }
    )


def _tell_written(files: OutputFiles, outputs: Outputs, correction: Correction, tolerance_deg: float) -> None:
    several = 1 if outputs.table is None else temperatures_c(correction, tolerance_deg).size
    points = f"{outputs.points} points{f' at {several} temperatures' if several > 1 else ''}"
    files.tell_written({} if outputs.table is None else {outputs.table: points})


def _toml(correction: Correction, readings: Readings | None) -> str:
    import tomli_w

    content = to_dict(correction)
    laws = {} if readings is None else readings.laws()
    if laws:
        content["factors"] = {name: law["verdict"] for name, law in laws["factors"].items()}
    if readings is not None and readings.not_separable is not None:
        content["not_separable"] = readings.not_separable
    about = [] if readings is None else correction_words(readings.estimated)
    return "".join(f"# {line}\n" for line in about) + tomli_w.dumps(content)


def _picture(judged: Sequence[Judged], readings: Readings | None) -> Any:
    if readings is not None and readings.calibration.over is not None:
        from scenarios.commands.compensate_plot import over_temperature_figure

        return over_temperature_figure(judged, readings.calibration.over)
    from scenarios.commands.compensate_plot import before_after_figure

    return before_after_figure([one for one in judged if not one.part])
