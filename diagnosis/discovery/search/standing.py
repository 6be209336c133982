"""Standing: how a cause held its place when that was last examined by exact fits, and whether it would do so again.

To first order a cause and its rivals are weighed in the fit without the cause, which costs no fit anew. An exact
gain is up to so many times what first order says (``rival_share``). So as long as no lead, to first order, has moved by
that share of the way to another verdict, exact fits would end as they did.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import handicap
from diagnosis.discovery.search.periodogram import clock_of
from diagnosis.discovery.search.removal import Removal
from diagnosis.discovery.search.screening import Candidate

Form = tuple[str, tuple[str, ...], tuple[float, ...]]
"""What a rival is known again by: its name, the strengths that it is sought with, and which of its shapes it has."""


def form_of(rival: Candidate, fit: Fit) -> Form:
    """By what a rival is known again.

    Another order, frequency or place is another rival: of a line by whole cycles over the record, within which no two
    are told apart, of other shapes by the nearest one of the grid that they are sought on.
    """
    effect, values = rival.effect, rival.values
    if effect.line is not None:
        span = float(np.ptp(clock_of(fit, effect.line))) if effect.line.clock != "channels" else 0.0
        value = float(values[effect.line.param])
        return effect.name, effect.roles("strength"), (float(round(value * span)) if span > 0.0 else value,)
    grid = effect.shapes(fit.linear.motion)
    return effect.name, effect.roles("strength"), (float(_nearest(grid, values)),) if len(grid) > 1 else ()


def _nearest(grid: Sequence[Mapping[str, float]], values: Mapping[str, Any]) -> int:
    """Place in a grid of shapes of the one that is nearest to these values, each counted in what the grid covers."""
    names = list(grid[0])
    shapes = np.array([[float(shape[name]) for name in names] for shape in grid])
    covered = np.ptp(shapes, axis=0)
    away = (shapes - np.array([float(values[name]) for name in names])) / np.where(covered > 0.0, covered, 1.0)
    return int(np.argmin(np.sum(away**2, axis=1)))


@dataclass(frozen=True)
class Contest:
    """A rival that lost: by how much [nats] to the verdict that it wins, and its lead over the cause to first order."""

    lost_by: float
    first: float


@dataclass(frozen=True, eq=False)
class Standing:
    """A cause in the fit ``seen_in`` that it was last examined in, if only to first order.

    ``log_p`` is the log probability by chance of what it gained when it was last examined by exact fits, ``first`` the
    same to first order. ``contests`` are by form the rivals that it was held against.
    """

    seen_in: Fit
    log_p: float
    first: float
    contests: Mapping[Form, Contest]

    def now(self, removal: Removal) -> float | None:
        """The log probability as first order says that it has become; None where it says nothing."""
        return None if removal.own is None else self.log_p + removal.own.log_p - self.first

    def pays_still(self, removal: Removal, level: float) -> bool:
        """Whether the cause stays below the level of what pays, its handicap included."""
        now, fit = self.now(removal), removal.fit
        room = level - self.log_p - handicap(removal.effect, fit)
        return now is not None and now - self.log_p < fit.settings.rival_share * room

    def beats_still(self, removal: Removal, rivals: Sequence[Candidate]) -> bool:
        """Whether each of the rivals that may do better is one that lost, and has not drawn near enough since."""
        if removal.own is None:
            return False
        for rival in rivals:
            contest = self.contests.get(form_of(rival, removal.fit))
            if contest is None:
                return False
            drawn_nearer = contest.first - (rival.log_p - removal.own.log_p)
            if drawn_nearer >= removal.fit.settings.rival_share * contest.lost_by:
                return False
        return True
