"""Whether a belt or a coupling ties a second inertia to the rotor, told by what torques do as their orders pass it.

A torque locked to the angle turns a rotor of one piece by 1/speed^2. Where its frequency comes near to a resonance of
what is tied to the rotor, the shaft answers by more, by less or the other way round
(:mod:`twin.second_inertia`). A coast, or the way from one speed to another, passes through it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.spin.columns import HIGHEST_OF_FRICTION, OF_ERROR, Path
from diagnosis.spin.problem import Problem, Projection, degrees_of_freedom
from twin.angles import TAU, Array
from twin.second_inertia import CHANGE, SecondInertia, Tied

_DAMPING, _SHARE = (0.005, 0.3), (0.03, 8.0)
"""Between which damping and share are looked for: a steel spring's to a rubber belt's, a small pulley's to a
flywheel's. Any logarithm between is as likely."""
_AROUND = 1.2
"""By how much a resonance may lie beyond the slowest and the fastest torque: farther off none meets it."""
_FINENESS = 0.06
"""Steps of the logarithm of the resonance from which a fit sets out: less than the width of one that is damped so."""
_SET_OUT = (0.1, 0.25)
"""Damping and share from which a fit sets out: those of a rubber belt and a pulley, damped enough to be met."""
_SELDOM = 0.02
"""Share of the readings that may be slower, and faster, than those that count for where it is looked for."""
_PEAKS = 3
"""Likeliest resonances of which a fit sets out."""
_LINES = 64.0
"""Resolved frequencies to either side of a resonance within which a wave in time is looked for at most: one that is
wider is no wave."""
_STILL, _MOST_STEPS, _MOST_DAMPED = 0.1, 20, 1e3
"""A fit ends where a step gains less than this of twice the logarithm, or after so many."""
_WAYS = CHANGE * np.eye(3)
_RIDGE = 1e-9
"""Added to the normal equations of the error's waves, whose readings are thousands."""
_SURELY = float(np.log(20.0))
"""Logarithm of twenty to one, as a level of 95 % is: it changes what torques do, and widens what that leaves open."""


@dataclass(frozen=True, eq=False)
class Torques:
    """Torques locked to the angle that may turn a shaft, and how that moves.

    ``scatter_rad_s2`` is the standard deviation of what a torque of each order may be. ``free_rad_s`` is the usual
    angular frequency below which the shaft may move by itself: a swing is not told from that.
    """

    scatter_rad_s2: Mapping[int, float]
    path: Path
    free_rad_s: float

    def turned(self, second: SecondInertia | None) -> Array:
        """Angles (m, n) [rad] by which they turn the shaft, each one standard deviation of what they may be.

        Those of friction grow with the speed as well, or reverse with it.
        """
        speed, all_of = self.path.speed_rad_s, self.path.turned(self.scatter_rad_s2, second)
        all_of *= np.repeat([*self.scatter_rad_s2.values()], 2)[:, None]
        rubs = all_of[: 2 * sum(order <= HIGHEST_OF_FRICTION for order in self.scatter_rad_s2)]
        grows = 0.5 * speed / float(np.sqrt(np.mean(speed**2)))
        both_ways = [np.sign(speed) * rubs] if np.ptp(np.sign(speed)) > 0.0 else []
        return np.concatenate([all_of, grows * rubs, *both_ways])

    @cached_property
    def bounds(self) -> Array:
        """Between which logarithms (3, 2) of resonance, damping and share a second inertia is looked for."""
        slow, fast = np.quantile(np.abs(self.path.speed_rad_s), [_SELDOM, 1.0 - _SELDOM])
        orders = [*self.scatter_rad_s2]
        lowest = max(min(orders) * slow / _AROUND, self.free_rad_s)
        return np.log([[lowest, max(max(orders) * fast, lowest) * _AROUND], _DAMPING, _SHARE])


def tied(problem: Problem, torques: Torques, *, log_penalty: float, variance: float) -> Tied | None:
    """The second inertia that makes readings likeliest; None where the rotor is nearly as likely of one piece.

    Likelihoods are restricted ones. A rotor of one piece is held against the average over all that is looked for
    (Laplace's approximation).

    Parameters
    ----------
    problem : Problem
        Readings about a motion; of its columns only the error's are taken.
    torques : Torques
        What may turn the shaft.
    log_penalty, variance : float
        Common logarithm of the penalty, and the variance [rad^2] of a reading's noise.
    """
    if not torques.scatter_rad_s2:
        return None
    profile, bounds = _Profile.of(problem, torques, log_penalty, variance), torques.bounds
    steps = np.arange(float(bounds[0, 0]), float(bounds[0, 1]), _FINENESS)
    grid = np.array([[at, *np.log(_SET_OUT)] for at in steps])
    costs = np.array([profile.cost(SecondInertia.of(at)) for at in grid])
    before, behind = np.r_[np.inf, costs[:-1]], np.r_[costs[1:], np.inf]
    peaks = np.flatnonzero((costs <= before) & (costs <= behind))
    found = [profile.best(grid[peak]) for peak in peaks[np.argsort(costs[peaks])][:_PEAKS]]
    # At an end of what is looked for there is none: a wave that comes and goes is a resonance without a damping.
    within = [one for one in found if np.all(np.abs(one.logarithms[:, None] - bounds) > CHANGE)]
    told = [one for one in within if _log_odds(profile, one) > _SURELY]
    return min(told, key=lambda one: profile.cost(one.second), default=None)


