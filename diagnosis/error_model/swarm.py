"""The paper's modified particle swarm (Eq. 8-11), for many sweeps at once.

Printed as: velocity = inertia x velocity + c1 r1 (own best - position) + c2 r2 (swarm's best - position), with an
inertia that falls linearly over the iterations (Eq. 10); velocities may be held to multiples of a step (Table 2); a
particle whose error leaves the band Delta E (Eq. 7) at any angle is discarded (Eq. 11).

Repaired, because it is not printed or cannot work as printed:

- c1, c2 and the inertia's limits are the field's usual 1.494, 0.9 and 0.4.
- The objective is a sum of squares: the printed signed sum (Eq. 6) lets errors cancel.
- r1 and r2 are drawn for every coordinate, so that the swarm can turn.
- Eq. 11 is applied once a particle inside the band is known (before that it would discard everybody). A discarded
  particle's position counts for nothing, and the particle flies on. Setting it down elsewhere instead makes the swarm
  shrink onto the first particle inside the band, so that searches fail.
- Eq. 11 is checked at a few sentinel readings spread over the turn: a particle outside the band there is outside it
  for certain, and the cost stays independent of the number of readings.

The search runs in coordinates that span the range with 0..1, so that every parameter moves alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from twin.angles import Array

Objective = Callable[[Array], Array]
"""Positions (batch, particles, d) -> cost (batch, particles)."""
Outside = Callable[[Array], NDArray[np.bool_]]
"""Positions (batch, particles, d) -> whether the particle leaves the band Delta E (batch, particles)."""

_FASTEST = 0.5
"""Longest move in one iteration, as a part of the range."""
_SETTLED = 1e-3
"""The swarm has settled when its own bests cost, on average, this much more than the best of all."""


@dataclass(frozen=True, kw_only=True)
class SwarmSettings:
    """How the swarm moves. The defaults are the paper's 100 particles and 200 iterations."""

    particles: int = 100
    iterations: int = 200
    inertia_max: float = 0.9
    inertia_min: float = 0.4
    own_pull: float = 1.494
    best_pull: float = 1.494
    bounds: Literal["reflect", "clamp"] = "reflect"
    stop_settled: bool = False
    """Stop before the last iteration where every swarm of the batch has settled."""


class SwarmResult(NamedTuple):
    """What the swarm found, for each sweep of the batch.

    ``best_history`` is the cost of the best of all after each iteration, the start first; ``own_history`` the mean
    of the particles' own bests: the two curves of Fig. 13.
    """

    best: Array
    """(batch, d)"""
    best_cost: Array
    """(batch,)"""
    best_history: Array
    """(batch, iterations + 1)"""
    own_history: Array
    """(batch, iterations + 1)"""
    evaluations: int
    """Evaluated particles a sweep."""
    discarded: NDArray[np.int64]
    """Particles discarded by Eq. 11, (batch,)."""


def inertia(settings: SwarmSettings, iteration: int) -> float:
    """Inertia at an iteration (Eq. 10): it falls linearly from its largest to its smallest value."""
    share = (settings.iterations - iteration) / max(settings.iterations, 1)
    return share * (settings.inertia_max - settings.inertia_min) + settings.inertia_min


