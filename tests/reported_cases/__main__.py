"""``python -m tests.reported_cases --draws N --seed S``: sweeps of the kinds that people report, named rightly."""

from __future__ import annotations

import argparse
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from tests.reported_cases.kinds import KINDS
from tests.reported_cases.trial import trial


def main() -> None:
    """Draw, ask, count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=50, help="sweeps of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--only", default=None, help="kinds by their names, comma-separated")
    parser.add_argument("--keep", type=Path, default=None, help="write draw --draws of the kind --only to this file")
    options = parser.parse_args()
    names = [name for name in KINDS if options.only is None or name in options.only.split(",")]
    if options.keep is not None:
        print(trial((names[0], options.seed, options.draws), options.keep))
        return
    jobs = [(name, options.seed, number) for name in names for number in range(options.draws)]
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        told = list(pool.map(trial, jobs))
    for name in names:
        here = [one for one in told if one.kind == name]
        print(f"{name:20} {sum(one.right for one in here):4} of {len(here)}", flush=True)
        for said, many in Counter(one.said for one in here if not one.right).most_common():
            draws = ", ".join(str(one.number) for one in here if one.said == said and not one.right)
            print(f"    {many} {said} (draws {draws})")


if __name__ == "__main__":
    main()
