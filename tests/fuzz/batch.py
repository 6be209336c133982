"""Some inputs tried one after the other in a process of their own, whose memory is watched."""

from __future__ import annotations

import resource
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

_ADDRESS_SPACE_GB = 4


@dataclass(frozen=True)
class Failure:
    """An input that ended in neither an answer nor one line."""

    kind: str
    number: int
    said: str
    ending: str
    raw: bytes

    def keep(self, folder: Path) -> Path:
        """Write the input, and beside it what was said."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"{self.kind}_{self.number:06}{self.ending}"
        path.write_bytes(self.raw)
        path.with_suffix(path.suffix + ".said").write_text(self.said, encoding="utf-8", errors="replace")
        return path


def batch(kind: str, numbers: Sequence[int], *, seed: int, plain: float) -> tuple[list[str], list[Failure]]:
    """Try some inputs one after the other: how each ended, and those that failed."""
    from tests.fuzz.calls import FAILED, trial
    from tests.fuzz.trial import MemoryWatch

    resource.setrlimit(resource.RLIMIT_AS, (_ADDRESS_SPACE_GB << 30, resource.getrlimit(resource.RLIMIT_AS)[1]))
    watch = MemoryWatch(plain_mb=plain)
    how, failures = [], []
    for number in numbers:
        ended, ending, raw = trial(kind, number, seed)
        ended = watch.judged(ended)
        how.append(ended.how)
        if ended.how == FAILED:
            failures.append(Failure(kind, number, ended.said, ending, raw))
    return how, failures


def plain_mb() -> float:
    """The memory of this process once it has explained an ordinary sweep."""
    from diagnosis import explain
    from tests.fuzz.trial import peak_mb

    explain(Path(__file__).parents[2] / "scenarios/data/bench_sweep.csv")
    return peak_mb()
