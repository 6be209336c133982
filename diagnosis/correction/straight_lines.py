"""Straight lines between the entries of a table, laid so that they follow a curve over the turn as closely as they can.

Samples of the curve are not the best entries: between them the line runs on one side of it, so that the error at its
worst is twice what it need be. Entries of the smallest worst error are a linear programme (Chebyshev approximation);
where several share that error, the one whose errors in the single intervals sum to least. Whole numbers among which a
table's words must be are found by dynamic programming along the turn, as the error in an interval depends on its two
ends alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from twin.angles import TAU, Array, IntArray

Least = Literal["worst", "rms"]
"""What a table's entries are chosen for: the smallest worst error, or the smallest root mean square."""
Curve = Callable[[Array], Array]
"""From readings [rad] to what a table is to hold there [rad]."""
_FEWEST_SAMPLES = 2048
_IN_AN_INTERVAL = 8
_NOT_WORTH_IT_RAD = 1e-6
"""A worst error that no drive notices, 0.00006 deg: least squares are as good there."""
_SLACK = 1e-4
"""By how much the worst error may miss the smallest one, in parts of that of least squares."""
_CANDIDATES = 5
"""Whole numbers tried at each node, about the value that would be best without rounding."""
_ROUNDS = 40
_LARGEST_REACH, _SMALLEST_REACH = 0.25, 1e-3
"""By how much of the room beside it a node is moved at once."""
_STEP_RAD = 1e-4


