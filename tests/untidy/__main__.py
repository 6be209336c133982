"""How many random logs are read rightly, asked back, refused or misread: ``python -m tests.untidy --draws 400``."""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from tests.untidy.drawn_tables import drawn_table
from tests.untidy.mixed import Mixed, drawn, drawn_geared
from twin.errors import UserError
from twin.logs.asked_back import OpenGuess
from twin.logs.read import read_log
from twin.sweep import Sweep


def outcome(seed: int, folder: Path, draw: Callable[[int], Mixed] = drawn) -> str:
    """What becomes of the log of a seed."""
    log = draw(seed)
    path = folder / "log.csv"
    path.write_text(log.text, encoding="utf-8")
    try:
        found = Sweep.from_columns(read_log(path).columns)
    except OpenGuess:
        return "asked back"
    except UserError:
        return "refused"
    return "right" if log.held(found.reference_deg, found.measured_deg) else "wrong"


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=400)
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--tables", action="store_true", help="tables of entries, not logs")
    parser.add_argument("--geared", action="store_true", help="one angle turns several times in a turn of the other")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        seeds = range(1000 * asked.seed, 1000 * asked.seed + asked.draws)
        draw = drawn_table if asked.tables else drawn_geared if asked.geared else drawn
        counted = Counter(outcome(seed, Path(folder), draw) for seed in seeds)
    print(", ".join(f"{counted[word]} {word}" for word in ("right", "asked back", "refused", "wrong")))


if __name__ == "__main__":
    main()
