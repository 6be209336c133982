"""Is what has changed since a device's twin was made named, and nothing where nothing has?

    python -m tests.changed_twin --draws 10 --seed 7 -o changed.json

Two recordings of a device by the independent generator: the first is explained, and the second is held against the
twin that this gives, as ``halltwin explain --twin`` does.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pandas as pd
from rich.console import Console
from rich.table import Table

from diagnosis import explain
from tests.hidden.changed import ANOTHER, FACTORS, KINDS, NOTHING, pair
from tests.hidden.streams import derived_seed


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
    for head in ("changed", "draws", "named", "extra name", "another device"):
        shown.add_column(head, justify="left" if head == "changed" else "right")
    kinds = list(dict.fromkeys(one.kind for one in outcomes))
    for name, chosen in [*((kind, [kind]) for kind in kinds), ("all changes", [k for k in kinds if k in KINDS])]:
        part = [one for one in outcomes if one.kind in chosen]
        if part:
            counts = (
                sum(one.named for one in part),
                sum(bool(one.extra) for one in part),
                sum(o.other_device for o in part),
            )
            shown.add_row(name, str(len(part)), *map(str, counts))
    return shown


def _wrong(one: Outcome) -> bool:
    """Whether anything was said that is not so, or left unsaid."""
    missed = one.kind in KINDS and not one.named
    return missed or bool(one.extra and one.kind != ANOTHER) or one.other_device != (one.kind == ANOTHER)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m tests.changed_twin", description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=10, help="pairs of each kind")
    parser.add_argument("--only", default="", help=f"kinds, with commas: {', '.join((*KINDS, NOTHING, ANOTHER))}")
    parser.add_argument("--first", type=int, default=0, help="number of the first pair")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args(arguments)
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    kinds = [one.strip() for one in options.only.split(",") if one.strip()] or [*KINDS, NOTHING, ANOTHER]
    todo = [(kind, number) for kind in kinds for number in range(options.first, options.first + options.draws)]
    console, outcomes = Console(width=120), []
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        for one in pool.map(partial(outcome, seed=options.seed), *zip(*todo, strict=True)):
            outcomes.append(one)
            if _wrong(one):
                console.print(f"{one.kind} {one.way} number {one.number}: {', '.join(one.said) or 'nothing'}")
    console.print(table(outcomes))
    if options.output is not None:
        options.output.write_text(json.dumps([asdict(one) for one in outcomes], indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
