"""``halltwin generate``: labelled training sweeps of a twin, as many as asked for, in a Zarr store.

Sweep k is drawn from ``SeedSequence(seed, spawn_key=(k,))`` alone: the number of sweeps, the size of the chunks and
who computes them do not change it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from scenarios.commands.protocol import Protocol
from scenarios.commands.row_chain import row_chain
from scenarios.studies.engine import run_study
from scenarios.studies.machines import Machines
from scenarios.studies.study_folder import StudyFolder
from scenarios.studies.training.draw import Draw, Ranges, draw, drawable, stripped, uniforms_needed
from twin.angles import Array, wrap, wrap_deg
from twin.chain import Chain
from twin.errors import UserError
from twin.extensions import effects_with
from twin.files import from_dict, to_dict
from twin.limits import require_within
from twin.motion import Motion
from twin.presets import read_twin_or_preset

STORE = "sweeps.zarr"
_TOGETHER = 128
"""Sweeps simulated at once: their signals stay in the processor's cache."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """Everything that a sweep depends on besides its number. ``twin`` is a twin file's content, which pickles."""

    twin: Mapping[str, Any]
    protocol: Protocol
    ranges: Ranges
    causes: tuple[str, ...]
    seed: int

    @cached_property
    def chain(self) -> Chain:
        """The twin that sweeps are drawn around."""
        return from_dict(self.twin, effects=effects_with())

    @cached_property
    def motion(self) -> Motion:
        """The shaft's motion, the same for every sweep."""
        return self.protocol.motion()

    def __getstate__(self) -> dict[str, Any]:
        """Without what is derived: chains do not pickle, and need not."""
        return {item.name: getattr(self, item.name) for item in fields(self)}


@dataclass(frozen=True, eq=False)
class Block:
    """Sweeps side by side: errors (batch, n) and channels (batch, 2, n), with what was drawn for them.

    ``error_deg`` is measured minus reference, in the sense that the two count together, about its circular mean
    ``mean_deg`` (batch,).
    """

    error_deg: Array
    channels: Array
    mean_deg: Array
    draw: Draw


def simulate_block(recipe: Recipe, numbers: range) -> Block:
    """Simulate the sweeps with these numbers."""
    streams = [np.random.default_rng(np.random.SeedSequence(recipe.seed, spawn_key=(k,))) for k in numbers]
    uniforms = np.stack([stream.random(uniforms_needed(recipe.causes)) for stream in streams])
    motion = recipe.motion
    drawn = draw(uniforms, recipe.chain, recipe.causes, motion, recipe.ranges)
    chain = row_chain(recipe.chain, drawn.values, streams)
    channels = measured = None
    for step in chain.steps(motion):
        if step.key == "after channels":
            channels = step.before
        measured = step.after
    assert channels is not None
    assert measured is not None
    slope = chain.sensor_sense * chain.output_sense
    error = wrap(measured[:, 0] - slope * chain.reference(motion))
    mean = np.angle(np.mean(np.exp(1j * error), axis=1))
    return Block(wrap_deg(np.degrees(error - mean[:, None])), channels, np.degrees(mean), drawn)


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
        parts = [self._part(range(start, min(start + _TOGETHER, numbers.stop))) for start in starts]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def _part(self, numbers: range) -> dict[str, np.ndarray[Any, Any]]:
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

    def write(self, folder: StudyFolder, chunk: int) -> None:
        """See :class:`scenarios.studies.job.Job`."""
        from scenarios.studies.training.store import write_region

        write_region(folder.path / STORE, self.numbers(chunk), self.arrays(chunk))


def parameter_names(recipe: Recipe) -> list[tuple[str, str]]:
    """Effect and parameter of each column of ``parameters``."""
    first = simulate_draw(recipe)
    return [(name, key) for name, params in first.values.items() for key in params]


def simulate_draw(recipe: Recipe) -> Draw:
    """One draw that stands for all: which parameters a recipe has."""
    middle = np.full((1, uniforms_needed(recipe.causes)), 0.5)
    return draw(middle, recipe.chain, recipe.causes, recipe.motion, recipe.ranges)


def recipe_of(twin: str, *, protocol: Protocol, ranges: Ranges, causes: Sequence[str] = (), seed: int = 0) -> Recipe:
    """The recipe for a twin or preset; without ``causes`` all that the protocol can show. Raises UserError."""
    visible = drawable(protocol.motion())
    for name in causes:
        if name not in visible:
            raise UserError(f"cause {name!r} cannot be drawn with this protocol; expected among {', '.join(visible)}")
    chosen = tuple(name for name in visible if name in causes) if causes else visible
    for name, (low, high) in (("strength", ranges.strength_deg), ("noise", ranges.noise_deg)):
        require_within(name, [low, high], 1e-6, 5.0, "deg")
        require_within(name, high, low, 5.0, "deg")
    require_within("most-causes", ranges.most, 0, len(visible), whole=True)
    chain = stripped(read_twin_or_preset(twin, effects=effects_with()), chosen)
    return Recipe(twin=to_dict(chain), protocol=protocol, ranges=ranges, causes=chosen, seed=seed)


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


def generate(job: Training, output: Path, machines: Machines) -> StudyFolder:
    """Write the store, or finish one that was begun. Raises UserError."""
    from scenarios.studies.training.store import create

    settings = settings_of(job)
    folder = StudyFolder.open(output, study="training", seed=job.recipe.seed, settings=settings)
    create(folder.path / STORE, job, settings)
    run_study(job, folder, chunks=job.chunks, items=job.sweeps, unit="sweeps", machines=machines)
    return folder


def run(
    twin: str,
    output: Path,
    *,
    sweeps: int,
    chunk: int,
    channels: bool,
    protocol: Protocol,
    ranges: Ranges,
    causes: Sequence[str],
    machines: Machines,
    seed: int,
) -> None:
    """The command."""
    import time

    require_within("sweeps", sweeps, 1, 1e9, whole=True)
    require_within("chunk", chunk, 1, 1e6, whole=True)
    recipe = recipe_of(twin, protocol=protocol, ranges=ranges, causes=causes, seed=seed)
    job = Training(recipe=recipe, sweeps=sweeps, chunk=chunk, channels=channels)
    start = time.perf_counter()
    folder = generate(job, output, machines)
    took = time.perf_counter() - start
    size = sum(item.stat().st_size for item in (folder.path / STORE).rglob("*") if item.is_file())
    print(
        f"wrote {output / STORE}: {sweeps} sweeps of {len(recipe.motion)} readings, {len(recipe.causes)} causes, "
        f"{size / sweeps:.0f} bytes a sweep, {took:.1f} s"
    )
