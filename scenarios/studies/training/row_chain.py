"""A chain over a batch of sweeps in which each effect touches only the sweeps that have it.

Without this every sweep of a batch would pay for every effect that any of them has; and what is random would be drawn
from one stream for all, so that a sweep would depend on its neighbours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from twin.angles import Array
from twin.chain import Chain, Step
from twin.effect import BoolArray, Effect, Forward, Parameters
from twin.motion import Motion
from twin.operations import with_forwards


@dataclass(frozen=True, eq=False, repr=False)
class RowChain(Chain):
    """A chain over many sweeps, of which sweep i draws from ``streams[i]`` alone."""

    streams: Sequence[np.random.Generator] = ()

    @property
    def described(self) -> tuple[Effect, ...]:
        """The described parts, each sweep's noise from its own stream."""
        return tuple(_by_row(part, self.streams) for part in super().described)

    def as_built(self, motion: Motion) -> tuple[list[Step], Array]:
        """Every operation of a run as a bench records it, and the recorded reference [rad] (sweeps, n)."""
        # Whoever draws has a stream of each sweep; of this one nothing is drawn.
        built = np.random.default_rng(0)
        steps = list(self.steps(motion, built))
        reference = np.broadcast_to(self.reference(motion, built), (len(self.streams), len(motion)))
        if self.encoder is None:
            return steps, reference
        return steps, np.stack([self.encoder.read(reading) for reading in reference])


def row_chain(
    chain: Chain, values: Mapping[str, Mapping[str, Array]], streams: Sequence[np.random.Generator]
) -> RowChain:
    """The chain with these parameters, each (batch,), on top of its own; sweep i draws from ``streams[i]`` alone."""
    own = {item.name: getattr(chain, item.name) for item in fields(Chain)}
    effects = tuple(_by_row(effect, streams) for effect in chain.effects)
    merged = {key: {**chain.values.get(key, {}), **params} for key, params in values.items()}
    return RowChain(**{**own, "effects": effects, "values": {**chain.values, **merged}}, streams=streams)


def _by_row(effect: Effect, streams: Sequence[np.random.Generator]) -> Effect:
    return with_forwards(effect, lambda one: _forward_by_row(one, streams))


def _forward_by_row(effect: Effect, streams: Sequence[np.random.Generator]) -> Forward:
    batch = len(streams)
    random = effect.footprint in ("spread", "sequence") or bool(effect.roles("random"))

    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        rows = _acting(effect, values, batch)
        if not random and rows.all():
            return effect.forward(signal, motion, values, rng)
        out = np.array(np.broadcast_to(signal, (batch, *signal.shape[-2:])))
        if not random:
            out[rows] = effect.forward(out[rows], motion, _of_rows(values, rows), rng)
            return out
        for row in np.flatnonzero(rows).tolist():
            out[row] = effect.forward(out[row : row + 1], motion, _of_rows(values, np.array([row])), streams[row])[0]
        return out

    return forward


def _acting(effect: Effect, values: Parameters, batch: int) -> BoolArray:
    """The sweeps (batch,) in which the effect is not at null; a described part, without parameters, acts in all."""
    acting = np.full(batch, not effect.params)
    for name in effect.acts_by:
        value = np.asarray(values[name])
        differs = value != effect.params[name].null
        acting |= differs.reshape(batch, -1).any(axis=1) if value.ndim == 3 else bool(np.any(differs))
    return acting


def _of_rows(values: Parameters, rows: Array | BoolArray) -> dict[str, Array | float]:
    return {name: value[rows] if np.ndim(value) == 3 else value for name, value in values.items()}
