"""What raw channels show never makes an answer worse: each sweep is asked about with vx, vy and without.

python -m tests.hidden.channels --draws 3 --seed 7
python -m tests.hidden.channels --only tanh,universal_joint --draws 1 --seed 7
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .generator import Hidden
from .physics.kinds import KINDS
from .physics.sets import PHYSICS, PhysicsJob, physics_jobs
from .scoring import VERDICTS, verdict
from .study import DEFAULT_ANSWERER, Answerer, load

CHANNELS = ("vx", "vy")


@dataclass(frozen=True)
class Compared:
    """The verdicts on one sweep, and the names that were given with its channels."""

    job: PhysicsJob
    with_them: str
    without: str
    names: tuple[str, ...]

    @property
    def worse(self) -> bool:
        """Whether the channels made the answer worse."""
        return VERDICTS.index(self.with_them) > VERDICTS.index(self.without)


def compared(job: PhysicsJob, hidden: Hidden, folder: Path, answerer: Answerer) -> Compared:
    """Ask about a sweep with its channels, then without."""
    bare = replace(hidden, columns={name: one for name, one in hidden.columns.items() if name not in CHANNELS})
    answers: list[Mapping[str, Any]] = []
    for sweep in (hidden, bare):
        sweep.write_csv(folder / "sweep.csv")
        answers.append(answerer(str(folder / "sweep.csv")))
    said, plain = (verdict(answer, hidden.truth) for answer in answers)
    return Compared(job, said, plain, tuple(entry["name"] for entry in answers[0]["causes"]))


def every(*, only: frozenset[str], draws: int, seed: int) -> Iterator[tuple[PhysicsJob, Hidden]]:
    """The draws of all kinds of physics, or of `only` these, that have channels."""
    for group in PHYSICS:
        for job in physics_jobs(group, draws=draws, seed=seed, only=only):
            hidden = job.draw() if KINDS[job.label].channels is not False else None
            if hidden is not None and set(CHANNELS) <= set(hidden.columns):
                yield job, hidden


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; 1 where channels made an answer worse."""
    made = argparse.ArgumentParser(prog="python -m tests.hidden.channels", description=__doc__.splitlines()[0])
    made.add_argument("--only", default="", help="comma-separated kinds of physics to keep")
    made.add_argument("--draws", type=int, default=3, help="draws of each kind")
    made.add_argument("--seed", type=int, default=1)
    made.add_argument("--answerer", default=DEFAULT_ANSWERER, help="module:function, path -> dict")
    options = made.parse_args(arguments)
    only = frozenset(options.only.split(",")) - {""}
    answerer, worse, better, total = load(options.answerer), 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for job, hidden in every(only=only, draws=options.draws, seed=options.seed):
            one = compared(job, hidden, Path(folder), answerer)
            total, worse = total + 1, worse + one.worse
            better += VERDICTS.index(one.with_them) < VERDICTS.index(one.without)
            if one.worse:
                print(f"worse: {one.without} -> {one.with_them}, {', '.join(one.names)}: {job.command()}", flush=True)
    print(f"{total} sweeps with vx, vy: {better} answered better than without, {worse} worse")
    return int(worse > 0)


if __name__ == "__main__":
    raise SystemExit(main())
