"""Rate-independent memory of the concentrator: stacks of plays and Preisach's relays."""

from __future__ import annotations

import numpy as np

from ..baseline import Setting
from ..channel_causes import Channels
from ..motion import Array
from .device import Mechanism
from .kind import Planned

LEAD_IN = 400
"""Rows of the circle that a material has run through before the first reading."""


def _with_history(field: Channels) -> Array:
    """The field's path, a full circle in the direction of the first rows put ahead of it; shape (n + LEAD_IN, 2)."""
    path = np.stack(field, axis=1)
    angle = np.unwrap(np.arctan2(path[:8, 1], path[:8, 0]))
    way = 1.0 if angle[-1] > angle[0] else -1.0
    before = angle[0] - way * 2 * np.pi * np.arange(LEAD_IN, 0, -1) / LEAD_IN
    radius = np.hypot(*path[0])
    return np.concatenate([radius * np.stack([np.cos(before), np.sin(before)], axis=1), path])


def scalar_plays(path: Array, radius: Array) -> Array:
    """Each axis of a path (n, 2) through plays of these radii (k,): shape (n, 2, k)."""
    state = np.repeat(path[0][:, None], len(radius), axis=1)
    out = np.empty((*path.shape, len(radius)))
    for row, at in enumerate(path):
        state = np.clip(state, at[:, None] - radius, at[:, None] + radius)
        out[row] = state
    return out


def vector_plays(path: Array, radius: Array) -> Array:
    """A path (n, 2) through vector plays: each state is drawn along once the field is a radius away; (n, 2, k)."""
    state = np.repeat(path[0][:, None], len(radius), axis=1)
    out = np.empty((*path.shape, len(radius)))
    for row, at in enumerate(path):
        away = at[:, None] - state
        length = np.hypot(*away)
        state = state + away * np.where(length > radius, 1.0 - radius / np.maximum(length, 1e-12), 0.0)
        out[row] = state
    return out


def relays(path: Array, centre: Array, half: Array) -> Array:
    """Preisach's relays, on above centre + half and off below centre - half: mean over all of them; shape (n, 2)."""
    up, down = (centre[:, None] + half).ravel(), (centre[:, None] - half).ravel()
    state = np.where(path[0][:, None] > 0.5 * (up + down), 1.0, -1.0)
    out = np.empty_like(path)
    for row, at in enumerate(path):
        state = np.where(at[:, None] >= up, 1.0, np.where(at[:, None] <= down, -1.0, state))
        out[row] = state.mean(axis=1)
    return out


def _stack(rng: np.random.Generator, vector: bool) -> Planned:
    radius = np.sort(rng.uniform(0.02, 0.25, 5))
    lag = float(rng.uniform(0.06, 0.2))
    weight = rng.uniform(0.5, 1.5, 5)
    # a play of radius r behind a unit vector lags by asin(r); on an axis by 4 r / pi in the mean over a turn
    weight *= np.radians(lag) / float(weight @ (radius if vector else radius * 4 / np.pi))

    def lagging(field: Channels) -> Channels:
        path = _with_history(field)
        held = (vector_plays if vector else scalar_plays)(path, radius) @ weight
        out = ((1.0 - weight.sum()) * path + held)[LEAD_IN:]
        return out[:, 0], out[:, 1]

    return Planned(Mechanism(disk=lagging) if vector else Mechanism(plates=lagging), lag)


def vector_stack(rng: np.random.Generator, setting: Setting) -> Planned:
    """A stack of vector plays."""
    return _stack(rng, vector=True)


def scalar_stack(rng: np.random.Generator, setting: Setting) -> Planned:
    """A stack of plays on each axis."""
    return _stack(rng, vector=False)


def preisach(rng: np.random.Generator, setting: Setting) -> Planned:
    """Preisach's relays on each axis, spread evenly over the field."""
    lag, half = float(rng.uniform(0.06, 0.2)), np.linspace(0.02, float(rng.uniform(0.1, 0.3)), 6)
    centre = np.linspace(-1.2, 1.2, 241)
    # the mean of relays of one width is the play of that radius over 1.2
    share = 1.2 * np.radians(lag) / float(np.mean(half) * 4 / np.pi)

    def lagging(field: Channels) -> Channels:
        path = _with_history(field)
        out = ((1.0 - share / 1.2) * path + share * relays(path, centre, half))[LEAD_IN:]
        return out[:, 0], out[:, 1]

    return Planned(Mechanism(plates=lagging), lag)
