"""Changes: which of a given twin's own parameters stand elsewhere in this recording, and which are as they were.

All of them are fitted, and their differences from the twin are weighed jointly. The twin is taken to be known as well
as a recording like this one tells it, mounted as it was: a difference has about twice the covariance of the fit, and
more where the earlier mounting told two parameters apart less well. The smallest set of changes is looked for that
leaves no difference which is not chance: with one parameter moved, all others that lean on it do not.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.discovery.fitting.free_parameters import Free, value_of
from diagnosis.discovery.fitting.initial_fit import awake
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.fitting.projection import projected
from diagnosis.discovery.settings import over_footprints
from twin.angles import Array, wrap_deg
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Owner

TWIN_VARIANCE = 2.0
"""Variance of a difference over that of the fit: the twin was found from a recording like this one."""
_ALL_SETS = 3
"""Changes up to which every set is tried; larger ones are built one by one."""
_FEWEST_MOVED = 3
"""Parameters of the device that have to move before it is taken for another one: a change has one cause, or two."""


@dataclass(frozen=True, kw_only=True)
class Change:
    """A parameter of the given twin that stands elsewhere.

    ``was`` is its value in the twin, ``log_p`` the log probability that chance alone moves it as far beside the other
    changes, ``family_log_p`` that it moves any parameter as far, ``rivals`` the parameters (``effect.parameter``) or
    new causes that would do as well in its place, and ``before_deg``, ``after_deg`` the held-out RMS [deg] around it.
    """

    free: Free
    owner: Owner
    was: float
    gain: float
    log_p: float
    family_log_p: float
    rivals: tuple[str, ...] = ()
    before_deg: float = float("nan")
    after_deg: float = float("nan")

    @property
    def name(self) -> str:
        """Effect and parameter, as a twin file names them."""
        return f"{self.free.key}.{self.free.name}"

    @property
    def false_alarm_probability(self) -> float:
        """Probability that a recording without a change looks as much like any, in any of the footprints."""
        return over_footprints(self.family_log_p)

    def with_rivals(self, names: Sequence[str]) -> Change:
        """The change with further rivals."""
        return replace(self, rivals=tuple(dict.fromkeys([*self.rivals, *names])))


@dataclass(frozen=True, eq=False)
class Differences:
    """A fit's own parameters less the twin's: the differences (P,), and their information matrix (P, P).

    ``free`` names them; all else that the fit has free is a nuisance, and allowed for. A parameter has moved where the
    log probability of as much by chance is below ``threshold``; sets whose chi-squared differs by less than ``same``
    cannot be told apart.
    """

    free: tuple[Free, ...]
    difference: Array
    information: Array
    dof: int
    threshold: float
    same: float

    @classmethod
    def of(cls, fit: Fit, twin: Chain, own: Sequence[Free], *, effects: int) -> Differences:
        """The differences of a fit in which the twin's ``own`` parameters are free, beside so many effects searched."""
        free = tuple(one for one in fit.free if one in own)
        settings, dof = fit.settings, fit.freedom
        start = awake(twin)
        known = tuple(one for one in fit.free if one.turn is None and one.name in start.values.get(one.key, {}))
        before = evaluate(start, known, fit.observations, fit.weighting)
        free = tuple(one for one in free if not _hardly_known(before, free, one, fit.variance))
        return cls(
            free,
            np.array([_away(fit, twin, one) for one in free]),
            _parallel(_told(fit, free), _told(before, free)) / fit.variance,
            dof,
            settings.effect_log_p(len(free) + effects),
            settings.same_fit(coarse=fit.weighting.coarse),
        )

    @property
    def family(self) -> int:
        """How many parameters are asked whether they have moved."""
        return len(self.free)

    def left(self, moved: Sequence[int]) -> float:
        """Chi-squared of the differences with those at these places explained."""
        pull = self.information @ self.difference
        total = float(self.difference @ pull)
        if not moved:
            return total
        chosen = np.array(moved)
        part = self.information[np.ix_(chosen, chosen)]
        return max(total - float(pull[chosen] @ np.linalg.lstsq(part, pull[chosen], rcond=1e-10)[0]), 0.0)

    def log_p(self, gain: float) -> float:
        """Log probability that chance alone gains so much of the chi-squared by one parameter."""
        return float(log_probability(np.array(self.dof * np.log1p(gain / self.dof)), 1, self.dof))

    @property
    def price(self) -> float:
        """The chi-squared that a parameter must gain for chance to be ruled out."""
        low, high = 0.0, 1e3
        while high - low > 1e-3:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.log_p(middle) > self.threshold else (low, middle)
        return high

    def moved(self) -> tuple[int, ...]:
        """Places of the parameters that have moved: the set with the smallest chi-squared plus the price of each."""
        price = self.price
        best: tuple[int, ...] = ()
        for size in range(1, min(_ALL_SETS, self.family) + 1):
            sets = itertools.combinations(range(self.family), size)
            best = min([best, *sets], key=lambda chosen: self.left(chosen) + price * len(chosen))
        while (larger := self._improved(best, price)) != best:
            best = larger
        return best

    def _improved(self, chosen: tuple[int, ...], price: float) -> tuple[int, ...]:
        """The set with one parameter more, less or exchanged, where that is better."""
        others = [place for place in range(self.family) if place not in chosen]
        without = [tuple(one for one in chosen if one != place) for place in chosen]
        tried = [chosen, *without, *((*rest, other) for rest in (chosen, *without) for other in others)]
        return min(tried, key=lambda places: self.left(places) + price * len(places))

    def changes(self, fit: Fit, twin: Chain) -> tuple[Change, ...]:
        """What has moved, largest first, each with the own parameters that would do as well in its place."""
        moved = self.moved()
        found = []
        for place in moved:
            rest = tuple(other for other in moved if other != place)
            gain = self.left(rest) - self.left(moved)
            instead = [
                other
                for other in range(self.family)
                if other not in moved and self.left((*rest, other)) < self.left(moved) + self.same
            ]
            one, log_p = self.free[place], self.log_p(gain)
            found.append(
                Change(
                    free=one,
                    owner=find(one.key, fit.chain.effects).owner(one.name),
                    was=value_of(twin, one),
                    gain=gain,
                    log_p=log_p,
                    family_log_p=log_p + float(np.log(self.family)),
                    rivals=tuple(f"{self.free[other].key}.{self.free[other].name}" for other in instead),
                )
            )
        return tuple(sorted(found, key=lambda change: -change.gain))


