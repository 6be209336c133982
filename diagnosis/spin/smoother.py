"""The shaft's motion out of the sensor's own readings, estimated together with what is locked to the angle.

A reading is the shaft's angle with the sensor's error. The angle is a smooth motion (:mod:`diagnosis.spin.spline`)
with what torques locked to the angle add to it, which falls as 1/speed^2
(:mod:`twin.mechanics.torque_ripple`), the error a Fourier series of the angle, which does not. All are coefficients of
one generalised least-squares problem: the error's are free, the torques' scatter about zero, as do the motion's third
differences; how much is what makes the readings likeliest (restricted maximum likelihood).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from diagnosis.spin.columns import (
    HIGHEST_ORDER,
    OF_ERROR,
    OF_FRICTION,
    OF_LATE,
    OF_TORQUE,
    ORDERS,
    Path,
    torques,
    waves,
)
from diagnosis.spin.damping import damping
from diagnosis.spin.problem import Own, Problem, evened, held_at, knee, likeliest
from diagnosis.spin.scatter import ANY_GROWTH, amplitudes_seen, coefficients, separable_orders
from diagnosis.spin.second_inertia import Torques, settled, tied
from diagnosis.spin.speeds import several_speeds
from diagnosis.spin.spline import Spline, rate
from diagnosis.spin.torques import RATE
from diagnosis.spin.variance_components import Drawn
from twin.angles import Array
from twin.confidence import OF_MAD
from twin.effect import BoolArray
from twin.mechanics.torque_ripple import second_order
from twin.pace import two_speeds_alone
from twin.second_inertia import SecondInertia, Tied

_BEYOND_CHANCE = 9.0
"""An order's square against its variance, from which on it is seen: chance passes it once in 8,000 times."""
_ROUNDS = 5
_FAR_OUT = 6.0


@dataclass(frozen=True, eq=False)
class MotionFit:
    """A motion (n,), and what was found with it.

    ``shaft_rad`` is the part that is smooth in time with what the torques do. ``knee_rad_s`` (n,) is the angular
    frequency below which the motion is freer than the readings' noise is loud. ``noise_rad`` (n,) is the RMS of a
    reading about it all. ``terms`` are the coefficients: cosine and sine of each order of the error [rad], of each
    order's torque [rad/s^2], of what of it grows with the speed [rad/s^2 for each rad/s] and of what reverses with it
    [rad/s^2] up to the order 4, and of an error of order 2 that grows with the speed [rad for each rad/s].
    ``separable`` (orders,): whether a torque that makes all that is seen of an order would be told. ``growing`` (orders
    up to 4,) is the standard deviation of what of a torque grows with the speed [rad/s^2 for each rad/s], infinite
    where that is not told. ``second`` is an inertia that a belt or a coupling ties to the rotor, where one shows.
    """

    shaft_rad: Array
    speed_rad_s: Array
    knee_rad_s: Array
    noise_rad: Array
    terms: Drawn
    usable: BoolArray
    damping_per_s: float
    damping_sd_per_s: float
    separable: BoolArray
    growing: Array
    second: Tied | None = None


