"""``halltwin recover``: how well known parameters and hidden causes come back."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.report.provenance import Provenance
from scenarios.commands.once import check_once
from scenarios.commands.outputs import JSON, PICTURE, OutputFiles, json_text
from scenarios.studies.engine import run_study
from scenarios.studies.identity import Identity
from scenarios.studies.machines import Machines
from scenarios.studies.recovery.cells import BASELINE, CLEAN, PARAMETERS, Cell, Grid
from scenarios.studies.study_folder import StudyFolder
from scenarios.studies.training.draw import drawable
from twin.angles import Array
from twin.catalogue import CATALOGUE, find
from twin.errors import UserError
from twin.known_names import nearest
from twin.limits import require_within

Summary = list[dict[str, Any]]
COLUMNS = ("cell", "truth", "found", "low", "high", "bound", "named", "extra")
"""What each chunk holds, a row a repeat."""
OPTIONS = {
    "causes": "--cause",
    "noises_deg": "--noise",
    "points": "--points",
    "turns": "--turns",
    "amplitudes_deg": "--amplitude",
    "fits": "--fits",
    "sweeps": "--sweeps",
}
"""What the settings are called by who gives them."""


def check(grid: Grid) -> None:
    """Refuse what cannot be recovered or simulated. Raises UserError."""
    require_within("noise", list(grid.noises_deg), 1e-6, 5.0, "deg")
    require_within("amplitude", list(grid.amplitudes_deg), 1e-6, 5.0, "deg")
    require_within("points", list(grid.points), 8, 100_000, whole=True)
    require_within("turns", list(grid.turns), 1, 1000, whole=True)
    require_within("fits", grid.fits, 2, 100_000, whole=True)
    require_within("sweeps", grid.sweeps, 1, 100_000, whole=True)
    check_once("--cause", grid.causes)
    for cell in grid.cells():
        if cell.cause in (BASELINE, CLEAN):
            continue
        visible = [name for name in drawable(cell.motion()) if find(name).roles("strength")]
        if cell.cause not in visible:
            meant = nearest(cell.cause, (BASELINE, CLEAN, *(effect.name for effect in CATALOGUE)))
            raise UserError(
                f"cause {cell.cause!r}{meant} does not show at {cell.points} points and {cell.turns} turns; expected "
                f"{BASELINE}, {CLEAN} or among {', '.join(visible)}"
            )


@contextlib.contextmanager
def folder_of(grid: Grid, output: Path) -> Iterator[StudyFolder]:
    """The study's folder, begun or gone on with, for this command alone. Raises UserError."""
    check(grid)
    settings = {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(grid).items() if name != "seed"}
    identity = Identity(study="recovery", seed=grid.seed, settings=settings, options=OPTIONS)
    with StudyFolder.opened(output, identity) as folder:
        yield folder


def recover(grid: Grid, folder: StudyFolder, machines: Machines) -> Summary:
    """Run the study, or finish one that was begun; one entry a cell."""
    cells = grid.cells()
    run_study(grid, folder, chunks=len(cells), items=len(cells), unit="cells", machines=machines)
    rows = folder.load(len(cells), COLUMNS)
    return [summary(cell, {name: v[rows["cell"] == k] for name, v in rows.items()}) for k, cell in enumerate(cells)]


def summary(cell: Cell, rows: Mapping[str, Array]) -> dict[str, Any]:
    """Bias and RMS over the bound, coverage of the 95 % intervals, power and false alarms of one cell."""
    entry: dict[str, Any] = {**asdict(cell), "repeats": len(rows["named"])}
    if cell.cause != BASELINE:
        entry |= {"named": _mean(rows["named"]), "false_alarms": _mean(rows["extra"] > 0)}
    if cell.cause == CLEAN:
        return entry | {"parameters": {}}
    names = [f"{n}.{k}" for n, k in PARAMETERS] if cell.cause == BASELINE else [find(cell.cause).roles("strength")[0]]
    return entry | {"parameters": {name: _parameter(rows, slot) for slot, name in enumerate(names)}}


def _parameter(rows: Mapping[str, Array], slot: int) -> dict[str, float | int | None]:
    known = np.isfinite(rows["found"][:, slot])
    truth, found, low, high, bound = (rows[name][known, slot] for name in ("truth", "found", "low", "high", "bound"))
    share = (found - truth) / bound
    return {
        "recovered": int(known.sum()),
        "bound": _mean(bound),
        "bias_over_bound": _mean(share),
        "rms_over_bound": float(np.sqrt(np.mean(share**2))) if share.size else None,
        "coverage": _mean((low <= truth) & (truth <= high)),
    }


def _mean(values: Any) -> float | None:
    return float(np.mean(values)) if np.size(values) else None


def run(
    grid: Grid,
    output: Path,
    *,
    plot: bool,
    machines: Machines,
    force: bool = False,
    command: str | None = None,
) -> None:
    """The command; ``command`` is the line that makes its results again."""
    from scenarios.studies.recovery.table import show

    made = Provenance.today(seed=grid.seed, command=command)

    answer = output / "recovery.json"
    pictures = {name: output / f"{name}.png" for name in ("baseline", "causes")} if plot else {}
    given = [(answer, JSON), *((path, PICTURE) for path in pictures.values())]
    files = OutputFiles.checked(given, force=force, folders=True)
    with folder_of(grid, output) as folder:
        found = recover(grid, folder, machines)
        show(found)
        told = {"schema": "halltwin.recovery/1", **made.to_dict(), "cells": found}
        contents: dict[Path | None, Any] = {answer: json_text(told)}
        if plot:
            from scenarios.studies.recovery.plot import map_figures

            contents |= {pictures[name]: figure for name, figure in map_figures(found).items()}
        files.write(contents)
    files.tell_written()
