"""The command: ``python -m tests.fuzz``."""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from tests.fuzz.batch import Failure, batch, plain_mb

KINDS = {
    "sweeps": 20_000,
    "explain": 2_000,
    "doctor": 5_000,
    "export": 500,
    "twins": 5_000,
    "logs": 1_000,
    "options": 500,
}
"""How many of each are tried unless told otherwise."""
_BATCH = 25
_TOLD = 1000
_BATCHES_A_PROCESS = 40


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the inputs asked for; 0 where each ended in an answer or in one line, else 1."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    for kind, count in KINDS.items():
        parser.add_argument(f"--{kind}", type=int, default=count, metavar="N", help=f"how many (default: {count})")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="number of the first input: to go on")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes")
    parser.add_argument("-o", "--output", type=Path, default=Path("fuzz_failures"), help="folder for inputs that fail")
    asked = parser.parse_args(arguments)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    failed = 0
    for kind in KINDS:
        failed += _tried(kind, getattr(asked, kind), asked)
    return 1 if failed else 0


def _tried(kind: str, count: int, asked: argparse.Namespace) -> int:
    """Try so many inputs of a kind, say how they ended, keep those that failed; returns how many that were."""
    if count < 1:
        return 0
    counts: Counter[str] = Counter()
    for how, failures in _outcomes(kind, range(asked.first, asked.first + count), asked):
        counts.update(how)
        for failure in failures:
            print(f"{failure.keep(asked.output)}: {failure.said.strip().splitlines()[-1][:150]}", flush=True)
        if sum(counts.values()) % _TOLD == 0:
            print(f"{kind}: {sum(counts.values())} of {count}, {counts['failed']} failed", flush=True)
    told = ", ".join(f"{number} {how}" for how, number in sorted(counts.items()))
    print(f"{kind}: {sum(counts.values())} tried from number {asked.first}, {told}", flush=True)
    return counts["failed"]


def _outcomes(kind: str, numbers: range, asked: argparse.Namespace) -> Iterator[tuple[list[str], list[Failure]]]:
    batches = [list(numbers[k : k + _BATCH]) for k in range(0, len(numbers), _BATCH)]
    with _pool(1) as pool:
        plain = pool.submit(plain_mb).result()
    work = partial(batch, kind, seed=asked.seed, plain=plain)
    # A process tries some batches: the most memory that it ever held is that of one of them. A pool's own way to
    # replace its processes can leave it without any (max_tasks_per_child, CPython's issue 115634).
    together = _BATCHES_A_PROCESS * asked.jobs
    for start in range(0, len(batches), together):
        with _pool(asked.jobs) as pool:
            yield from pool.map(work, batches[start : start + together])


def _pool(jobs: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(jobs, mp_context=get_context("spawn"))


if __name__ == "__main__":
    sys.exit(main())
