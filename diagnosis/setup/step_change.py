"""Steps along a record: where the mean of a column changes at once, and whether steps or a slope describe it better."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.setup.harmonics import Fitted, fitted, waves
from twin.angles import Array
from twin.step_gains import step_gains

_FEWEST = 6
"""Rows on either side of a step."""
_MOST_STEPS = 3
_MOST_WILD = 0.02
_SOON_ROWS, _SOON = 20, 0.03
"""Rows, or share of the record, within which a step that is taken back is a burst: stale frames, a word's gap."""
_NEAR_ROWS, _NEAR = 20, 0.04
"""Rows, or share of the record, on either side of a step within which a drift is even."""
_HALF = 0.5
_ONE_WAY = 0.9
"""Share of the way that a shaft gets on by, from which it goes one way: a slip may throw it back for a row."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps in an error, found one after the other: their places, the fit with them alone, and with a slope beside."""

    places: tuple[int, ...]
    alone: Fitted
    with_slope: Fitted
    slope_alone: Fitted

    def is_sudden(self, place: int) -> bool:
        """Whether the error near a step is nearer to one of that size than to a smooth way through its neighbours.

        Over a few rows whatever drifts goes on evenly, however it goes over the whole record.
        """
        k = self.places.index(place)
        size = float(self.with_slope.values[k - len(self.places)])
        left = self.with_slope.left + size * _after(self.with_slope.left.size, place)
        reach = max(_NEAR_ROWS, int(_NEAR * left.size))
        inside = slice(max(place - reach, 0), place + reach)
        at = np.arange(left.size, dtype=np.float64)[inside] - place
        shapes = [np.ones_like(at), at, np.asarray(at >= 0.0, dtype=np.float64)]
        return float(_fitted(shapes, left[inside]).values[-1]) / size > _HALF

    def lasting(self) -> tuple[int, float, float] | None:
        """Place, size and standard error of the largest step that no other takes back; None where each one is."""
        count = len(self.places)
        sizes, errors = self.with_slope.values[-count:], self.with_slope.errors[-count:]
        soon = max(_SOON_ROWS, int(_SOON * self.with_slope.left.size))
        kept = [
            k
            for k in range(count)
            if not any(
                sizes[k] * sizes[j] < 0.0
                and abs(self.places[k] - self.places[j]) <= soon
                and 2.0 * abs(sizes[j]) > abs(sizes[k])
                for j in range(count)
            )
        ]
        if not kept:
            return None
        worst = max(kept, key=lambda k: abs(float(sizes[k])))
        return self.places[worst], float(sizes[worst]), float(errors[worst])


def steps_of(error: Array, travel_deg: Array, *, turn_of: Array, beside: Sequence[Array] = ()) -> Steps:
    """Up to three steps of an error (n,) along the record, beside orders 1 to 4 and what goes with the direction.

    ``turn_of`` (n,) is the angle [deg] that the sensor's orders go with, ``travel_deg`` (n,) the one that a slope does.
    ``beside`` holds further shapes (n,) that are fitted with them, as those of a drift.
    """
    n = error.size
    way = np.sign(np.diff(travel_deg, prepend=2.0 * travel_deg[0] - travel_deg[1]))
    rest = [np.ones(n), *waves(np.radians(turn_of), (1, 2, 3, 4)), *beside]
    both_ways = abs(travel_deg[-1] - travel_deg[0]) < _ONE_WAY * np.sum(np.abs(np.diff(travel_deg)))
    if both_ways:
        rest.append(way)
    slope = [travel_deg / 360.0 - float(np.mean(travel_deg)) / 360.0]
    if beside and not both_ways:
        # Of a shaft that goes on evenly the rows less the reference's turns are the reference's own steps.
        slope = []
    places: list[int] = []
    for _ in range(_MOST_STEPS):
        known = [*rest, *(_after(n, place) for place in places)]
        places.append(_strongest(_fitted(known, error), known))
    steps = [_after(n, place) for place in places]
    return Steps(
        tuple(places),
        _fitted([*rest, *steps], error),
        _fitted([*rest, *slope, *steps], error),
        _fitted([*rest, *slope], error),
    )


def _fitted(shapes: list[Array], error: Array) -> Fitted:
    """A fit in which a whole stretch does not count as wild."""
    return fitted(shapes, error, most_wild=_MOST_WILD)


def _after(n: int, place: int) -> Array:
    return np.asarray(np.arange(n) >= place, dtype=np.float64)


def _strongest(fit: Fitted, known: list[Array]) -> int:
    """The place at which one more step would explain most of what a fit leaves, by its sum of squares."""
    n = fit.left.size
    basis = np.linalg.qr(np.stack(known, axis=1))[0]
    left = np.where(fit.kept, fit.left, 0.0)
    gain = step_gains(left - basis @ (basis.T @ left), basis, least=0.5)
    gain[:_FEWEST], gain[n - _FEWEST :] = 0.0, 0.0
    return int(np.argmax(gain))
