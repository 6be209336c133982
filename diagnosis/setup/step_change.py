"""Steps along a record: where the mean of a column changes at once, and whether steps or a slope describe it better."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from diagnosis.setup.harmonics import FALSE_ALARM, Fitted, fitted, waves
from twin.angles import Array, BoolArray
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
_OWN = 0.5
"""Squares of a step that no other shape makes, as of half a row."""
_SHORTEST_SLIDE = 4
"""Rows over which a slide goes at least: a reading that averages may stand between the two sides of a slip."""
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
        one_step = float(_fitted(shapes, left[inside]).values[-1]) / size > _HALF
        return one_step and not self._slides(place, reach)

    def _slides(self, place: int, reach: int) -> bool:
        """Whether the error goes from one level to the other over some rows, rather than by the steps found there.

        A slip is over from one row to the next; what slides, a warming or a creeping reference, passes for a few steps.
        """
        count = len(self.places)
        near = [k for k in range(count) if abs(self.places[k] - place) <= reach]
        first = max(min(self.places[k] for k in near) - reach, 0)
        inside = slice(first, max(self.places[k] for k in near) + reach)
        sizes = self.with_slope.values[-count:]
        steps = [_after(self.with_slope.left.size, self.places[k])[inside] for k in near]
        error = self.with_slope.left[inside] + sum(sizes[k] * one for k, one in zip(near, steps, strict=True))
        at = np.linspace(-1.0, 1.0, error.size)
        plain = [np.ones_like(at), at]
        # What a few steps leave of a slide is wild too, row after row; a wild reading stands alone.
        wild = ~self.with_slope.kept[inside]
        kept = ~wild | np.append(wild[1:], False) | np.append(False, wild[:-1])

        def left_over(widths: Iterable[int]) -> float:
            rows = np.arange(error.size, dtype=np.float64)
            ramps = (
                np.clip((rows - begins) / width, 0.0, 1.0)
                for width in widths
                for begins in range(0, error.size - width, max(width // 4, 1))
            )
            return min((_left_by([*plain, ramp], error, kept) for ramp in ramps), default=np.inf)

        stepped = min(_left_by([*plain, *steps], error, kept), left_over(range(1, _SHORTEST_SLIDE)))
        slid = left_over(range(_SHORTEST_SLIDE, 2 * reach + 1, 2))
        freedom = max(int(np.count_nonzero(kept)) - len(plain) - 3, 1)
        return stepped > slid * (1.0 + _clearly() / freedom)

    def lasting(self) -> list[tuple[int, float, float]]:
        """Place, size and standard error of each step that no other takes back, the largest first."""
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
        kept.sort(key=lambda k: -abs(float(sizes[k])))
        return [(self.places[k], float(sizes[k]), float(errors[k])) for k in kept]


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
        places.append(_settled(_strongest(_fitted(known, error), known), known, error))
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


def _left_by(shapes: Sequence[Array], error: Array, kept: BoolArray) -> float:
    """Sum of squares that shapes leave of an error (n,) in the rows that are kept."""
    columns = np.stack(shapes, axis=1)[kept]
    left = error[kept] - columns @ np.linalg.lstsq(columns, error[kept], rcond=None)[0]
    return float(left @ left)


@cache
def _clearly() -> float:
    """By how many variances a slide, with two places of its own, is beyond chance nearer than a step."""
    from scipy.stats import chi2

    return float(chi2.isf(FALSE_ALARM, 2))


def _after(n: int, place: int) -> Array:
    return np.asarray(np.arange(n) >= place, dtype=np.float64)


def _settled(place: int, known: list[Array], error: Array) -> int:
    """The place next to one found where a step leaves least, by absolute values.

    Rows right at a step pass for wild as long as it is not known, and a place among rows left out is any of them.
    """
    fit = _fitted([*known, _after(error.size, place)], error)
    size = float(fit.values[-1])
    left = fit.left + size * _after(error.size, place)
    first, last = max(place - _NEAR_ROWS, _FEWEST), min(place + _NEAR_ROWS, error.size - _FEWEST)
    if first >= last:
        return place
    near = left[first:last]
    # Costs of a step ahead of each of these rows: those before it stay, those from it on are stepped.
    before = np.concatenate([[0.0], np.cumsum(np.abs(near))])
    behind = np.concatenate([np.cumsum(np.abs(near - size)[::-1])[::-1], [0.0]])
    basis = np.linalg.qr(np.stack(known, axis=1))[0]
    shared = np.cumsum(basis[::-1], axis=0)[::-1][first : last + 1]
    own = error.size - np.arange(first, last + 1) - np.sum(shared**2, axis=1)
    # Where the shaft turns round, a step is what goes with the direction.
    return first + int(np.argmin(np.where(own > _OWN, before + behind, np.inf)))


def _strongest(fit: Fitted, known: list[Array]) -> int:
    """The place at which one more step would explain most of what a fit leaves, by its sum of squares."""
    n = fit.left.size
    basis = np.linalg.qr(np.stack(known, axis=1))[0]
    left = np.where(fit.kept, fit.left, 0.0)
    gain = step_gains(left - basis @ (basis.T @ left), basis, least=_OWN)
    gain[:_FEWEST], gain[n - _FEWEST :] = 0.0, 0.0
    return int(np.argmax(gain))
