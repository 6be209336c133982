"""Study of the discovery's settings: each halved and doubled, and what becomes of the answers.

    python -m tests.settings_study --draws 2 --seed 7 -o settings.json
    python -m tests.settings_study --only fair_share,swap_log_odds

The draws are those of the sets in :mod:`tests.hidden.sets`, a few of every kind, hard and easy. A setting that changes
no answer on enough of them is a constant that nothing notices.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import track
from rich.table import Table

from diagnosis import DiscoverySettings, explain
from tests.hidden.scoring import verdict
from tests.hidden.sets import Job, jobs

KINDS = {
    "clean_hard": ("clean",),
    "single_hard": ("hysteresis", "cardan_coupling", "zero_drift", "magnet_harmonic"),
    "weak": ("saturation", "backlash"),
    "pairs": ("cordic_truncation + saturation", "zero_drift + bus_glitch", "cardan_coupling + reference_eccentricity"),
    "triples": ("reference_jitter + saturation + bearing_wobble", "adc_stuck_bit + magnet_harmonic + stale_frames"),
    "unnamed": ("noise_burst", "local_bump", "time_frequency"),
    "unnamed_with_cause": ("direction_times_order + saturation",),
}
"""Labels of each set: every stage of the discovery has work to do on some of them."""
FACTORS = (0.5, 2.0)


@dataclass(frozen=True)
class Answer:
    """What was said of one draw: the names, and whether they are right."""

    names: tuple[str, ...]
    right: bool


def draws(count: int, seed: int) -> list[Job]:
    """So many draws of every label."""
    return [
        job for group, labels in KINDS.items() for job in jobs(group, draws=count, seed=seed, only=frozenset(labels))
    ]


def changed(only: frozenset[str]) -> Iterator[tuple[str, float, DiscoverySettings]]:
    """Each setting halved and doubled: its name, the value, and the settings; what cannot be is left out."""
    plain = DiscoverySettings()
    for one in fields(plain):
        if only and one.name not in only:
            continue
        for factor in FACTORS:
            value = getattr(plain, one.name) * factor
            value = max(round(value), 1) if isinstance(getattr(plain, one.name), int) else value
            if value != getattr(plain, one.name):
                yield one.name, value, replace(plain, **{one.name: value})


def asked(task: tuple[str, Mapping[str, Any], DiscoverySettings]) -> Answer:
    """Explain one sweep with these settings."""
    path, truth, settings = task
    answer = explain(path, settings=settings).to_dict()
    names = tuple(sorted(cause["name"] for cause in answer["causes"]))
    return Answer(names, verdict(answer, truth) == "right")


def study(todo: Sequence[Job], *, only: frozenset[str], processes: int, console: Console) -> list[dict[str, Any]]:
    """A record for each changed setting: how many answers are others, and how many are right."""
    with (
        tempfile.TemporaryDirectory() as folder,
        ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool,
    ):
        sweeps: list[tuple[str, Mapping[str, Any]]] = []
        for place, job in enumerate(todo):
            hidden = job.draw()
            path = Path(folder) / f"{place}.csv"
            hidden.write_csv(path)
            sweeps.append((str(path), hidden.truth))

        def answers(settings: DiscoverySettings) -> list[Answer]:
            return list(pool.map(asked, [(path, truth, settings) for path, truth in sweeps]))

        plain = answers(DiscoverySettings())
        records = [{"setting": "as it is", "value": None, "others": 0, "right": sum(a.right for a in plain)}]
        for name, value, settings in track(list(changed(only)), "settings", console=console):
            now = answers(settings)
            others = sum(a.names != b.names for a, b in zip(plain, now, strict=True))
            records.append({"setting": name, "value": value, "others": others, "right": sum(a.right for a in now)})
    return records


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m tests.settings_study", description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="comma-separated settings")
    parser.add_argument("--draws", type=int, default=1, help="draws of each of the labels")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("-o", "--output", type=Path, help="JSON of the study")
    options = parser.parse_args(arguments)
    console = Console() if Console().is_terminal else Console(width=120)
    todo = draws(options.draws, options.seed)
    only = frozenset(one for one in options.only.split(",") if one)
    records = study(todo, only=only, processes=options.jobs, console=console)
    table = Table(title=f"{len(todo)} sweeps")
    for column in ("setting", "value", "other names", "right"):
        table.add_column(column, justify="left" if column == "setting" else "right")
    for record in records:
        value = "" if record["value"] is None else f"{record['value']:g}"
        table.add_row(record["setting"], value, str(record["others"]), str(record["right"]))
    console.print(table)
    if options.output is not None:
        options.output.write_text(
            json.dumps({"sweeps": len(todo), "records": records}, indent=1) + "\n", encoding="utf-8"
        )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
