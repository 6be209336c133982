"""What an answer cannot do without, each part done once, in fits of the baseline to the same rows: for the guide.

``python -m tests.benchmarks.least_cost``: on records of :mod:`tests.benchmarks.long_records`, beside the same fit by
scipy's least_squares. The parts are those of a search that guesses right each time: it looks at every effect once, fits
each cause once and holds it against others once.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from diagnosis import explain
from diagnosis.discovery import pipeline
from diagnosis.discovery.proof.cross_validation import folds, held_out_residuals
from diagnosis.discovery.search.exchange import Search, improve
from diagnosis.discovery.search.forward_step import candidates
from diagnosis.discovery.search.likelihood_ratio import add
from diagnosis.discovery.search.screening import Base, screen_one
from diagnosis.discovery.stages.predictive_check import predictive_check
from diagnosis.discovery.state import Stage, State
from tests.benchmarks.long_records import alone, write
from twin.catalogue import find


def parts(path: Path) -> tuple[dict[str, float], float]:
    """CPU time [s] of each part by name, and of the answer as it is given."""
    states: dict[str, State] = {}
    handed_on = pipeline._handed_on

    def kept(state: State, stage: Stage) -> State:
        states[f"before {stage.__name__}"] = state
        return handed_on(state, stage)

    pipeline._handed_on = kept
    whole, _ = timed(lambda: explain(path))
    pipeline._handed_on = handed_on
    start, end = states["before own_parameters"], states["before answer"]
    final = states["before predictive_check"]
    spent = {}
    spent["every effect looked at once"], _ = timed(lambda: candidates(Base.of(start.fit), start.searched, ()))
    spent["each cause fitted once"], fit = timed(lambda: added(start, end.keys))
    plan = Search.among(start.searched, fit)
    spent["each held against others once"], _ = timed(lambda: improve(fit, end.keys, plan))
    blocks = folds(end.fit, end.keys)
    spent["proof on held-out readings"], _ = timed(lambda: held_out_residuals(end.fit, end.keys, blocks))
    spent["simulated sweeps beside the measured one"], _ = timed(lambda: predictive_check(final))
    return spent, whole


def added(state: State, keys: tuple[str, ...]) -> Any:
    """The baseline with these causes added one after the other, each where first order has it."""
    fit = state.fit
    for key in keys:
        candidate = screen_one(Base.of(fit), find(key))
        if candidate is not None:
            fit, _ = add(fit, candidate)
    return fit


def timed(task: Callable[[], Any]) -> tuple[float, Any]:
    """CPU time [s] of a task, and what it returns."""
    start = time.process_time()
    found = task()
    return time.process_time() - start, found


def imported(*modules: str) -> float:
    """CPU time [s] of a process that imports these, least of three."""
    times = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", f"import sys, {', '.join(modules)}"], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(times)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, nargs="+", default=[1_000, 10_000])
    options = parser.parse_args()
    scipy_alone = imported("scipy.optimize") - imported("time")
    with tempfile.TemporaryDirectory() as folder:
        for rows in options.rows:
            path = Path(folder) / f"{rows}.csv"
            write(rows, path)
            fit_s = alone("fit", path)[0]
            spent, whole = parts(path)
            spent = {"importing scipy.optimize": scipy_alone, **spent}
            print(f"{rows:,} readings, one fit {1e3 * fit_s:.3g} ms; in such fits:")
            for name, seconds in (*spent.items(), ("together", sum(spent.values())), ("explain", whole)):
                print(f"  {name:42s} {seconds / fit_s:7.1f}")


if __name__ == "__main__":
    main()