def _told(fit: Fit, free: Sequence[Free]) -> Array:
    """What a recording tells of some of a fit's free parameters, per variance of its noise: an information matrix.

    Of all others nothing is known: what they can do is taken out of every column.
    """
    _, j = fit.whitened()
    tested = [fit.free.index(one) for one in free]
    columns = projected(j[tested], j[[place for place in range(len(fit.free)) if place not in set(tested)]])
    return np.asarray(columns @ columns.T)


def _hardly_known(twin: Fit, free: Sequence[Free], one: Free, variance: float) -> bool:
    """Whether a strength with a phase is within three sigma of none in the twin: its phase may then be any."""
    effect = find(one.key, twin.chain.effects)
    if not effect.roles("phase") or one.name not in effect.roles("strength"):
        return False
    told = _told(twin, free)
    size = np.sqrt(np.maximum(np.diag(told), 1e-300))
    place = list(free).index(one)
    spread = np.linalg.pinv(told / np.outer(size, size), rcond=1e-12, hermitian=True)[place, place] / size[place] ** 2
    return value_of(twin.chain, one) ** 2 < twin.settings.sigma_apart**2 * variance * float(spread)


def _parallel(first: Array, second: Array) -> Array:
    """The information on a difference of two estimates: the inverse of the sum of their covariances, which may not be.

    It is their parallel sum, A (A + B)^+ B (Anderson and Duffin, J. Math. Anal. Appl. 26, 1969, 576-594).
    """
    size = np.sqrt(np.maximum(np.diag(first + second), 1e-300))
    a, b = first / np.outer(size, size), second / np.outer(size, size)
    both = a @ np.linalg.pinv(a + b, rcond=1e-12, hermitian=True) @ b
    return np.asarray(0.5 * (both + both.T) * np.outer(size, size))


def another_device(fit: Fit, free: Sequence[Free], changes: Sequence[Change]) -> bool:
    """Whether so much of what belongs to the device has moved that it is another one: three parameters and most."""
    asked = sum(find(one.key, fit.chain.effects).owner(one.name) == "device" for one in free)
    moved = sum(change.owner == "device" for change in changes)
    return moved >= _FEWEST_MOVED and 2 * moved > asked


def _away(fit: Fit, twin: Chain, one: Free) -> float:
    """How far a parameter is from the twin's; a phase by the shorter way round."""
    away = value_of(fit.chain, one) - value_of(twin, one)
    phase = find(one.key, twin.effects).params[one.name].role == "phase"
    return float(wrap_deg(away)) if phase else away
