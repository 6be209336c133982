"""A recipe of training sweeps, and sweeps simulated from it.

Sweep k is drawn from ``SeedSequence(seed, spawn_key=(k,))`` alone: the number of sweeps, the size of the chunks and
who computes them do not change it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from scenarios.commands.once import check_once
from scenarios.commands.protocol import Protocol
from scenarios.studies.training.draw import Draw, Ranges, draw, drawable, stripped, uniforms_needed
from scenarios.studies.training.row_chain import row_chain
from twin.angles import Array, wrap, wrap_deg
from twin.chain import Chain
from twin.errors import UserError
from twin.extensions import effects_with
from twin.files import from_dict, to_dict
from twin.known_names import nearest
from twin.limits import require_within
from twin.motion import Motion
from twin.presets import read_twin_or_preset


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
    """Simulate the sweeps with these numbers, as built: with noise, integers and words, as a bench records them."""
    streams = [np.random.default_rng(np.random.SeedSequence(recipe.seed, spawn_key=(k,))) for k in numbers]
    uniforms = np.stack([stream.random(uniforms_needed(recipe.causes)) for stream in streams])
    motion = recipe.motion
    drawn = draw(uniforms, recipe.chain, recipe.causes, motion, recipe.ranges)
    chain = row_chain(recipe.chain, drawn.values, streams)
    steps, reference = chain.as_built(motion)
    channels = next(step.before for step in steps if step.key == "after channels")
    error = wrap(steps[-1].after[:, 0] - chain.sensor_sense * chain.output_sense * reference)
    mean = np.angle(np.mean(np.exp(1j * error), axis=1))
    return Block(wrap_deg(np.degrees(error - mean[:, None])), channels, np.degrees(mean), drawn)


def recipe_of(twin: str, *, protocol: Protocol, ranges: Ranges, causes: Sequence[str] = (), seed: int = 0) -> Recipe:
    """The recipe for a twin or preset; without ``causes`` all that the protocol can show. Raises UserError."""
    effects = effects_with()
    motion = protocol.motion()
    visible, provides = drawable(motion, effects), motion.provides
    for name in causes:
        if name not in visible:
            meant = nearest(name, (effect.name for effect in effects))
            lacks = [need for effect in effects if effect.name == name for need in effect.missing(provides)]
            shows = f" (it needs {', '.join(need.replace('|', ' or ') for need in lacks)})" if lacks else ""
            raise UserError(
                f"cause {name!r}{meant} cannot be drawn with this protocol{shows}; expected among {', '.join(visible)}"
            )
    check_once("--cause", causes)
    chosen = tuple(name for name in visible if name in causes) if causes else visible
    for name, (low, high) in (("strength", ranges.strength_deg), ("noise", ranges.noise_deg)):
        require_within(name, [low, high], 1e-6, 5.0, "deg")
        require_within(name, high, low, 5.0, "deg")
    require_within("most-causes", ranges.most, 0, len(visible), whole=True)
    chain = stripped(read_twin_or_preset(twin, effects=effects), chosen)
    return Recipe(twin=to_dict(chain), protocol=protocol, ranges=ranges, causes=chosen, seed=seed)


def parameter_names(recipe: Recipe) -> list[tuple[str, str]]:
    """Effect and parameter of each column of ``parameters``."""
    first = simulate_draw(recipe)
    return [(name, key) for name, params in first.values.items() for key in params]


def simulate_draw(recipe: Recipe) -> Draw:
    """One draw that stands for all: which parameters a recipe has."""
    middle = np.full((1, uniforms_needed(recipe.causes)), 0.5)
    return draw(middle, recipe.chain, recipe.causes, recipe.motion, recipe.ranges)
