"""Profile-likelihood intervals: where a parameter's likelihood is no parabola within its 95 % interval.

D. M. Bates and D. G. Watts, Nonlinear Regression Analysis and Its Applications (1988), section 6.1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.discovery.fitting.free_parameters import from_centre, value_of
from diagnosis.discovery.fitting.joint_fit import Fit, cost_of, evaluate, moved_by, solve
from diagnosis.discovery.fitting.tidy import tidy
from twin.angles import Array, wrap_deg
from twin.catalogue import find
from twin.chain import Chain

CURVED = 0.05
"""How far off, of itself, the root deviance at an end of the parabola's interval may be: the end is off by as much, and
the coverage of 95 % by about one percent."""
CLOSE = 0.02
"""The same where an end has been looked for."""
FIRST = 0.25
"""Share of the parabola's reach at which the first point of a profile lies."""
FARTHEST = 2.0
"""How many times as far off as the one before a point may be: a bent valley is lost at once in a longer step."""
NEAREST = 1.25
"""The same at least, where the profile levels off."""
MOST_STEPS = 16


@dataclass(frozen=True, eq=False)
class Profile:
    """The deviance of a fit over each of its free parameters, all others at their best.

    ``covariance`` (P, P) is the parameters', ``reach`` the root deviance at the ends of an interval: a quantile of
    Student's t.
    """

    fit: Fit
    covariance: Array
    reach: float

    @cached_property
    def _least(self) -> float:
        return cost_of(self.fit)

    @cached_property
    def _variance(self) -> float:
        return self._least / self.fit.freedom

    def intervals(self, places: Sequence[int]) -> dict[int, tuple[float, float]]:
        """The ends of these parameters' intervals: those of the parabola where it holds, else those of the profile.

        Whatever chain has been found within the reach belongs to the region, and what it has for the others to theirs:
        a parameter that turns back along a curved valley has its ends elsewhere than where its own profile is followed.
        """
        values = {place: value_of(self.fit.chain, self.fit.free[place]) for place in places}
        found: dict[int, tuple[float, float]] = {}
        within: list[Array] = []
        for place in places:
            ends = [values[place] + way * self._away(place, way, within) for way in (-1.0, 1.0)]
            found[place] = (ends[0], ends[1])
        if not within:
            return found
        off = np.array(within)
        return {
            place: (
                min(low, values[place] + float(off[:, place].min())),
                max(high, values[place] + float(off[:, place].max())),
            )
            for place, (low, high) in found.items()
        }

    def _away(self, place: int, way: float, within: list[Array]) -> float:
        """How far an end is from the estimate; ``within`` gathers what all parameters (P,) are off up to there."""
        by_parabola = self.reach * float(np.sqrt(self.covariance[place, place]))
        room = self._room(place, way)
        if by_parabola < room:
            there = moved_by(self.fit, way * by_parabola * along(self.covariance, place))
            if abs(self._root_nearby(there, place) / self.reach - 1.0) < CURVED:
                return by_parabola
        solved = {0.0: self.fit}

        def root(size: float) -> float:
            # A curved valley is followed from point to point.
            nearest = min(solved, key=lambda other: abs(other - size))
            solved[size] = self._best(place, solved[nearest], way * (size - nearest))
            height = self._over(cost_of(solved[size]))
            if height <= self.reach * (1.0 + CLOSE):
                within.append(self._off(tidy(solved[size].chain)))
            return height

        return reached(root, min(FIRST * by_parabola, room), room, self.reach)

    def _off(self, chain: Chain) -> Array:
        """How far all parameters (P,) of a chain are from the estimate, phases within half a turn."""
        off = np.zeros(len(self.fit.free))
        for place, free in enumerate(self.fit.free):
            if free.turn is None:
                off[place] = value_of(chain, free) - value_of(self.fit.chain, free)
                if find(free.key, chain.effects).params[free.name].role == "phase":
                    off[place] = wrap_deg(off[place])
        return off

    def _room(self, place: int, way: float) -> float:
        """How far a parameter may go; half a turn where it is a phase."""
        free = self.fit.free[place]
        param, value = find(free.key, self.fit.chain.effects).params[free.name], value_of(self.fit.chain, free)
        if param.role == "phase":
            return 180.0
        return max(value - param.lower if way < 0.0 else param.upper - value, 0.0)

    def _best(self, place: int, start: Fit, step: float) -> Fit:
        """The fit with a parameter so much further off than in another, and the others at their best."""
        fit = self.fit
        others = [k for k in range(len(fit.free)) if k != place]
        chain, free = moved_by(start, step * along(start.covariance(), place)), tuple(fit.free[k] for k in others)
        held = evaluate(chain, free, fit.observations, fit.weighting, fit.strengths[others])
        chain = solve(held, iterations=12, tolerance=0.01).chain
        return evaluate(chain, fit.free, fit.observations, fit.weighting, fit.strengths)

    def _root_nearby(self, chain: Chain, place: int) -> float:
        """Root deviance of a chain once the parameters other than this one have made up to first order."""
        fit = self.fit
        others = [k for k in range(len(fit.free)) if k != place]
        free = tuple(fit.free[k] for k in others)
        there = evaluate(chain, free, fit.observations, fit.weighting, fit.strengths[others])
        return self._over(there.squares_to_first_order + self._held(chain, place))

    def _held(self, chain: Chain, place: int) -> float:
        """What a prior adds to the whitened squares for one parameter."""
        strength = float(self.fit.strengths[place])
        return (strength * float(from_centre(chain, (self.fit.free[place],))[0])) ** 2 if strength > 0.0 else 0.0

    def _over(self, squares: float) -> float:
        return float(np.sqrt(max(squares - self._least, 0.0) / self._variance))


def along(covariance: Array, place: int) -> Array:
    """How all parameters (P,) go with one of them where a parabola has them."""
    column = covariance[place]
    return np.asarray(np.where(np.isfinite(column), column, 0.0) / column[place])


def reached(root: Callable[[float], float], first: float, room: float, reach: float) -> float:
    """How far from an estimate a root deviance reaches so high, sought from ``first`` on; at most ``room``."""
    size, near, far = first, (0.0, 0.0), None
    for _ in range(MOST_STEPS):
        height = root(size)
        if abs(height / reach - 1.0) < CLOSE or (height < reach and size >= room):
            break
        if height < reach:
            near = (size, height)
        else:
            far = (size, height)
        if far is None:
            size = min(size * float(np.clip(reach / max(height, 1e-300), NEAREST, FARTHEST)), room)
        else:
            size = near[0] + (far[0] - near[0]) * (reach - near[1]) / (far[1] - near[1])
    return size
