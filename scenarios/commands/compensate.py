"""halltwin compensate: a continuous correction as C header, table or TOML, with its error on readings it never saw."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.correction.calibration import calibrate
from diagnosis.correction.compensation import Correction, correction_of, to_dict
from diagnosis.correction.compensation_c import check_prefix, header
from diagnosis.correction.cross_validation import BeforeAfter, against, cross_validated
from diagnosis.report.row_counts import counts_of, diagnosed_rows, rejected_words
from diagnosis.report.wording import plain
from scenarios.commands.compensate_text import MadeOf, show
from scenarios.commands.fail_on import COMPENSATE, FoundError, asked
from scenarios.commands.inputs import SweepFiles, SweepsRead, check_panels
from scenarios.commands.outputs import HEADER, PICTURE, TABLE, TOML, OutputFiles
from scenarios.commands.protocol import COLDEST_C, HOTTEST_C
from twin.angles import TAU, Array, radians
from twin.chain import Chain
from twin.effect import BoolArray
from twin.errors import UserError
from twin.extensions import effects_with
from twin.limits import require_within
from twin.presets import is_twin, read_twin_or_preset
from twin.shown_name import shown_name
from twin.sweep import Sweep

_FEWEST_POINTS = 4
_MOST_POINTS = 65536
_COARSEST_DEG = 10.0
_NONE = SweepFiles()
_NO_ROWS: BoolArray = np.zeros(0, dtype=bool)


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
    source: str | Path,
    *,
    outputs: Outputs,
    check: SweepFiles = _NONE,
    temperature_c: float = 25.0,
    tolerance_deg: float = 1e-3,
    effect_files: Sequence[Path] = (),
    seed: int = 0,
    fail_on: Sequence[str] = (),
) -> None:
    """Correction of a sweep or of a twin; errors on the sweeps of ``check``, or on held-out blocks of the sweep.

    Raises FoundError, after all is written, where the correction makes the error larger on a sweep of ``check``.
    """
    words = asked(fail_on, COMPENSATE)
    if not _FEWEST_POINTS <= outputs.points <= _MOST_POINTS:
        raise UserError(f"points is {outputs.points}; expected {_FEWEST_POINTS} to {_MOST_POINTS}")
    require_within("temperature", temperature_c, COLDEST_C, HOTTEST_C, "C")
    require_within("tolerance", tolerance_deg, 0.0, _COARSEST_DEG, "deg")
    check_prefix(outputs.prefix)
    effects = effects_with(effect_files)
    twin = read_twin_or_preset(source, effects=effects) if is_twin(source) else Chain(effects=effects)
    checked_on = check.paths()
    files = _files(outputs, inputs=[Path(source), *checked_on, *effect_files])
    others = check.read(checked_on)
    sweep = None if is_twin(source) else Sweep.read(source, max_bytes=check.max_bytes)
    check_panels(outputs.plot, len(others.sweeps) if checked_on or sweep is None else 1)
    if sweep is None:
        correction = correction_of(twin, temperature_c=temperature_c, tolerance_deg=tolerance_deg)
        made_of, gross = MadeOf(shown_name(source), "", tolerance_deg), _NO_ROWS
    else:
        correction, made_of, gross = _made_of(sweep, shown_name(source), tolerance_deg, seed)
    judged = _judge(correction, sweep, others, tolerance_deg, seed)
    show(made_of, correction, [row for one in judged for row in _rows(*one, other=bool(checked_on), gross=gross)])
    for line in (*_rejected(others), *others.lines):
        print(line)
    _write(
        files, outputs, correction, source=shown_name(source), judged=_with_own_zero(judged) if checked_on else judged
    )
    _say_where_worse(judged, fails=bool(checked_on or words))
    others.raise_unusable()


def _made_of(sweep: Sweep, name: str, tolerance_deg: float, seed: int) -> tuple[Correction, MadeOf, BoolArray]:
    """The correction of a sweep, what is told of its readings, and which (n,) were set aside as gross errors."""
    found = calibrate(*_angles(sweep), rng=np.random.default_rng(seed))
    gross = found.fit.outliers
    counts = counts_of(sweep, sweep.numbers[gross].tolist())
    readings = f"{counts['rows']} readings; {diagnosed_rows(counts)}"
    # Of the mean of so many readings; and no better than the orders that were left out.
    known_deg = float(np.degrees(found.fit.sigma_rad)) / np.sqrt(counts["fitted"])
    made_of = MadeOf(name, readings, max(known_deg, tolerance_deg))
    return correction_of(found.chain, tolerance_deg=tolerance_deg), made_of, gross


def _rejected(others: SweepsRead) -> list[str]:
    """Which sweeps of ``--check`` hold rows that could not be used."""
    counts = [(shown_name(one.name), counts_of(one, ())) for one in others.sweeps if one.rejected]
    return [f"{name}: {told['rows']} readings; {rejected_words(told)}" for name, told in counts]


def _files(outputs: Outputs, *, inputs: Sequence[Path]) -> OutputFiles:
    """The files to write. Raises UserError where one of them cannot or must not be written."""
    asked = [(outputs.header, HEADER), (outputs.table, TABLE), (outputs.toml, TOML), (outputs.plot, PICTURE)]
    return OutputFiles.checked(asked, inputs=inputs, force=outputs.force)


def _angles(sweep: Sweep) -> tuple[Array, Array]:
    return radians(sweep.reference_deg), radians(sweep.measured_deg)


def _of_readings(tolerance_deg: float, seed: int) -> Callable[[Array, Array], Correction]:
    """Readings -> correction, the same way for the whole sweep and for each fold."""

    def build(reference: Array, measured: Array) -> Correction:
        found = calibrate(reference, measured, rng=np.random.default_rng(seed))
        return correction_of(found.chain, tolerance_deg=tolerance_deg)

    return build


def _judge(
    correction: Correction, sweep: Sweep | None, others: SweepsRead, tolerance_deg: float, seed: int
) -> list[tuple[str, BeforeAfter, Sweep]]:
    if others.sweeps:
        return [(f"on {one.name}", against(*_angles(one), correction.shaft), one) for one in others.sweeps]
    if sweep is None:
        return []
    build = _of_readings(tolerance_deg, seed)
    found = cross_validated(*_angles(sweep), lambda reference, measured: build(reference, measured).shaft)
    return [("on held-out blocks", found, sweep)]


def _rows(
    name: str, found: BeforeAfter, tested: Sweep, *, other: bool, gross: BoolArray
) -> list[tuple[str, BeforeAfter]]:
    """As it is and, where the reference may have found its zero anew, with each turn's own zero taken out.

    Of the sweep that the correction is made of also without its gross errors, which all others count.
    """
    rows, turn = [(name, found)], _turns(tested)
    apart = other or np.unique(turn).size > 1
    if apart:
        rows.append(("  each turn's own zero taken out", found.per_turn(turn)))
    if not other and gross.any():
        kept = found.among(~gross)
        left_out = f"without the {np.count_nonzero(gross)} set aside"
        rows.append((f"  and {left_out}" if apart else f"  {left_out}", kept.per_turn(turn[~gross]) if apart else kept))
    return rows


def _say_where_worse(judged: Sequence[tuple[str, BeforeAfter, Sweep]], *, fails: bool) -> None:
    """Say on which readings the correction makes the error larger; raise FoundError there where that is a failure.

    Judged with each turn's own zero taken out: a reference that was mounted anew says nothing about the correction.
    """
    larger = []
    for name, found, tested in judged:
        before, after = found.per_turn(_turns(tested)).rms_deg
        if after > before:
            larger.append(f"{name} ({plain(before, 4)} -> {plain(after, 4)} deg RMS, own zero taken out)")
    if larger:
        said = f"the correction makes the error larger {', '.join(larger)}; do not load it"
        if fails:
            raise FoundError(said)
        print(said)


def _turns(sweep: Sweep) -> Array:
    return np.zeros(len(sweep)) if sweep.turn is None else sweep.turn


Judged = list[tuple[str, BeforeAfter, Sweep]]


def _with_own_zero(judged: Judged) -> Judged:
    """Each turn's own zero taken out: another sweep's reference may have found its zero anew."""
    return [(f"{name}, own zero taken out", found.per_turn(_turns(tested)), tested) for name, found, tested in judged]


def _write(files: OutputFiles, outputs: Outputs, correction: Correction, *, source: str, judged: Judged) -> None:
    files.write(
        {
            outputs.header: lambda: header(correction, source=f"from {source}", prefix=outputs.prefix),
            outputs.table: lambda: _table(correction, outputs.points),
            outputs.toml: lambda: _toml(correction),
            outputs.plot: lambda: _picture(judged),
        }
    )
    files.tell_written({} if outputs.table is None else {outputs.table: f"{outputs.points} points"})


def _toml(correction: Correction) -> str:
    import tomli_w

    return tomli_w.dumps(to_dict(correction))


def _picture(judged: Judged) -> Any:
    from scenarios.commands.compensate_plot import before_after_figure

    return before_after_figure(judged)


def _table(correction: Correction, points: int) -> str:
    """CSV: reading, correction to add to slope x reading - zero, and the shaft angle."""
    reading = TAU * np.arange(points) / points
    out = io.StringIO()
    out.write("reading_deg,correction_deg,shaft_deg\n")
    rows = zip(
        np.degrees(reading),
        np.degrees(correction.correction(reading)),
        np.degrees(correction.shaft(reading)) % 360.0,
        strict=True,
    )
    for row in rows:
        out.write(",".join(f"{value:.6f}" for value in row) + "\n")
    return out.getvalue()