@dataclass(frozen=True, eq=False)
class _Estimate:
    """Where the rounds stand: the problem, the shaft's angle (n,) [rad], and how much everything scatters.

    ``readings`` (n,) [rad] are all of them, those of the problem less what torques do beyond the first order.
    ``stiffness`` (d,) is that of the spline before rougher motion is held less, ``turning_rad_s`` (n,) the usual speed
    of each log, not given: that of all.
    """

    problem: Problem
    readings: Array
    stiffness: Array
    stretches: Sequence[slice]
    shaft_rad: Array
    sd: Array
    log_penalty: float | None = None
    variance: float = 1e-6
    damping_per_s: float = 0.0
    damping_sd_per_s: float = 0.0
    terms: Drawn | None = None
    separable: BoolArray = field(default_factory=lambda: np.zeros(HIGHEST_ORDER, dtype=bool))
    growing: Array = field(default_factory=lambda: ANY_GROWTH)
    most_growing: Array = field(default_factory=lambda: ANY_GROWTH)
    turning_rad_s: Array | None = None
    largest_rad_s2: Array = field(default_factory=lambda: np.zeros(HIGHEST_ORDER))
    second: Tied | None = None
    damped: bool = True

    @cached_property
    def rates(self) -> tuple[Array, Array]:
        """Speed and acceleration (n,), without what torques do."""
        smooth, time_s = np.asarray(self.problem.spline.design @ self.problem.start), self.problem.time_s
        speed = rate(smooth, time_s, self.stretches)
        return speed, rate(speed, time_s, self.stretches)

    @property
    def with_torques(self) -> bool:
        """Whether torques are among the columns."""
        return len(self.sd) > OF_ERROR

    def next(self) -> _Estimate:
        """One round: damping, penalty, coefficients, and which readings count, one after the other."""
        made = self._with_columns()
        usual = float(np.median(np.abs(self.rates[0])))
        turning = usual if self.turning_rad_s is None else self.turning_rad_s
        log_penalty, variance = likeliest(
            made.problem, made.sd, made.variance, around=self.log_penalty, turning_rad_s=turning
        )
        reduced = made.problem.reduced(log_penalty)
        separable = separable_orders(reduced, variance, usual, self.largest_rad_s2)
        terms, growing = coefficients(
            reduced,
            made.sd,
            variance,
            self.rates[0],
            separable,
            most_growing=self.most_growing,
        )
        moved = np.r_[OF_ERROR : min(OF_FRICTION, len(terms.values)), OF_LATE : len(terms.values)]
        start = made.problem.start + reduced.step - reduced.pulled @ terms.values
        smooth = made.problem.spline.design @ start
        left = made.problem.readings - smooth - terms.values @ made.problem.columns
        left = np.abs(left) * np.sqrt(made.problem.precision)
        usual_left = OF_MAD * float(np.median(left[made.problem.weights > 0.0]))
        differences = made.problem.rough @ start
        problem = replace(
            made.problem,
            start=start,
            weights=np.where(left < _FAR_OUT * usual_left, made.problem.precision, 0.0),
            stiffness=evened(made.stiffness, differences),
        )
        return replace(
            made,
            problem=problem,
            shaft_rad=made.readings
            - made.problem.readings
            + smooth
            + terms.values[moved] @ made.problem.columns[moved],
            sd=terms.sd,
            log_penalty=log_penalty,
            variance=variance,
            terms=terms,
            separable=separable,
            growing=growing,
        )

    def _with_columns(self) -> _Estimate:
        """With the waves of the angle as it stands, and what torques at this speed and damping do to it."""
        errors = waves(self.shaft_rad)
        if not self.with_torques:
            return replace(self, problem=replace(self.problem, columns=errors))
        damping_per_s, sd_per_s = self._damping()
        second = None if self.second is None else self.second.second
        turned = torques(self._path(damping_per_s), second)
        known = np.zeros(OF_FRICTION - OF_ERROR)
        if self.terms is not None and len(self.terms.values) > OF_ERROR:
            known = self.terms.values[OF_ERROR:OF_FRICTION]

        def changed(damped_per_s: float, other: SecondInertia | None) -> Array:
            return np.asarray(known @ (torques(self._path(damped_per_s), other) - turned)[: known.size])

        scattered = () if self.second is None else self.second.scattered()
        further = [changed(damping_per_s + RATE, second) / RATE]
        further += [part * changed(damping_per_s, other) for other, part in scattered]
        return replace(
            self,
            damping_per_s=damping_per_s,
            damping_sd_per_s=sd_per_s,
            sd=np.concatenate([self.sd[:OF_LATE], [max(sd_per_s, 1e-9)], np.ones(len(scattered))]),
            problem=replace(
                self.problem,
                columns=np.concatenate([errors, turned, np.stack(further)]),
                readings=self.readings - self._beyond_first_order(),
                damping_per_s=damping_per_s,
            ),
        )

    def _path(self, damping_per_s: float) -> Path:
        """How the shaft moves, so damped."""
        return Path(self.shaft_rad, *self.rates, self.problem.time_s, self.stretches, damping_per_s)

    def rounds(self) -> _Estimate:
        """Round for round."""
        # The first round finds the motion and its speed, which what torques do follows.
        found = self.next()
        if several_speeds(found.rates[0]):
            found = replace(found, sd=np.concatenate([found.sd, np.ones(OF_LATE + 1 - OF_ERROR)]), log_penalty=None)
        for _ in range(_ROUNDS - 1):
            found = found.next()
        return found

    def undamped(self) -> _Estimate:
        """The same without a damping."""
        return replace(self, damped=False).rounds()

    def with_second(self, second: Tied, *, settles: bool = False) -> _Estimate:
        """The same of a rotor with a second inertia; ``settles``: with the likeliest one near this."""
        found = replace(self, second=second).undamped()
        if settles:
            found = replace(found, second=found.tied(near=second))
        return replace(found, damped=True).next().next()

    def tied(self, near: Tied | None = None) -> Tied | None:
        """An inertia that is tied to the rotor; ``near``: the likeliest one near one that is known."""
        assert self.log_penalty is not None
        at = {"log_penalty": self.log_penalty, "variance": self.variance}
        if near is None:
            return tied(self.problem, self._torques_told(), **at)
        return settled(near, self.problem, self._torques_told(), **at)

    def _torques_told(self) -> Torques:
        """Torques that are told, each as large as to make all that is seen of its order."""
        assert self.log_penalty is not None
        assert self.terms is not None
        usual, of = float(np.median(np.abs(self.rates[0]))), slice(OF_ERROR, OF_TORQUE)
        told = self.terms.values[of] ** 2 / np.diag(self.terms.covariance)[of]
        seen = amplitudes_seen(self.problem.reduced(self.log_penalty), self.variance)
        makes = {
            order: size * (order * usual) ** 2
            for order, size, square in zip(ORDERS, seen, told.reshape(-1, 2).sum(axis=1), strict=True)
            if square > 2.0 * _BEYOND_CHANCE
        }
        free_rad_s = float(np.median(knee(self.problem, self.log_penalty)))
        return Torques(makes, self._path(self.damping_per_s), free_rad_s)

    def _damping(self) -> tuple[float, float]:
        """Of the shaft at this penalty, and its standard deviation [1/s]; none is looked for in the first round."""
        if not self.damped or self.log_penalty is None or self.terms is None or len(self.terms.values) <= OF_ERROR:
            return 0.0, 0.0
        fastest = float(np.max(np.abs(self.rates[0])))
        return damping(
            self.problem,
            self.terms.values,
            self.stiffness,
            log_penalty=self.log_penalty,
            variance=self.variance,
            fastest_per_s=fastest,
        )

    def _beyond_first_order(self) -> Array | float:
        """What the torques that were found turn the shaft by, (n,) [rad], beyond what is one of the columns."""
        if self.terms is None or len(self.terms.values) <= OF_ERROR:
            return 0.0
        known = self.terms.values[OF_ERROR:OF_TORQUE].reshape(-1, 2)
        return second_order(known, shaft_rad=self.shaft_rad, speed_rad_s=self.rates[0])


