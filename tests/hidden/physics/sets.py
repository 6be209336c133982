"""The sets of physics that a study is made of."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace

from ..generator import Hidden
from ..streams import derived_seed
from .generator import draw
from .kind import Kind
from .kinds import CLEAN, NAMED, OUTSIDE

PHYSICS: dict[str, dict[str, Kind]] = {"physics": NAMED, "physics_clean": CLEAN, "physics_outside": OUTSIDE}


@dataclass(frozen=True)
class PhysicsJob:
    """One recording of one device, as it can be made again."""

    group: str
    label: str
    seed: int
    recording: int = 0

    def draw(self) -> Hidden:
        """Make it."""
        return draw(self.label, seed=self.seed, recording=self.recording)

    def again(self) -> PhysicsJob:
        """Another recording of the same device."""
        return replace(self, recording=self.recording + 1)

    def command(self) -> str:
        """Options of the study command that write this draw to a file."""
        words = f"--make-physics {self.label} --seed {self.seed}"
        return f"{words} --recording {self.recording}" if self.recording else words

    def record(self) -> dict[str, object]:
        """For a JSON file."""
        return asdict(self)


def physics_jobs(group: str, *, draws: int, seed: int, only: frozenset[str] = frozenset()) -> list[PhysicsJob]:
    """`draws` jobs for every kind of a set, or for those of `only`."""
    return [
        PhysicsJob(group, label, derived_seed(seed, group, label, str(number)))
        for label in PHYSICS[group]
        if not only or label in only
        for number in range(draws)
    ]
