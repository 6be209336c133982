"""The command: ``python -m tests.mutations``."""

from __future__ import annotations

import argparse
import json
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

from tests.mutations.mutation import ROOT, Mutation, StaleMutationError, checked
from tests.mutations.runner import ERROR, KILLED, SURVIVED, Outcome, fail_unmutated, try_all
from tests.mutations.tables import mutations


def main(arguments: Sequence[str] | None = None, *, root: Path = ROOT) -> int:
    """Try the mutations asked for; 0 where every one is killed, 1 where not, 2 where one cannot be tried."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutations", description="Does a test notice each mutation?")
    parser.add_argument("--only", action="append", metavar="NAME", help="names that begin so; may be given repeatedly")
    parser.add_argument("--workers", type=int, default=1, help="copies of the tree that are tried side by side")
    parser.add_argument("-o", "--output", type=Path, metavar="JSON", help="write the results to this file")
    parser.add_argument("--list", action="store_true", help="list the mutations, try none")
    asked = parser.parse_args(arguments)
    try:
        chosen = _chosen(checked(mutations(), root), asked.only)
    except StaleMutationError as stale:
        print(stale, file=sys.stderr)
        return 2
    if asked.list:
        for mutation in chosen:
            print(f"{mutation.name:40} {mutation.file:50} {' '.join(mutation.tests)}")
        return 0
    # An end by a signal leaves no files behind either.
    previous = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        return _tried(chosen, root=root, workers=max(asked.workers, 1), output=asked.output)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return 130
    finally:
        signal.signal(signal.SIGTERM, previous)


def _chosen(known: Sequence[Mutation], only: Sequence[str] | None) -> list[Mutation]:
    if only is None:
        return list(known)
    for name in only:
        if not any(mutation.name.startswith(name) for mutation in known):
            raise StaleMutationError(f"no mutation's name begins with {name!r}; --list shows them all")
    return [mutation for mutation in known if any(mutation.name.startswith(name) for name in only)]


def _tried(chosen: Sequence[Mutation], *, root: Path, workers: int, output: Path | None) -> int:
    print(f"{len(chosen)} mutations; first their tests in a tree without one", flush=True)
    said = fail_unmutated(chosen, root=root)
    if said is not None:
        print(f"{said}\na test fails without a mutation, so it would notice nothing", file=sys.stderr)
        return 2
    count = 0

    def tell(outcome: Outcome) -> None:
        nonlocal count
        count += 1
        print(
            f"{count:4}/{len(chosen)} {outcome.result:8} {outcome.seconds:6.1f} s  {outcome.mutation.name}", flush=True
        )
        if outcome.result == ERROR:
            print(outcome.said, file=sys.stderr)

    outcomes = try_all(chosen, root=root, workers=workers, done=tell)
    if output is not None:
        output.write_text(json.dumps([_record(outcome) for outcome in outcomes], indent=1) + "\n", encoding="utf-8")
    counts = {result: sum(o.result == result for o in outcomes) for result in (KILLED, SURVIVED, ERROR)}
    print(", ".join(f"{number} {result}" for result, number in counts.items()))
    for outcome in outcomes:
        if outcome.result == SURVIVED:
            print(f"survived: {outcome.mutation.name} ({outcome.mutation.file})")
    return 0 if counts[KILLED] == len(outcomes) else 1


def _record(outcome: Outcome) -> dict[str, object]:
    """For a JSON file."""
    mutation = outcome.mutation
    return {
        "name": mutation.name,
        "file": mutation.file,
        "result": outcome.result,
        "seconds": round(outcome.seconds, 2),
        "tests": list(mutation.tests),
    }


if __name__ == "__main__":
    sys.exit(main())
