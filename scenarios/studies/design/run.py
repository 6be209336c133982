"""``halltwin design``: which magnet, at which distance, keeps the error, over temperature and mounting tolerances."""

from __future__ import annotations

import contextlib
import csv
import io
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis.report.provenance import Provenance
from scenarios.commands.outputs import JSON, PICTURE, TABLE, TOML, OutputFiles, json_text
from scenarios.commands.protocol import COLDEST_C, HOTTEST_C
from scenarios.studies.design.check import Check, check_design, design_twin
from scenarios.studies.design.distance import distance_csv, distances
from scenarios.studies.design.options import OPTIONS
from scenarios.studies.design.space import AXES, MOST_DESIGNS, Space, require_mountable
from scenarios.studies.design.study import Demand, DesignStudy, feasible, ranking
from scenarios.studies.engine import run_study
from scenarios.studies.identity import Identity
from scenarios.studies.machines import Machines
from scenarios.studies.study_folder import StudyFolder
from twin.angles import Array, IntArray
from twin.errors import UserError
from twin.extensions import effects_with
from twin.files import to_dict, twin_text
from twin.limits import require_within
from twin.magnet.magnet import LARGEST_MM, LARGEST_T
from twin.presets import read_twin_or_preset

Figures = dict[str, np.ndarray[Any, Any]]
_CHUNK = 16
COLUMNS = (
    *("design", "grade", "field_mT", "field_low_mT", "field_high_mT", "margin_mT", "error_deg", "error_p95_deg"),
    *("stray_error_deg", "resolution_bits", "yield"),
)
"""What is known of every design, besides the error of each cause."""


def study_of(twin: str, space: Space, demand: Demand, *, seed: int) -> DesignStudy:
    """The study of these designs under a twin's sensor. Raises UserError."""
    chain = read_twin_or_preset(twin, effects=effects_with())
    if chain.magnet is None:
        raise UserError(f"{twin}: has no [magnet], so its figures are stated at no field; give a twin that has one")
    require_within("designs", space.designs, 1, MOST_DESIGNS, whole=True)
    require_within("max-error", demand.max_error_deg, 1e-6, 180.0, "deg")
    require_within("mountings", demand.mountings, 1, 100_000, whole=True)
    require_within("min-yield", demand.min_yield, 0.0, 1.0)
    require_within("temperature", list(demand.temperature_c), COLDEST_C, HOTTEST_C, "C")
    require_within("bore", space.bore_mm, 0.0, LARGEST_MM, "mm")
    require_within("window", list(demand.window_mT), 0.0, 2000.0, "mT")
    # Bad numbers are refused here, in one line, and not in a worker.
    require_within("remanence", list(space.axes["remanence_T"]), 0.0, LARGEST_T, "T")
    space.assemble(*space.table())
    require_mountable(space, demand.tolerance)
    return DesignStudy(twin=to_dict(chain), space=space, demand=demand, chunk=_CHUNK, seed=seed)


@contextlib.contextmanager
def folder_of(study: DesignStudy, output: Path) -> Iterator[StudyFolder]:
    """The study's folder, begun or gone on with, for this command alone. Raises UserError."""
    settings = {
        "twin": study.twin,
        "space": _plain(asdict(study.space)),
        "demand": _plain(asdict(study.demand)),
        "chunk": study.chunk,
    }
    identity = Identity(study="design", seed=study.seed, settings=settings, options=OPTIONS)
    with StudyFolder.opened(output, identity) as folder:
        yield folder


def explore(study: DesignStudy, folder: StudyFolder, machines: Machines) -> Figures:
    """All designs' figures, each (designs, ...), computed or read back from a study begun before."""
    run_study(study, folder, chunks=study.chunks, items=study.space.designs, unit="designs", machines=machines)
    return folder.load(study.chunks, COLUMNS)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return [_plain(item) for item in value] if isinstance(value, tuple | list) else value


@dataclass(frozen=True, kw_only=True)
class Results:
    """What a study leaves for its reader: how many of the best designs, whether their map.

    ``force``: also in place of files that the program did not write, or that were changed since. ``command``: the
    command line that makes them again.
    """

    best: int = 10
    plot: bool = True
    force: bool = False
    command: str | None = None


def run(
    twin: str,
    output: Path,
    *,
    space: Space,
    demand: Demand,
    results: Results,
    machines: Machines,
    seed: int,
) -> None:
    """The command: explore, list the best, check the winner, draw the map."""
    from scenarios.studies.design.table import show, show_distances

    require_within("best", results.best, 1, MOST_DESIGNS, whole=True)
    made = Provenance.today(seed=seed, command=results.command)
    study = study_of(twin, space, demand, seed=seed)
    table, answer, best, curves = (output / name for name in ("designs.csv", "best.json", "best.toml", "distance.csv"))
    pictures = [output / name for name in ("map.png", "distance.png", "distance.svg")] if results.plot else []
    files = OutputFiles.checked(
        [(table, TABLE), (answer, JSON), (best, TOML), (curves, TABLE), *((path, PICTURE) for path in pictures)],
        inputs=[twin],
        force=results.force,
        folders=True,
    )
    with folder_of(study, output) as folder:
        found = explore(study, folder, machines)
        order = ranking(found, demand)
        winner = int(order[0])
        check = check_design(study, found["design"][winner], found["grade"][winner])
        listed = order[: results.best]
        over = distances(study, found["design"][listed], found["grade"][listed].astype(int))
        show(found, listed, study, check, sensor=twin)
        show_distances(over)
        told = _answer(found, listed, study, check, made)
        contents: dict[Path | None, Any] = {
            table: _table(found, space),
            answer: json_text(told | {"least_nonlinear": [one.to_dict() for one in over]}),
            best: twin_text(design_twin(study, found["design"][winner], found["grade"][winner])),
            curves: distance_csv(over),
        }
        if results.plot:
            from scenarios.studies.design.distance_plot import distance_figure
            from scenarios.studies.design.plot import map_figure

            contents[pictures[0]] = map_figure(found, study)
            contents |= dict.fromkeys(pictures[1:], distance_figure(over)) if over else {}
        files.write(contents)
    files.tell_written()


def record(found: Mapping[str, Array], row: int, space: Space) -> dict[str, Any]:
    """One design's numbers by name, grade first."""
    values: dict[str, Any] = {"grade": space.grades[int(found["grade"][row])]}
    values.update({name: float(value) for name, value in zip(AXES, found["design"][row], strict=True)})
    if values["remanence_T"] == 0.0:
        del values["remanence_T"]
    values.update({name: float(column[row]) for name, column in found.items() if name not in ("design", "grade")})
    return values


def _table(found: Mapping[str, Array], space: Space) -> str:
    """All designs as CSV."""
    out = io.StringIO()
    records = [record(found, row, space) for row in range(len(found["grade"]))]
    names = list(dict.fromkeys(name for entry in records for name in entry))
    table = csv.DictWriter(out, names, lineterminator="\n")
    table.writeheader()
    table.writerows(
        {name: f"{value:.6g}" if isinstance(value, float) else value for name, value in entry.items()}
        for entry in records
    )
    return out.getvalue()


def _answer(
    found: Mapping[str, Array], rows: IntArray, study: DesignStudy, check: Check, made: Provenance
) -> dict[str, Any]:
    """The best designs as plain values."""
    return {
        "schema": "halltwin.design/1",
        **made.to_dict(),
        "demand": _plain(asdict(study.demand)),
        "designs": study.space.designs,
        "feasible": int(np.count_nonzero(feasible(found, study.demand))),
        "best": [record(found, int(row), study.space) for row in rows],
        "check_of_best": asdict(check),
    }