def run(
    objective: Objective,
    lower: Array,
    upper: Array,
    *,
    rng: np.random.Generator,
    settings: SwarmSettings | None = None,
    steps: Array | None = None,
    outside: Outside | None = None,
) -> SwarmResult:
    """Search each box lower..upper (batch, d) with its own swarm.

    ``steps`` (d,) holds velocities, and with them positions, to multiples of the steps (Table 2); ``outside`` turns
    on the discard rule. The cost of an evaluation is the objective's alone.
    """
    settings = settings or SwarmSettings()
    span, low = (upper - lower)[:, None, :], lower[:, None, :]
    grid = None if steps is None else steps / span
    swarm = _started((len(lower), settings.particles, lower.shape[1]), rng, grid)
    swarm.remember(objective(low + span * swarm.place))
    discarded = np.zeros(len(lower), dtype=np.int64)
    best_history, own_history = [swarm.best_cost], [swarm.own_cost.mean(axis=1)]
    for iteration in range(1, settings.iterations + 1):
        _move(swarm, rng, settings, inertia(settings, iteration - 1), grid)
        points = low + span * swarm.place
        now = objective(points)
        if outside is not None:
            known = ~outside(low + span * swarm.best)
            out = outside(points) & known
            discarded += out.sum(axis=1)
            now[out] = np.inf
        swarm.remember(now)
        best_history.append(swarm.best_cost)
        own_history.append(swarm.own_cost.mean(axis=1))
        if settings.stop_settled and np.all(own_history[-1] <= (1.0 + _SETTLED) * best_history[-1]):
            break

    return SwarmResult(
        best=lower + (upper - lower) * swarm.best[:, 0, :],
        best_cost=best_history[-1],
        best_history=np.stack(best_history, axis=1),
        own_history=np.stack(own_history, axis=1),
        evaluations=settings.particles * len(best_history),
        discarded=discarded,
    )


@dataclass(eq=False)
class _Swarm:
    """Particles in flight, changed in place; positions in coordinates that span the range with 0..1."""

    place: Array
    """(batch, particles, d)"""
    velocity: Array
    """(batch, particles, d), a move in one iteration"""
    own: Array
    """The best place that each particle has been at (batch, particles, d)."""
    own_cost: Array
    """Its cost (batch, particles)."""

    @property
    def best(self) -> Array:
        """The best place that any particle of a swarm has been at (batch, 1, d)."""
        return np.take_along_axis(self.own, self.own_cost.argmin(axis=1)[:, None, None], axis=1)

    @property
    def best_cost(self) -> Array:
        """Its cost (batch,)."""
        return np.asarray(self.own_cost.min(axis=1))

    def remember(self, now: Array) -> None:
        """Keep the present places where their cost (batch, particles) is the lowest so far."""
        np.copyto(self.own, self.place, where=(now < self.own_cost)[..., None])
        np.minimum(self.own_cost, now, out=self.own_cost)


def _started(shape: tuple[int, int, int], rng: np.random.Generator, grid: Array | None) -> _Swarm:
    """Particles (batch, particles, d) anywhere in the range, at up to a quarter of it an iteration."""
    place = rng.random(shape)
    if grid is not None:
        place = np.round(place / grid) * grid
    velocity = (rng.random(shape) - 0.5) * 0.5
    return _Swarm(place, velocity, place.copy(), np.full(shape[:2], np.inf))


def _move(
    swarm: _Swarm, rng: np.random.Generator, settings: SwarmSettings, inertia_now: float, grid: Array | None
) -> None:
    """Move every particle once, in place (Eq. 8 and 9)."""
    pulls = rng.random((2, *swarm.place.shape))
    pulls *= np.array([settings.own_pull, settings.best_pull]).reshape(2, 1, 1, 1)
    swarm.velocity *= inertia_now
    swarm.velocity += pulls[0] * (swarm.own - swarm.place)
    swarm.velocity += pulls[1] * (swarm.best - swarm.place)
    np.maximum(swarm.velocity, -_FASTEST, out=swarm.velocity)
    np.minimum(swarm.velocity, _FASTEST, out=swarm.velocity)
    if grid is not None:
        swarm.velocity = np.round(swarm.velocity / grid) * grid
    swarm.place += swarm.velocity
    _keep_inside(swarm.place, swarm.velocity, settings.bounds)


def _keep_inside(place: Array, velocity: Array, bounds: str) -> None:
    """Bring particles back into 0..1, in place: reflected with their velocity, or stopped at the wall."""
    inside = np.minimum(np.maximum(place, 0.0), 1.0)
    beyond = inside != place
    if not beyond.any():
        return
    if bounds == "reflect":
        # The speed limit keeps a particle from passing the opposite wall.
        np.copyto(place, 2.0 * inside - place)
        np.negative(velocity, out=velocity, where=beyond)
    else:
        np.copyto(place, inside)
        np.copyto(velocity, 0.0, where=beyond)