def _log_odds(profile: _Profile, found: Tied) -> float:
    """Logarithm of how much likelier the readings are with it than with a rotor of one piece.

    Beside the strongest wave in time near its resonance, as of the mains: that is no swing.
    """
    beside = profile.beside_a_wave(found.second)
    gain = 0.5 * (beside.cost(None) - beside.cost(found.second))
    spread = 0.5 * float(np.linalg.slogdet(TAU * found.covariance)[1])
    return gain + spread - float(np.sum(np.log(np.ptp(profile.torques.bounds, axis=1))))


def settled(found: Tied, problem: Problem, torques: Torques, *, log_penalty: float, variance: float) -> Tied:
    """The likeliest second inertia near one that was found, of a motion that was estimated with it."""
    return _Profile.of(problem, torques, log_penalty, variance).best(found.logarithms)


@dataclass(frozen=True, eq=False)
class _Profile:
    """The restricted likelihood of a second inertia, motion and error of the sensor at their best.

    ``errors`` (p, n) are the waves of the error, less what the motion takes and made orthonormal, ``along`` (p,) what
    the readings have of them.
    """

    torques: Torques
    projection: Projection
    errors: Array
    along: Array
    variance: float
    rows: float

    @classmethod
    def of(cls, problem: Problem, torques: Torques, log_penalty: float, variance: float) -> _Profile:
        projection = problem.projection(log_penalty)
        return cls._with(torques, projection, problem.columns[:OF_ERROR], variance)

    @classmethod
    def _with(cls, torques: Torques, projection: Projection, columns: Array, variance: float) -> _Profile:
        """With these columns (p, n) as the error's."""
        own = projection.of(columns)
        factor = np.linalg.cholesky(own @ columns.T + _RIDGE * np.eye(len(columns)))
        errors, along = np.linalg.solve(factor, own), np.linalg.solve(factor, columns @ projection.left)
        rows = degrees_of_freedom(projection.problem, np.full(len(columns), np.inf))
        return cls(torques, projection, errors, along, variance, rows)

    def beside_a_wave(self, second: SecondInertia) -> _Profile:
        """The same, with the strongest wave in time within the width of a resonance beside the error."""
        from scipy.optimize import minimize_scalar

        problem = self.projection.problem
        left, time_s = self.projection.left - self.errors.T @ self.along, problem.time_s - problem.time_s[0]
        resolved = TAU / float(time_s[-1])
        wide = resolved * float(np.clip(-2.0 * second.pole.real / resolved, 1.0, _LINES))

        def silence(frequency_rad_s: float) -> float:
            return -abs(complex(np.exp(-1j * frequency_rad_s * time_s) @ left))

        tried = second.resonance_rad_s + np.arange(-wide, wide, 0.5 * resolved)
        loudest = float(tried[np.argmin([silence(float(one)) for one in tried])])
        bounds = (loudest - 0.5 * resolved, loudest + 0.5 * resolved)
        phase = float(minimize_scalar(silence, bounds=bounds, method="bounded").x) * time_s
        columns = np.concatenate([problem.columns[:OF_ERROR], [np.cos(phase), np.sin(phase)]])
        return self._with(self.torques, self.projection, columns, self.variance)

    def cost(self, second: SecondInertia | None) -> float:
        """Minus twice its logarithm, the noise's variance at its best."""
        return self._cost(*self._system(self.torques.turned(second)))

    def _cost(self, system: Array, gradient: Array) -> float:
        left = self.projection.squares - float(self.along @ self.along + gradient @ np.linalg.solve(system, gradient))
        return self.rows * float(np.log(max(left, 1e-300))) + float(np.linalg.slogdet(system)[1])

    def best(self, start: Array) -> Tied:
        """The likeliest from logarithms (3,) to start from, by damped steps of least squares."""
        at, damped = start, 1e-3
        cost, told, score = self._slopes(at)
        bounds = self.torques.bounds
        for _ in range(_MOST_STEPS):
            step = np.linalg.solve(told + damped * np.diag(np.diag(told)), score)
            tried = np.clip(at + step, *bounds.T)
            if self.cost(SecondInertia.of(tried)) < cost:
                before, at, damped = cost, tried, 0.1 * damped
                cost, told, score = self._slopes(at)
                if before - cost < _STILL:
                    break
            elif damped < _MOST_DAMPED:
                damped *= 10.0
            else:
                break
        return Tied(SecondInertia.of(at), np.asarray(np.linalg.inv(told)))

    def _slopes(self, at: Array) -> tuple[float, Array, Array]:
        """The cost at logarithms (3,), what readings and bounds tell of them (3, 3), and the score (3,)."""
        columns = self.torques.turned(SecondInertia.of(at))
        system, gradient = self._system(columns)
        found = np.linalg.solve(system, gradient)
        slopes = np.stack(
            [(found @ self.torques.turned(SecondInertia.of(at + way)) - found @ columns) / CHANGE for way in _WAYS]
        )
        beside, along = self.errors @ slopes.T, self.projection.of(slopes)
        across = along @ columns.T - beside.T @ (self.errors @ columns.T)
        own = along @ slopes.T - beside.T @ beside
        told = (own - across @ np.linalg.solve(system, across.T)) / self.variance
        score = (slopes @ self.projection.left - beside.T @ self.along - across @ found) / self.variance
        # Of logarithms that are as likely anywhere between their bounds.
        return self._cost(system, gradient), told + np.diag(12.0 / np.ptp(self.torques.bounds, axis=1) ** 2), score

    def _system(self, columns: Array) -> tuple[Array, Array]:
        """Normal equations (m, m) of torques of one standard deviation each, and their right-hand side (m,)."""
        across = self.errors @ columns.T
        normal = self.projection.of(columns) @ columns.T - across.T @ across
        gradient = columns @ self.projection.left - across.T @ self.along
        return normal + self.variance * np.eye(len(columns)), gradient
