"""Judge what is said of batches of devices.

python -m tests.hidden.fleets --set shared --noise white --draws 25 --seed 7 -o fleets.jsonl
python -m tests.hidden.fleets --set clean --noise white,ar1,pink --draws 100 --seed 7 -o fleets.jsonl
python -m tests.hidden.fleets --set odd --count 10000 --seed 7 -o fleets.jsonl
python -m tests.hidden.fleets --make folder --count 10000 --seed 7

A study that is stopped goes on where it stood when it is asked again with the same file. The last form writes the files
of the batch with ten odd devices, for ``halltwin fleet``, and prints which they are.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from ...kept import Kept, share
from .generator import write
from .study import CAUSES, limit_deg, odd_batch, population, run, trials


def main() -> None:
    """Run what the options ask for."""
    parser = argparse.ArgumentParser(prog="python -m tests.hidden.fleets", description="Judge batches of devices.")
    parser.add_argument("--set", default="shared", choices=("shared", "clean", "odd"))
    parser.add_argument("--noise", default="white", help="of white, ar1, pink, with commas")
    parser.add_argument("--draws", type=int, default=10, help="batches of each cause, or clean ones")
    parser.add_argument("--sweeps", type=int, default=6, help="devices that are explained at each strength")
    parser.add_argument("--count", type=int, default=10_000, help="devices of the batch with odd ones")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--make", type=Path, metavar="FOLDER", help="write the batch with odd devices here")
    parser.add_argument("-o", "--output", type=Path, help="file that outcomes are kept in")
    options = parser.parse_args()
    kept = Kept.read(options.output)
    if options.make is not None or options.set == "odd":
        odd(options)
        return
    for noise in options.noise.split(","):
        limits = {}
        if options.set == "shared":
            for cause in CAUSES:
                limits[cause] = limit_deg(cause, noise, seed=options.seed, sweeps=options.sweeps, kept=kept)
                print(f"{noise}, {cause}: named on half of the single devices from {limits[cause]:.4f} deg on")
        tried = list(trials(options.set, noise=noise, draws=options.draws, seed=options.seed, limits=limits))
        found = run(tried, kept)
        for cause in CAUSES if options.set == "shared" else ():
            of_cause = [one for one in found if one["cause"] == cause]
            print(f"{noise}, {cause}: found in {share(sum(one['found'] for one in of_cause), len(of_cause))}")
        for what, key in (("a false cause", "false"), ("a device apart", "apart"), ("a change", "changes")):
            print(f"{noise}: {what} in {share(sum(bool(one[key]) for one in found), len(found))} batches")


def odd(options: argparse.Namespace) -> None:
    """The batch with ten odd devices: written, or asked about."""
    plan = odd_batch(options.count, seed=options.seed)
    if options.make is not None:
        write(plan, options.make, seed=options.seed)
        for place, (what, size) in sorted(plan.odd.items()):
            print(f"device {place + 1}: {what} {size:.3g}")
        return
    start = time.process_time()
    found = population(plan, seed=options.seed)
    apart = {one.device for one in found.apart}
    print(f"{len(apart & set(plan.odd))} of {len(plan.odd)} odd devices found, {len(apart - set(plan.odd))} others")
    print(f"{options.count / (time.process_time() - start):.0f} devices a second of one core, drawn ones included")


if __name__ == "__main__":
    main()