def fitted_motion(
    readings_rad: Array,
    time_s: Array,
    stretches: Sequence[slice],
    *,
    most_growing: Array = ANY_GROWTH,
    own: Own | None = None,
    second: Tied | None = None,
    seek_second: bool = False,
) -> MotionFit:
    """Estimate the motion behind unwrapped readings.

    Torques locked to the angle are told from the error of the sensor by the speeds of the motion alone: one speed does
    not tell them, however far they speed the shaft up and slow it down within a turn.

    Parameters
    ----------
    readings_rad, time_s : ndarray
        Readings (n,) [rad], continuous within each stretch, and their times [s], rising.
    stretches : sequence of slice
        The rows of each stretch, one behind the other.
    most_growing : ndarray
        What of each order's torque (orders up to 4,) is known to grow with the speed at most [rad/s^2 for each rad/s].
    own : Own, optional
        What the readings of several logs have of their own; not given: all are alike.
    second : Tied, optional
        An inertia that is known to be tied to the rotor.
    seek_second : bool
        Whether one is looked for: where the shaft went by more than two speeds, as none is passed otherwise.
    """
    begun = _set_out(readings_rad, time_s, stretches, own, most_growing)
    if second is not None:
        found = begun.with_second(second)
    else:
        found = begun.rounds()
        passes = seek_second and found.with_torques and not two_speeds_alone(found.rates[0])
        # A swing that is not known passes for a damping, which then holds the torques that would tell it.
        second = begun.undamped().tied() if passes else None
        if second is not None:
            found = begun.with_second(second, settles=True)
    assert found.terms is not None
    assert found.log_penalty is not None
    return MotionFit(
        shaft_rad=found.shaft_rad,
        speed_rad_s=found.rates[0],
        knee_rad_s=knee(found.problem, found.log_penalty),
        noise_rad=np.sqrt(found.variance / found.problem.precision),
        terms=found.terms,
        usable=found.problem.weights > 0.0,
        damping_per_s=found.damping_per_s,
        damping_sd_per_s=found.damping_sd_per_s,
        separable=found.separable,
        growing=found.growing,
        second=found.second,
    )


def _set_out(
    readings_rad: Array, time_s: Array, stretches: Sequence[slice], own: Own | None, most_growing: Array
) -> _Estimate:
    """A motion through the readings, from which the rounds set out."""
    spline = Spline.over(time_s, stretches)
    precision = np.ones(readings_rad.size) if own is None else own.precision
    problem = Problem(
        spline,
        readings_rad,
        time_s,
        precision,
        precision,
        np.ones(spline.rough.shape[0]),
        np.zeros(spline.size),
        np.zeros((0, readings_rad.size)),
    )
    if own is not None:
        held = held_at(problem, own.knee_rad_s)
        problem = replace(problem, stiffness=held / float(np.median(held)))
    start = problem.reduced(0.0).step
    shaft, free = np.asarray(spline.design @ start), np.full(OF_ERROR, np.inf)
    return _Estimate(
        replace(problem, start=start),
        readings_rad,
        problem.stiffness,
        stretches,
        shaft,
        free,
        most_growing=most_growing,
        turning_rad_s=None if own is None else own.usual_rad_s,
        largest_rad_s2=np.zeros(HIGHEST_ORDER) if own is None else own.largest_rad_s2,
    )
