"""``halltwin explain``: what the simulation gets wrong about a measured sweep."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.initial_fit import senses_of_channels
from diagnosis.discovery.fitting.subsample import searched_part
from diagnosis.discovery.pipeline import Discovery, discover
from diagnosis.error_model.fit import fit_baseline
from diagnosis.report.answer import to_json
from twin.catalogue import CATALOGUE
from twin.effect import Effect
from twin.errors import UserError
from twin.extensions import effects_with
from twin.files import read_twin, write_twin
from twin.sweep import Sweep
from twin.sweep_file import check_writable, write_beside


def explain(
    sweep: Sweep, *, twin: Path | None = None, effects: tuple[Effect, ...] = CATALOGUE, seed: int = 0
) -> Discovery:
    """Explain a sweep by these effects, against the paper's error model or against a given twin."""
    sweep = searched_part(sweep)
    rng = np.random.default_rng(seed)
    if twin is not None:
        given = read_twin(twin, effects=effects)
        return discover(sweep, start=given, given=given, effects=effects, rng=rng)
    fit = fit_baseline(
        np.radians(sweep.reference_deg),
        np.radians(sweep.measured_deg),
        rng=rng,
        senses=senses_of_channels(sweep),
        robust=True,
    )
    return discover(sweep, start=replace(fit.chain(), effects=effects), effects=effects, rng=rng)


def explain_file(path: str) -> dict[str, Any]:
    """The JSON answer to one sweep file."""
    return to_json(explain(Sweep.read(path)))


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
    from diagnosis.report.console import show

    outputs = [given for given in (json_path, report, extended, plot) if given is not None]
    _check_outputs(outputs, inputs=[path, twin, *effect_files])
    effects = effects_with(effect_files)
    sweep = Sweep.read(path)
    found = explain(sweep, twin=twin, effects=effects, seed=seed)
    answer = to_json(found)
    show(answer)
    if json_path is not None:
        write_beside(json_path, (json.dumps(answer, indent=1, allow_nan=False) + "\n").encode())
    if extended is not None:
        write_twin(extended, found.fit.chain)
    if report is not None:
        from diagnosis.report.page import write_report

        write_report(report, found, answer)
    if plot is not None:
        from diagnosis.report.explain_plot import draw

        draw(found, plot)


def _check_outputs(outputs: list[Path], *, inputs: list[Path | None]) -> None:
    """Refuse outputs that cannot be written, or that would overwrite an input or one another."""
    taken = {given.resolve() for given in inputs if given is not None}
    for output in outputs:
        check_writable(output)
        if output.resolve() in taken and not output.is_char_device():
            raise UserError(f"{output}: is read or written already by this command; give each output a name of its own")
        taken.add(output.resolve())
