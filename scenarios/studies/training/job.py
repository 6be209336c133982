"""The training sweeps as a job of the engine: which sweeps a chunk holds, and its arrays as they are stored."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.studies.study_folder import StudyFolder
from scenarios.studies.training.recipe import Recipe, parameter_names, simulate_block
from scenarios.studies.training.store import write_region

_TOGETHER = 128
"""Sweeps simulated at once: their signals stay in the processor's cache."""


@dataclass(frozen=True, kw_only=True)
class Training:
    """The engine's job: ``sweeps`` sweeps of a recipe in chunks of ``chunk``, with their channels if asked."""

    recipe: Recipe
    sweeps: int
    chunk: int
    channels: bool

    @property
    def chunks(self) -> int:
        """Number of chunks; the last one may be shorter."""
        return -(-self.sweeps // self.chunk)

    def numbers(self, chunk: int) -> range:
        """The sweeps of a chunk."""
        return range(chunk * self.chunk, min((chunk + 1) * self.chunk, self.sweeps))

    def arrays(self, chunk: int) -> dict[str, np.ndarray[Any, Any]]:
        """A chunk's variables, as stored (sweeps, ...): float32, labels and split uint8."""
        numbers = self.numbers(chunk)
        starts = range(numbers.start, numbers.stop, _TOGETHER)
        parts = [self.arrays_of(range(start, min(start + _TOGETHER, numbers.stop))) for start in starts]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def arrays_of(self, numbers: range) -> dict[str, np.ndarray[Any, Any]]:
        """The variables of the sweeps with these numbers, simulated together."""
        block = simulate_block(self.recipe, numbers)
        drawn = block.draw
        parameters = np.stack([drawn.values[name][key] for name, key in parameter_names(self.recipe)], axis=1)
        arrays: dict[str, np.ndarray[Any, Any]] = {
            "error_deg": block.error_deg.astype(np.float32),
            "labels": drawn.labels.astype(np.uint8),
            "strength_deg": drawn.strength_deg.astype(np.float32),
            "parameters": parameters.astype(np.float32),
            "noise_deg": drawn.noise_deg.astype(np.float32),
            "mean_deg": block.mean_deg.astype(np.float32),
            "split": drawn.split.astype(np.uint8),
        }
        if self.channels:
            arrays["channels"] = block.channels.astype(np.float32)
        return arrays

    def write(self, folder: StudyFolder, chunk: int) -> list[Path]:
        """See :class:`scenarios.studies.job.Job`."""
        return write_region(folder, chunk, self.numbers(chunk), self.arrays(chunk))


OPTIONS = {
    "protocol.points": "--points",
    "protocol.turns": "--turns",
    "protocol.both_directions": "--both-directions",
    "protocol.speeds_rpm": "--speed-rpm",
    "protocol.temperatures_c": "--temperatures",
    "ranges.strength_deg": "--strength",
    "ranges.noise_deg": "--noise",
    "ranges.most": "--most-causes",
    "sweeps": "--sweeps",
    "chunk": "--chunk",
    "channels": "--channels",
    "twin": "the twin's",
    # Which causes can be drawn depends on what the shaft does, so this one comes last.
    "causes": "--cause",
}
"""What the settings are called by who gives them."""


def settings_of(job: Training) -> dict[str, Any]:
    """Everything that the store's content depends on, as plain values."""
    recipe = job.recipe
    return {
        "twin": recipe.twin,
        "protocol": {
            name: list(v) if isinstance(v, tuple | list) else v for name, v in asdict(recipe.protocol).items()
        },
        "ranges": {name: list(v) if isinstance(v, tuple) else v for name, v in asdict(recipe.ranges).items()},
        "causes": list(recipe.causes),
        "sweeps": job.sweeps,
        "chunk": job.chunk,
        "channels": job.channels,
    }
