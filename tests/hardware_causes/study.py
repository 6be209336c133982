"""Simulate each cause as built, explain it, and say what came of it.

Every case is drawn three times, with the channels and without. A draw is right where every cause named is one of the
case's names, or a class that holds one, and one is named where one has to be; its size is right where the true value
lies in the interval.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np
from rich.console import Console
from rich.table import Table

from diagnosis import explain
from tests.hardware_causes.cases import CASES, Case


@dataclass(frozen=True)
class Outcome:
    """What an answer said: classes named, and of the sized parameters name, value, low, high and whether right."""

    case: str
    channels: bool
    seed: int
    verdict: str
    named: tuple[frozenset[str], ...]
    sized: tuple[tuple[str, float, float, float, bool], ...]

    @property
    def false(self) -> int:
        """Causes named that the case does not hold."""
        return sum(not one & CASES[self.case].names for one in self.named)

    @property
    def missing(self) -> bool:
        """Whether a name that has to be given is not."""
        case = CASES[self.case]
        wanted = bool(case.names) and case.needed and (self.channels or not case.channels_only)
        return wanted and not any(one & case.names for one in self.named)

    @property
    def right(self) -> bool:
        """Names and sizes are right."""
        return not self.false and not self.missing and all(inside for *_, inside in self.sized)


def outcome(job: tuple[str, bool, int]) -> Outcome:
    """Simulate and explain one draw."""
    name, channels, seed = job
    case = CASES[name]
    motion = case.motion(channels=channels, rng=np.random.default_rng((seed, 1)))
    answer = explain(case.chain.simulate(motion, seed=seed)).to_dict()
    named = tuple(frozenset({c["name"], *c["indistinguishable_from"]}) for c in answer["causes"])
    return Outcome(name, channels, seed, answer["verdict"], named, tuple(_sized(case, answer["causes"])))


def _sized(case: Case, causes: Sequence[dict]) -> list[tuple[str, float, float, float, bool]]:  # type: ignore[type-arg]
    found = []
    for cause in causes:
        if cause["name"] in case.names:
            for name, true in case.sized.items():
                if name in cause["parameters"]:
                    value, low, high = (cause["parameters"][name][key] for key in ("value", "low", "high"))
                    found.append((name, value, low, high, low <= true <= high))
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the study and print its table."""
    parser = argparse.ArgumentParser(prog="python -m tests.hardware_causes", description=__doc__)
    parser.add_argument("--draws", type=int, default=3)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="part of a case's name")
    given = parser.parse_args(arguments)
    chosen = [name for name in CASES if given.only in name]
    jobs = [(name, ch, given.seed + k) for name in chosen for ch in (True, False) for k in range(given.draws)]
    console, outcomes = Console(), []
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        for done in pool.map(outcome, jobs):
            outcomes.append(done)
            if not done.right:
                console.print(
                    f"{done.case}, channels {done.channels}, seed {done.seed}: {_said(done)}", highlight=False
                )
    console.print(_table(chosen, outcomes))
    false = sum(bool(one.false) for one in outcomes)
    right = sum(one.right for one in outcomes)
    console.print(
        f"right {right} of {len(outcomes)}; a false name in {false}; missed {sum(o.missing for o in outcomes)}"
    )


def _said(one: Outcome) -> str:
    names = ", ".join(" or ".join(sorted(named)) for named in one.named) or "nothing"
    sizes = "; ".join(f"{n} {v:.4g} [{low:.4g}, {high:.4g}]{'' if ok else ' !'}" for n, v, low, high, ok in one.sized)
    return f"{one.verdict}: {names}" + (f" ({sizes})" if sizes else "")


def _table(chosen: Sequence[str], outcomes: Sequence[Outcome]) -> Table:
    table = Table("cause", "with channels", "angles only", "size (first draw with channels)")
    for name in chosen:
        own = [one for one in outcomes if one.case == name]
        counts = [[o.right for o in own if o.channels is channels] for channels in (True, False)]
        first = next(o for o in own if o.channels)
        sizes = "; ".join(f"{n} {v:.4g} [{low:.4g}, {high:.4g}]" for n, v, low, high, _ in first.sized)
        table.add_row(name, *(f"{sum(c)} of {len(c)}" for c in counts), sizes)
    return table
