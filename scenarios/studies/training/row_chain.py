"""A chain over a batch of sweeps in which each effect touches only the sweeps that have it.

Without this every sweep of a batch would pay for every effect that any of them has; and what is random would be drawn
from one stream for all, so that a sweep would depend on its neighbours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from twin.angles import Array
from twin.chain import Chain
from twin.effect import BoolArray, Effect, Forward, Parameters
from twin.motion import Motion


def row_chain(chain: Chain, values: Mapping[str, Mapping[str, Array]], streams: Sequence[np.random.Generator]) -> Chain:
    """The chain with these parameters, each (batch,), on top of its own; sweep i draws from ``streams[i]`` alone."""
    effects = tuple(replace(effect, forward=_by_row(effect, streams)) for effect in chain.effects)
    merged = {key: {**chain.values.get(key, {}), **params} for key, params in values.items()}
    return replace(chain, effects=effects, values={**chain.values, **merged})


def _by_row(effect: Effect, streams: Sequence[np.random.Generator]) -> Forward:
    batch = len(streams)
    random = effect.footprint in ("spread", "sequence") or bool(effect.roles("random"))

    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        out = np.array(np.broadcast_to(signal, (batch, *signal.shape[-2:])))
        rows = _acting(effect, values, batch)
        if effect.footprint == "values":
            # Words and iterations are whole numbers: sweeps with the same one go through together.
            (level,) = effect.roles("level")
            counts = np.broadcast_to(np.ravel(values[level]), (batch,))
            for count in np.unique(counts[rows]):
                alike = rows & (counts == count)
                out[alike] = effect.forward(out[alike], motion, {**_of_rows(values, alike), level: float(count)}, None)
            return out
        if not random:
            out[rows] = effect.forward(out[rows], motion, _of_rows(values, rows), None)
            return out
        for row in np.flatnonzero(rows).tolist():
            out[row] = effect.forward(out[row : row + 1], motion, _of_rows(values, np.array([row])), streams[row])[0]
        return out

    return forward


def _acting(effect: Effect, values: Parameters, batch: int) -> BoolArray:
    """The sweeps (batch,) in which the effect is not at null."""
    acting = np.zeros(batch, dtype=bool)
    for name in (*effect.roles("strength"), *effect.roles("level"), *effect.roles("random"), *effect.roles("per turn")):
        value = np.asarray(values[name])
        differs = value != effect.params[name].null
        acting |= differs.reshape(batch, -1).any(axis=1) if value.ndim == 3 else bool(np.any(differs))
    return acting


def _of_rows(values: Parameters, rows: Array | BoolArray) -> dict[str, Array | float]:
    return {name: value[rows] if np.ndim(value) == 3 else value for name, value in values.items()}