@dataclass(frozen=True, eq=False)
class Nodes:
    """Where the entries of a table stand on the turn: angles (n,) [rad], ascending, less than a turn apart.

    ``closed``: the last is joined to the first over the end of the turn.
    """

    at_rad: Array
    closed: bool = True

    @classmethod
    def even(cls, count: int, first: float = 0.0) -> Nodes:
        """So many of equal distance, the first so many of these distances from zero."""
        return cls(TAU * (np.arange(count) + first) / count)

    def __len__(self) -> int:
        return int(self.at_rad.size)

    @property
    def intervals(self) -> int:
        """Number of straight lines."""
        return len(self) - (not self.closed)

    def samples(self) -> tuple[Array, IntArray, Array]:
        """Angles (m,) in all intervals, ends included; the interval of each, and the share of its right end."""
        ends = np.append(self.at_rad, self.at_rad[0] + TAU) if self.closed else self.at_rad
        count = max(_IN_AN_INTERVAL, -(-_FEWEST_SAMPLES // self.intervals)) + 1
        share = np.linspace(0.0, 1.0, count)
        at = ends[:-1, None] + np.diff(ends)[:, None] * share
        interval = np.repeat(np.arange(self.intervals), count)
        return at.ravel(), interval, np.tile(share, self.intervals)

    def right(self, interval: IntArray) -> IntArray:
        """The node at the right end of intervals."""
        return (interval + 1) % len(self)


def best_values(nodes: Nodes, curve: Curve, least: Least = "worst") -> Array:
    """Values (n,) [rad] at the nodes, between which straight lines follow the curve best."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import spsolve

    at, interval, share = nodes.samples()
    wanted = curve(at)
    rows = np.arange(at.size)
    weights = np.concatenate([1.0 - share, share])
    places = (np.concatenate([rows, rows]), np.concatenate([interval, nodes.right(interval)]))
    lines = csr_matrix((weights, places), shape=(at.size, len(nodes)))
    values = np.asarray(spsolve((lines.T @ lines).tocsc(), lines.T @ wanted))
    left = wanted - lines @ values
    worst = float(np.max(np.abs(left)))
    if least == "rms" or worst < _NOT_WORTH_IT_RAD:
        return values
    # In units of what least squares leave, as the solver's tolerances are absolute.
    return values + worst * _smallest_worst(lines, left / worst, interval, nodes.intervals)


def _smallest_worst(lines: Any, wanted: Array, interval: IntArray, intervals: int) -> Array:
    """Values of the smallest worst error; of these, the ones whose worst errors of the intervals sum to least."""
    from scipy.optimize import linprog
    from scipy.sparse import csr_matrix, hstack, vstack

    samples, count = lines.shape
    limits = np.concatenate([wanted, -wanted])

    def solved(bound_of: Any, bounds: int, highest: float | None) -> Array:
        each_way = vstack([hstack([lines, -bound_of]), hstack([-lines, -bound_of])]).tocsr()
        cost = np.concatenate([np.zeros(count), np.ones(bounds)])
        free = [(None, None)] * count + [(0.0, highest)] * bounds
        return np.asarray(linprog(cost, A_ub=each_way, b_ub=limits, bounds=free).x)

    smallest = float(solved(csr_matrix(np.ones((samples, 1))), 1, None)[-1])
    of_interval = csr_matrix((np.ones(samples), (np.arange(samples), interval)), shape=(samples, intervals))
    return solved(of_interval, intervals, smallest + _SLACK)[:count]


def best_whole_numbers(
    nodes: Nodes, curve: Curve, unit_rad: float, *, least: Least = "worst", limit: int | None = None
) -> IntArray:
    """Whole numbers (n,) of a unit [rad], at most ``limit`` in size, between which straight lines follow best.

    The nodes are closed.
    """
    values = best_values(nodes, curve, least) / unit_rad
    around = np.arange(_CANDIDATES) - _CANDIDATES // 2
    tried = np.round(values).astype(np.int64)[:, None] + around
    if limit is not None:
        tried = np.clip(tried, -limit, limit)
    at, _, share = nodes.samples()
    wanted, share = (part.reshape(nodes.intervals, -1) for part in (curve(at) / unit_rad, share))
    follow = np.roll(tried, -1, axis=0)
    left = tried[:, :, None, None] * (1.0 - share)[:, None, None, :]
    error = np.abs(left + follow[:, None, :, None] * share[:, None, None, :] - wanted[:, None, None, :])
    worst, square = error.max(axis=-1), np.mean(error**2, axis=-1)
    if least == "worst":
        square = np.where(worst <= _bottleneck(worst) * (1.0 + 1e-9), square, np.inf)
    chosen = _cheapest(square)
    return tried[np.arange(len(nodes)), chosen]


def _bottleneck(cost: Array) -> float:
    """The smallest largest cost of a way round the turn; cost (n, k, k) of going from candidate to candidate."""
    found = np.inf
    for start in range(cost.shape[1]):
        here = cost[0, start]
        for step in cost[1:]:
            here = np.min(np.maximum(here[:, None], step), axis=0)
        found = min(found, float(here[start]))
    return found


def _cheapest(cost: Array) -> IntArray:
    """The candidates (n,) of the way round the turn whose costs (n, k, k) sum to least."""
    best, way = np.inf, np.zeros(cost.shape[0], dtype=np.int64)
    for start in range(cost.shape[1]):
        here, came = cost[0, start], []
        for step in cost[1:]:
            total = here[:, None] + step
            came.append(np.argmin(total, axis=0))
            here = np.min(total, axis=0)
        if here[start] < best:
            best, place = float(here[start]), start
            for k in range(cost.shape[0] - 1, 0, -1):
                place = int(came[k - 1][place])
                way[k] = place
            way[0] = start
    return way


def spread_nodes(curve: Curve, count: int, low_rad: float, high_rad: float) -> Nodes:
    """So many nodes from one angle [rad] to another, placed where straight lines between them follow the curve best.

    They are spread until the curve leaves the chord of each interval equally far, and from there moved by linear
    programmes, in each of which the worst error is linear in places and values: near to the smallest worst error.
    """
    at = _equal_chords(curve, np.linspace(low_rad, high_rad, count))
    share = np.linspace(0.0, 1.0, _IN_AN_INTERVAL + 1)
    worst, reach = np.inf, _LARGEST_REACH
    for _ in range(_ROUNDS):
        moved, values = _moved_together(curve, at, share, reach)
        inner = moved[:-1, None] + np.diff(moved)[:, None] * share
        lines = values[:-1, None] + np.diff(values)[:, None] * share
        found = float(np.max(np.abs(lines - curve(inner))))
        if found < worst * (1.0 - _SLACK):
            at, worst = moved, found
        else:
            reach *= 0.5
        if reach < _SMALLEST_REACH:
            break
    return Nodes(at, closed=False)


def _equal_chords(curve: Curve, at: Array) -> Array:
    """Nodes (n,) moved until the curve leaves the chord of each interval about equally far; the ends stay."""
    share = np.linspace(0.0, 1.0, 4 * _IN_AN_INTERVAL + 1)
    for _ in range(_ROUNDS):
        wide, value = np.diff(at), curve(at)
        inner = curve(at[:-1, None] + wide[:, None] * share)
        bend = np.ptp(inner - value[:-1, None] - np.diff(value)[:, None] * share, axis=1)
        # A chord's height goes with the square of its width.
        dense = np.sqrt(bend + 1e-3 * bend.max() + 1e-15) / wide
        total = np.concatenate([[0.0], np.cumsum(dense * wide)])
        at = 0.5 * (at + np.interp(np.linspace(0.0, total[-1], at.size), total, at))
    return at


def _moved_together(curve: Curve, at: Array, share: Array, reach: float) -> tuple[Array, Array]:
    """Places and values (n,) of the smallest worst error to first order; the ends stay.

    Each place is moved by at most ``reach`` of the narrower interval beside it.
    """
    from scipy.optimize import linprog
    from scipy.sparse import csr_matrix, hstack, vstack

    count, wide = at.size, np.diff(at)
    inner = (at[:-1, None] + wide[:, None] * share).ravel()
    value = curve(inner)
    slope = (curve(inner + _STEP_RAD) - curve(inner - _STEP_RAD)) / (2.0 * _STEP_RAD)
    interval, part = np.repeat(np.arange(count - 1), share.size), np.tile(share, count - 1)
    rows = np.arange(inner.size)
    places = (np.concatenate([rows, rows]), np.concatenate([interval, interval + 1]))
    ends = np.concatenate([1.0 - part, part])
    lines = csr_matrix((ends, places), shape=(rows.size, count))
    moving = csr_matrix((-ends * np.concatenate([slope, slope]), places), shape=(rows.size, count))
    scale = max(float(np.max(np.abs(value))), _NOT_WORTH_IT_RAD)
    one = csr_matrix(np.ones((rows.size, 1)))
    both = hstack([lines, moving / scale])
    room = reach * np.concatenate([[0.0], np.minimum(wide[:-1], wide[1:]), [0.0]])
    found = linprog(
        np.append(np.zeros(2 * count), 1.0),
        A_ub=vstack([hstack([both, -one]), hstack([-both, -one])]).tocsr(),
        b_ub=np.concatenate([value, -value]) / scale,
        bounds=[(None, None)] * count + [(-one_room, one_room) for one_room in room] + [(0.0, None)],
    ).x
    return at + found[count : 2 * count], scale * found[:count]
