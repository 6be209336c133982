"""halltwin paper: the paper's tables and figures from the twin and the diagnosis, held against what it prints."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from diagnosis.progress import Count, Listener
from diagnosis.report.plotting import style
from scenarios.commands.outputs import PICTURE, TABLE, OutputFiles
from scenarios.commands.paper import channels, delta_e, devices, disk_curve, search_figures, table_1
from scenarios.commands.paper.held import Held, held_csv, lines
from scenarios.commands.paper.work import Work
from scenarios.commands.progress import progress_line
from scenarios.commands.terminal import terminal_width
from twin.angles import Array
from twin.limits import require_within
from twin.sweep_file import csv_text

MOST_CASES = 100_000
Drawn = tuple[Any, dict[str, Array] | str]
"""A picture, and its data as columns or as the text of a table."""


def run(folder: Path, *, cases: int = 100, seed: int = 0, force: bool = False) -> None:
    """Write the tables and each figure, its data (.csv) and its picture (.svg, .png); print the paper's beside ours."""
    require_within("cases", cases, 2, MOST_CASES, whole=True)
    names = {name: [folder / f"{name}{ending}" for ending in (".csv", ".svg", ".png")] for name in FIGURES}
    asked = [(path, TABLE if path.suffix == ".csv" else PICTURE) for paths in names.values() for path in paths]
    tables = [(folder / f"{name}.csv", TABLE) for name in TABLES]
    files = OutputFiles.checked([*tables, *asked], force=force, folders=True)
    plt = style()
    with progress_line() as listener:
        contents = _made(plt, names, folder, _work(cases, seed, listener))
    files.write(contents)
    files.tell_written()


def _work(cases: int, seed: int, listener: Listener) -> Work:
    return Work(cases=cases, seed=seed, count=Count(Work.steps(cases), listener))


def _made(plt: Any, names: dict[str, list[Path]], folder: Path, work: Work) -> dict[Path | None, Any]:
    """The content of every file; tables are printed as they come."""
    contents: dict[Path | None, Any] = {}
    for name, (make, say) in TABLES.items():
        contents[folder / f"{name}.csv"] = make(work)
        for line in say(work):
            print(line)
    for name, draw in FIGURES.items():
        figure, columns = draw(plt, work)
        figure.suptitle(TITLES[name], fontsize=10)
        csv, *pictures = names[name]
        contents |= {csv: columns if isinstance(columns, str) else csv_text(columns), **dict.fromkeys(pictures, figure)}
        plt.close(figure)
    return contents


def printed(work: Work) -> list[Held]:
    """Every figure that the paper prints, in its order, with ours."""
    return [
        *table_1.held(),
        *disk_curve.held(disk_curve.disk_curve()),
        *search_figures.held(
            work.searched,
            settings_particles=work.methods["modified"].settings.particles,
            delta_e_deg=work.delta_e_deg,
        ),
        *devices.table_2(work.devices),
        *devices.accuracy(work.devices),
    ]


Maker = tuple[Callable[[Work], str], Callable[[Work], list[str]]]
TABLES: dict[str, Maker] = {
    "table1": (lambda work: table_1.table_csv(table_1.table()), lambda work: []),
    "table2": (lambda work: held_csv(devices.table_2(work.devices)), lambda work: [delta_e.line()]),
    "printed": (lambda work: held_csv(printed(work)), lambda work: lines(printed(work), width=terminal_width())),
    "search": (
        lambda work: search_figures.methods_csv(work.searched, work.methods, work.coarse_grid_rad),
        lambda work: [],
    ),
}
"""By file name: what makes the table, and what is said of it."""


def _compared(work: Work) -> search_figures.Compared:
    words = {name: method.words for name, method in work.methods.items()}
    return search_figures.Compared(work.searched, words, work.banded, work.delta_e_deg)


def _alone(draw: Callable[[Any], Drawn]) -> Callable[[Any, Work], Drawn]:
    """A figure that needs no work beforehand."""
    return lambda plt, work: draw(plt)


FIGURES: dict[str, Callable[[Any, Work], Drawn]] = {
    "fig3": _alone(channels.offsets),
    "fig4": _alone(channels.gain),
    "fig5": _alone(channels.phase),
    "fig6": _alone(channels.field_and_voltage),
    "fig7": _alone(channels.non_linearity),
    "fig8": _alone(channels.fluctuation),
    "fig9": _alone(channels.calculation),
    "fig13": lambda plt, work: search_figures.figure_13(plt, work.searched["modified"]),
    "delta_e": _alone(delta_e.figure),
    "search_methods": lambda plt, work: search_figures.figure_of_methods(plt, _compared(work)),
    "fig14": lambda plt, work: devices.figure_14(plt, work.devices),
    "fig16": lambda plt, work: devices.figure_16(plt, work.devices),
}
TITLES = {
    "fig3": "Fig. 3: angle error by offsets of the channels",
    "fig4": "Fig. 4: angle error by a mismatch of the gains",
    "fig5": "Fig. 5: angle error by a phase that is not 90 deg",
    "fig6": "Fig. 6: output of the concentrator over the field",
    "fig7": "Fig. 7: angle error by the quadratic term",
    "fig8": "Fig. 8: sampling error by a change of the converter's reference",
    "fig9": "Fig. 9: angle error by the iterations of the CORDIC",
    "fig13": "Fig. 13: convergence of the swarm, 100 particles",
    "delta_e": "Eq. 7: Delta E, half a step of each grid and four standard deviations of each noise",
    "search_methods": "Section 4.1: the swarm's modifications, and the discard rule of Eq. 11",
    "fig14": "Fig. 14: the four devices of Table 2, simulated and diagnosed",
    "fig16": "Fig. 16: the four devices of Table 2 before and after compensation",
}
