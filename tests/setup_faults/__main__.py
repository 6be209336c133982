"""``python -m tests.setup_faults --draws N --seed S``: how many faults of a set-up ``doctor`` names.

And of how many clean logs it says that something is wrong.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np

from tests.setup_faults.faults import CLEAN, EVERY, FAULTS, Fault
from tests.setup_faults.formats import write


def found_in(path: Path) -> list[str]:
    """The kinds that the program finds in a log."""
    from diagnosis.setup.of_log import read_record
    from diagnosis.setup.several_readings import checked_log

    read = read_record(path, name=path.name)
    return [finding.kind for finding in checked_log(read).findings]


def trial(fault: Fault, rng: np.random.Generator, folder: Path) -> tuple[str, list[str]]:
    """One log with a fault: its format and what is found in it."""
    form = str(rng.choice(fault.formats))
    bench = fault.make(rng)
    path = write(bench, form, folder, keep=fault.named == ("units",))
    return form, found_in(path)


def main() -> None:
    """Draw, ask, count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=50, help="logs of each fault")
    parser.add_argument("--clean", type=int, default=None, help="logs without a fault; four times as many if not given")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default=None, help="a fault by its name")
    parser.add_argument("--show", action="store_true", help="print each log that is not named")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for name, fault in FAULTS.items():
            if options.only in (None, name):
                _count(name, fault, options, Path(folder))
        if options.only in (None, "clean"):
            many = 4 * options.draws if options.clean is None else options.clean
            _count("clean", CLEAN, argparse.Namespace(**{**vars(options), "draws": many}), Path(folder))


def _count(name: str, fault: Fault, options: argparse.Namespace, folder: Path) -> None:
    named, beside = 0, Counter[str]()
    for draw in range(options.draws):
        rng = np.random.default_rng([options.seed, sorted([*FAULTS, "clean"]).index(name), draw])
        form, found = trial(fault, rng, folder)
        right = any(kind in fault.named for kind in found) if fault.named else not found
        named += right
        beside.update(kind for kind in set(found) if kind not in fault.named)
        if options.show and not right:
            print(f"   {name} draw {draw} as {form}: {', '.join(found) or 'nothing'}")
    also = ", ".join(f"{kind} {count}" for kind, count in beside.most_common(6))
    print(f"{name:22} {named:4} of {options.draws}{f'   also {also}' if also else ''}", flush=True)


__all__ = ["EVERY", "found_in", "trial"]

if __name__ == "__main__":
    main()
