"""Is what has changed since a device's twin was made named, and nothing where nothing has?

    python -m tests.changed_twin --draws 10 --seed 7 -o changed.jsonl

Two recordings of a device by the independent generator: the first is explained, and the second is held against the
twin that this gives, as ``halltwin explain --twin`` does. Each pair is kept in the file as it is done; the same command
goes on where it was stopped.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pandas as pd
from rich.console import Console
from rich.table import Table

from diagnosis import explain
from tests.hidden.changed import ANOTHER, FACTORS, KINDS, NOTHING, pair
from tests.hidden.streams import derived_seed
from tests.kept import Kept, share


@dataclass(frozen=True)
class Outcome:
    """What was said of one pair: whether the change was ``named``, and what was ``extra``."""

    kind: str
    way: str
    seed: int
    number: int
    named: bool
    extra: tuple[str, ...]
    said: tuple[str, ...]
    other_device: bool

    @property
    def wrong(self) -> bool:
        """Whether anything was said that is not so, or left unsaid."""
        missed = self.kind in KINDS and not self.named
        return missed or bool(self.extra and self.kind != ANOTHER) or self.other_device != (self.kind == ANOTHER)


def draw_name(kind: str, number: int, *, seed: int) -> str:
    """What the file calls a pair."""
    return f"{kind} {number} of seed {seed}"


def outcome(kind: str, number: int, *, seed: int) -> Outcome:
    """Explain both recordings of one pair, the second against the twin of the first."""
    own = derived_seed(seed, kind, str(number))
    made = pair(kind, seed=own, number=number)
    first = explain(pd.DataFrame(made.before.columns))
    found = explain(pd.DataFrame(made.after.columns), twin=first.extended)
    answer = found.to_dict()
    right = _right(kind, first.to_dict())
    entries = {
        one["parameter"]: {one["parameter"], one["effect"], *one["indistinguishable_from"]} for one in answer["changed"]
    }
    entries |= {one["name"]: {one["name"], *one["indistinguishable_from"]} for one in answer["causes"]}
    extra = tuple(said for said, words in entries.items() if not words & right)
    return Outcome(
        kind, made.way, own, number, len(entries) > len(extra), extra, tuple(entries), answer["other_device"]
    )


def _right(kind: str, first: Mapping[str, Any]) -> set[str]:
    """Words that name the change: a factor's parameter, or the cause by any name that the first recording leaves it."""
    if kind in FACTORS:
        return {FACTORS[kind]}
    alike = [{one["name"], *one["indistinguishable_from"]} for one in first["causes"]]
    return {kind}.union(*(names for names in alike if kind in names))


def table(outcomes: Sequence[Outcome]) -> Table:
    """How often the change was named, and anything else."""
    shown = Table(box=None)
    for head in ("changed", "named", "extra name", "another device"):
        shown.add_column(head, justify="left" if head == "changed" else "right")
    kinds = list(dict.fromkeys(one.kind for one in outcomes))
    for name, chosen in [*((kind, [kind]) for kind in kinds), ("all changes", [k for k in kinds if k in KINDS])]:
        part = [one for one in outcomes if one.kind in chosen]
        if part:
            counts = (
                sum(one.named for one in part),
                sum(bool(one.extra) for one in part),
                sum(one.other_device for one in part),
            )
            shown.add_row(name, *(share(count, len(part)) for count in counts))
    return shown


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m tests.changed_twin", description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=10, help="pairs of each kind")
    parser.add_argument("--only", default="", help=f"kinds, with commas: {', '.join((*KINDS, NOTHING, ANOTHER))}")
    parser.add_argument("--first", type=int, default=0, help="number of the first pair")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path, help="keeps each pair as it is done (JSON lines)")
    options = parser.parse_args(arguments)
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    kinds = [one.strip() for one in options.only.split(",") if one.strip()] or [*KINDS, NOTHING, ANOTHER]
    todo = [(kind, number) for kind in kinds for number in range(options.first, options.first + options.draws)]
    console, kept = Console(width=120), Kept.read(options.output)
    names = {draw_name(kind, number, seed=options.seed): (kind, number) for kind, number in todo}
    missing = {name: one for name, one in names.items() if name not in kept.lines}
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        running = {pool.submit(outcome, *one, seed=options.seed): name for name, one in missing.items()}
        for done in as_completed(running):
            kept.add(running[done], asdict(done.result()))
    outcomes = [Outcome(**{key: value for key, value in kept.lines[name].items() if key != "draw"}) for name in names]
    for one in filter(lambda outcome: outcome.wrong, outcomes):
        console.print(f"{one.kind} {one.way} number {one.number}: {', '.join(one.said) or 'nothing'}")
    console.print(table(outcomes))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
