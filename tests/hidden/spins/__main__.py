"""Judge what a tool makes of spins without a reference.

python -m tests.hidden.spins --protocol coast,two_speeds,one_speed --draws 100 --seed 7 -o spins.json
python -m tests.hidden.spins --set causes --draws 20 --seed 7 -o causes.json
python -m tests.hidden.spins --set clean --draws 100 --seed 7 -o clean.json
python -m tests.hidden.spins --make coast --seed 1234 --causes saturation -o folder

A study that is stopped goes on where it stood when it is asked again with the same file. The last form writes the logs
of one draw and its truth, with the seed that the study's file holds.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from .benches import PROTOCOLS
from .generator import draw
from .sets import Job, clean, of_causes, of_protocols
from .study import DEFAULT_ANSWERER, run
from .tables import print_all


def parser() -> argparse.ArgumentParser:
    """Options of the command."""
    made = argparse.ArgumentParser(prog="python -m tests.hidden.spins", description="Judge spins without a reference.")
    made.add_argument("--set", default="accuracy", choices=("accuracy", "causes", "clean"))
    made.add_argument("--protocol", default="coast,two_speeds,one_speed", help=f"of {', '.join(PROTOCOLS)}")
    made.add_argument("--usb", action="store_true", help="all stamps are those of frames of 1 ms")
    made.add_argument("--only", default="", help="comma-separated causes to keep")
    made.add_argument("--draws", type=int, default=10, help="draws of each protocol or cause")
    made.add_argument("--seed", type=int, default=1)
    made.add_argument("--jobs", type=int, default=1, help="processes")
    made.add_argument("--answerer", default=DEFAULT_ANSWERER, help="module:function; '' asks the others alone")
    made.add_argument("--make", metavar="PROTOCOL", help="write the logs of one draw into the folder of -o")
    made.add_argument("--causes", help="of --make: names joined by +, or clean; without, a hard bench")
    made.add_argument("-o", "--output", type=Path, help="JSON of the study, or folder of the draw")
    return made


def jobs_of(options: argparse.Namespace) -> list[Job]:
    """What is to be drawn."""
    if options.set == "causes":
        only = frozenset(name for name in options.only.split(",") if name)
        return of_causes(draws=options.draws, seed=options.seed, only=only)
    if options.set == "clean":
        return clean(draws=options.draws, seed=options.seed)
    protocols = tuple(options.protocol.split(","))
    return of_protocols(protocols, draws=options.draws, seed=options.seed, usb=options.usb)


def _make(options: argparse.Namespace) -> None:
    """One draw's logs, its truth and its error over the turn."""
    named = options.causes
    causes = None if named is None else tuple(name for name in named.split("+") if name not in ("", "clean"))
    drawn = draw(options.make, seed=options.seed, causes=causes, usb=options.usb)
    folder = options.output or Path()
    folder.mkdir(parents=True, exist_ok=True)
    drawn.write(folder)
    (folder / "truth.json").write_text(json.dumps(drawn.truth, indent=1) + "\n", encoding="utf-8")
    rows = (f"{at:.4f},{off:.6f}" for at, off in zip(drawn.at_rest.shaft_deg, drawn.at_rest.error_deg, strict=True))
    (folder / "error.csv").write_text("\n".join(["shaft_deg,error_deg", *rows]) + "\n", encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    """The command."""
    options = parser().parse_args(arguments)
    if options.make is not None:
        _make(options)
        return 0
    console = Console()
    todo = jobs_of(options)
    records = []
    with console.status("drawing") as status:
        for record in run(todo, answerer=options.answerer, processes=options.jobs, kept=options.output):
            records.append(record)
            status.update(f"{len(records)} of {len(todo)}")
    print_all(console, records)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
