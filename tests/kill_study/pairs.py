"""Two commands in one folder at once."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import numpy as np

from tests.kill_study.trials import Command, Tell, Trial, ended

APART_S = 0.5
"""The second starts at most so much later: while the first makes its folder, or begins its work."""


def pair(command: Command, work: Path, calm: Path, *, number: int, tell: Tell) -> None:
    """Start a command twice; the folder must end as if one of them had run alone."""
    place = work / f"pair-{number}"
    apart = np.random.default_rng((number, *command.name.encode())).uniform(0.0, APART_S)
    first = command.start(place)
    time.sleep(apart)
    second = command.start(place)
    both = [ended(first), ended(second)]
    difference = command.difference(place, calm)
    good = any(one.code == 0 for one in both) and all(one.code == 0 or one.refused for one in both) and not difference
    refusals = [one.last_line for one in both if one.refused]
    failures = [one.last_line for one in both if one.code != 0 and not one.refused]
    outcome = difference or "".join(failures) or f"{len(refusals)} refused, equal"
    tell(Trial(command.name, "pair", f"{apart:.2f} s apart", outcome, good))
    if good:
        shutil.rmtree(place)
