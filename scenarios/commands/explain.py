"""``halltwin explain``: what the simulation gets wrong about a measured sweep."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from diagnosis import explain
from diagnosis.report.console import show
from diagnosis.report.plotting import check_format, write_figure
from twin.errors import UserError
from twin.files import write_twin
from twin.whole_file import check_writable, write_beside


def run(
    path: Path,
    *,
    twin: Path | None,
    json_path: Path | None,
    report: Path | None,
    extended: Path | None,
    plot: Path | None,
    effect_files: Sequence[Path] = (),
    seed: int,
) -> None:
    """The command: print the answer, write what was asked for. Raises UserError before anything is written."""
    outputs = [given for given in (json_path, report, extended, plot) if given is not None]
    _check_outputs(outputs, inputs=[path, twin, *effect_files])
    if plot is not None:
        check_format(plot)
    found = explain(path, twin=twin, effects=effect_files, seed=seed)
    answer = found.to_dict()
    show(answer)
    if json_path is not None:
        write_beside(json_path, (json.dumps(answer, indent=1, allow_nan=False) + "\n").encode())
    if extended is not None:
        write_twin(extended, found.extended)
    if report is not None:
        found.write_report(report)
    if plot is not None:
        write_figure(found.plot(), plot)


def _check_outputs(outputs: list[Path], *, inputs: list[Path | None]) -> None:
    """Refuse outputs that cannot be written, or that would overwrite an input or one another."""
    taken = {given.resolve() for given in inputs if given is not None}
    for output in outputs:
        check_writable(output)
        if output.resolve() in taken and not output.is_char_device():
            raise UserError(f"{output}: is read or written already by this command; give each output a name of its own")
        taken.add(output.resolve())
