"""What sweeps at several air gaps tell of one sensor: which causes, each with its law over the magnet's own field.

All gaps are fitted together (:mod:`diagnosis.factors.gap_fit`), with every set of causes that could be behind the
orders 1 and 2. A cause is named where every simplest set that fits has it; where two sets of equal size fit, the class
is named; where none does, nothing is.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from diagnosis.error_model.model import QUAD
from diagnosis.factors.displacement import MEASURED, Displacement, hull, magnet_displacement
from diagnosis.factors.gap_fit import GapFit, Problem
from diagnosis.factors.gap_model import CAUSES, GapSweep, causes_of, expected
from diagnosis.factors.mounting import Mounting
from twin.angles import Array

SURE = 6.3e-5
"""Probability by chance below which a simpler set of causes is rejected: four standard deviations."""
MISFIT = 1e-3
"""Probability of a chi2 as large below which no set of causes is said to hold the readings."""
SEEN_SIGMA = 5.0
"""Standard errors of a sensor's displacement from which a magnet's can be looked for: it shows in their product."""
MOST_SWEEPS = 64
"""More are not fitted together: the work goes with the square of their number."""
HELD_SHARE = 0.1
"""Of the field's change over the gaps, in logarithms: channels that change by less do not follow the field."""
SMALLEST_CHANGE = 0.1
"""Relative change of the field from which sweeps count as different air gaps."""
_GAPS_TRIED = 60
_PARTED_SIGMA = 6.0
"""By how many standard errors two causes are to differ at a further gap: four are asked for, and either may be off."""
BOTH = ("electronics", "sensor")
TILTED = ("electronics", "sensor", "tilt")
ORDER_1: tuple[tuple[str, ...], ...] = ((), ("voltage",), ("reference",), ("voltage", "reference"))
ORDER_2: tuple[tuple[str, ...], ...] = ((), ("electronics",), ("sensor",), BOTH, ("sensor", "tilt"), TILTED)
OF_ORDER_2 = frozenset(TILTED)
BESIDE_SENSOR = frozenset({"magnet", "tilt"})
WITH_MAGNET = ("voltage", "magnet")


@dataclass(frozen=True)
class Law:
    """How one part of the factors goes over the air gaps, and by how many sigma the law "stays" fits worse."""

    part: str
    best: str
    change_sigma: float
    chi2: float = 0.0
    degrees_of_freedom: int = 0
    p: float = 1.0
    """Of the best law."""


@dataclass(frozen=True, eq=False)
class AirGaps:
    """The joint fit of several air gaps."""

    mounting: Mounting
    names: tuple[str, ...]
    order_1: tuple[tuple[str, ...], ...]
    """The simplest sets of causes that hold the offsets, equally good ones side by side."""
    order_2: tuple[tuple[str, ...], ...]
    """The same for gain ratio and phase."""
    fullest: GapFit
    """With every cause that could be told from the others."""
    full_2: tuple[str, ...]
    """The causes of order 2 that could be told from one another."""
    fits: Mapping[tuple[str, ...], GapFit] = field(repr=False)
    quadratic: Law
    parting_mm: float | None
    """The nearest air gap that would part electronics from a sensor off the axis; None where there is none in reach."""
    amplitudes_held: bool = False
    """Whether the channels are of one size at all stated gaps, so that they gauge no gap."""

    @property
    def misfit(self) -> bool:
        """Whether no set of causes holds the readings, or only one that no reading is left to check."""
        return self.fullest.p < MISFIT or self.unchecked

    @property
    def unchecked(self) -> bool:
        """Whether the simplest sets have as many numbers as there are readings of their order."""
        return max(map(len, (*self.order_1, *self.order_2))) >= len(self.names)

    @property
    def best(self) -> GapFit:
        """The fit of the simplest sets; of several equally good ones, that with the smallest chi2."""
        return min((self.fit_of(one, two) for one in self.order_1 for two in self.order_2), key=lambda fit: fit.chi2)

    @property
    def simpler(self) -> GapFit:
        """The best fit whose causes some reading is left to check."""
        few = (fit for fit in self.fits.values() if _most_of_an_order(fit.causes) < len(self.names))
        return min(few, key=lambda fit: fit.chi2)

    @property
    def told(self) -> GapFit:
        """The fit whose figures are told: the best one, or where none holds that which says by how much."""
        if not self.misfit:
            return self.best
        return self.fullest if self.fullest.p < MISFIT else self.simpler

    def fit_of(self, order_1: tuple[str, ...], order_2: tuple[str, ...]) -> GapFit:
        """The fit of a set of causes."""
        return self.fits[joined(order_1, order_2)]

    def displaced(self, cause: str) -> Displacement | None:
        """The displacement [mm] of ``sensor`` or ``magnet``, or the ``tilt`` [deg]; None where it is not named.

        Of several equally good sets the interval holds what each of them says.
        """
        if cause not in self.named:
            return None
        fits = sorted((self.fit_of(one, two) for one in self.order_1 for two in self.order_2), key=lambda fit: fit.chi2)
        return hull([found for fit in fits if (found := MEASURED[cause](fit)) is not None])

    @property
    def magnet_bound_mm(self) -> float | None:
        """Upper end of the magnet's displacement [mm] where none is named; None where none can be told."""
        fullest = self.fits.get(joined(WITH_MAGNET, self.full_2))
        if fullest is None or "sensor" not in self.named or "magnet" in self.named:
            return None
        found = magnet_displacement(fullest)
        return None if found is None else found.high

    @property
    def named(self) -> tuple[str, ...]:
        """The causes that every one of the simplest sets has; none where nothing fits."""
        if self.misfit:
            return ()
        shared = (set.intersection(*map(set, sets)) for sets in (self.order_1, self.order_2))
        return joined(*shared)


def air_gaps(sweeps: Sequence[GapSweep], names: Sequence[str], mounting: Mounting, freedom: int) -> AirGaps | None:
    """The joint fit; None where the air gaps are unknown or hardly differ. ``freedom``: of the sweeps' variances."""
    start = start_gaps(sweeps, mounting)
    if start is None:
        return None
    sweeps, held = without_held_amplitudes(sweeps, mounting)
    fits = _Fits(Problem(tuple(sweeps), mounting, start), freedom)
    full_2, sets_1 = fits.full_2(), fits.order_1()
    order_1 = _simplest(fits, [(one, full_2) for one in sets_1])
    first = order_1[0]
    sets_2 = [two for two in ORDER_2 if set(two) <= set(full_2) and ("magnet" not in first or "sensor" in two)]
    order_2 = _simplest(fits, [(first, two) for two in sets_2])
    for one in order_1:
        for two in order_2:
            fits[joined(one, two)]
    full = [fits[joined(one, full_2)] for one in sets_1]
    most = max(len(fit.causes) for fit in full)
    either = {("electronics",), ("sensor",)} <= set(order_2)
    return AirGaps(
        mounting=mounting,
        names=tuple(names),
        order_1=order_1,
        order_2=order_2,
        full_2=full_2,
        fullest=min((fit for fit in full if len(fit.causes) == most), key=lambda fit: fit.chi2),
        fits=fits,
        quadratic=quadratic_law([sweep.point[QUAD] for sweep in sweeps], _errors(sweeps), mounting.field_mT(start)),
        parting_mm=_parting_mm(sweeps[0], fits, first) if either else None,
        amplitudes_held=held,
    )


class _Fits(dict[tuple[str, ...], GapFit]):
    """Fits by their causes, made when they are first asked for, from the best simpler one that is there."""

    def __init__(self, problem: Problem, freedom: int) -> None:
        super().__init__()
        self.problem, self.freedom = problem, freedom

    def __missing__(self, causes: tuple[str, ...]) -> GapFit:
        # What stands in a product beside the sensor's displacement has no slope where that is still none, and one of
        # two such causes may lead the other astray.
        simpler = [self[tuple(other for other in causes if other != name)] for name in causes if name in BESIDE_SENSOR]
        simpler += [fit for one, fit in self.items() if set(one) < set(causes)]
        start = min(simpler, key=lambda fit: fit.chi2) if simpler else None
        self[causes] = found = self.problem.fitted(causes, self.freedom, start=start)
        return found

    @cached_property
    def sees_sensor(self) -> bool:
        """Whether a sensor off the axis stands out: what shows in a product with it can then be looked for."""
        value, error = self[joined(("voltage",), BOTH)].pair("sensor")
        return abs(value) > SEEN_SIGMA * error

    def full_2(self) -> tuple[str, ...]:
        """The causes of order 2 that can be looked for together: each takes a gap."""
        return TILTED if self.sees_sensor and len(self.problem.sweeps) >= len(TILTED) else BOTH

    def order_1(self) -> tuple[tuple[str, ...], ...]:
        """The sets of causes of order 1 that can be looked for."""
        return (*ORDER_1, WITH_MAGNET) if self.sees_sensor else ORDER_1


def start_gaps(sweeps: Sequence[GapSweep], mounting: Mounting) -> Array | None:
    """The air gaps [mm] as stated, or as amplitudes tell them; None where neither does or the field hardly differs."""
    logs = [sweep.log_amplitude for sweep in sweeps]
    if not 2 <= len(sweeps) <= MOST_SWEEPS or not all(sweep.usable for sweep in sweeps):
        return None
    if len(mounting.air_gap_mm) == len(sweeps):
        gaps = np.array(mounting.air_gap_mm)
    elif None not in logs:
        gaps = mounting.gaps_by_amplitude([float(np.exp(one or 0.0)) for one in logs])
    else:
        return None
    field = mounting.field_mT(gaps)
    return gaps if np.ptp(field) >= SMALLEST_CHANGE * field.max() else None


def without_held_amplitudes(sweeps: Sequence[GapSweep], mounting: Mounting) -> tuple[Sequence[GapSweep], bool]:
    """The sweeps, without their amplitudes where these do not follow the field of the stated gaps; whether they do not.

    An automatic gain, or a record in shares of the amplitude, holds the channels at one size. They are taken for such
    where they change by less than a tenth of what the field does.
    """
    logs = [sweep.log_amplitude for sweep in sweeps]
    if len(mounting.air_gap_mm) != len(sweeps) or None in logs:
        return sweeps, False
    demanded = np.ptp(np.log(mounting.field_mT(np.array(mounting.air_gap_mm))))
    if np.ptp(np.array(logs, dtype=np.float64)) > HELD_SHARE * demanded:
        return sweeps, False
    return [replace(sweep, log_amplitude=None) for sweep in sweeps], True


def quadratic_law(values: Sequence[float], errors: Array, field_mT: Array) -> Law:
    """How the quadratic term goes: q = K1 mag / K2 grows with the field where it is the sensor's."""
    value, weight = np.asarray(values), 1.0 / errors**2
    shapes = {"none": 0.0 * field_mT, "stays": np.ones_like(field_mT), "grows with the field": field_mT}
    chi2 = {}
    for name, shape in shapes.items():
        size = np.sum(weight * shape * value) / max(float(np.sum(weight * shape**2)), 1e-300)
        chi2[name] = float(np.sum(weight * (value - size * shape) ** 2))
    best = min(("stays", "grows with the field"), key=lambda name: chi2[name])
    freedom = value.size - 1
    if chi2["none"] - chi2[best] < _limit(1, 10**6):
        best, freedom = "none", value.size
    p = _chance(chi2[best], freedom)
    change = float(np.sqrt(max(chi2["stays"] - chi2[best], 0.0)))
    return Law("quadratic term", best if p >= MISFIT else "none fits", change, chi2[best], freedom, p)


def laws(found: AirGaps) -> tuple[Law, ...]:
    """The law of each part of the factors, in words of a line."""
    best = found.best

    def law(part: str, sets: Iterable[tuple[str, ...]], stays: tuple[str, ...]) -> Law:
        words = " or ".join(" and ".join(_LAWS[name] for name in one) or "none" for one in sets)
        worse = found.fits.get(stays)
        change = 0.0 if worse is None else float(np.sqrt(max(worse.chi2 - best.chi2, 0.0)))
        told, fit = "none fits" if found.misfit else words, found.told
        return Law(part, told, change, fit.chi2, fit.degrees_of_freedom, fit.p)

    rest_1 = tuple(name for name in best.causes if name not in OF_ORDER_2)
    return (
        law("offset", found.order_1, joined(("reference",), found.full_2)),
        law("gain mismatch and phase", found.order_2, joined(rest_1, ("electronics",))),
        found.quadratic,
    )


_LAWS = {
    "voltage": "falls with the field",
    "reference": "stays",
    "electronics": "stays",
    "sensor": "follows the field off the axis",
    "magnet": "follows the field off the axis",
    "tilt": "follows the tilted field off the axis",
}


def joined(one: Iterable[str], two: Iterable[str]) -> tuple[str, ...]:
    """The causes of both sets, in the order of CAUSES."""
    held = {*one, *two}
    return tuple(name for name in CAUSES if name in held)


def _most_of_an_order(causes: Sequence[str]) -> int:
    second = sum(name in OF_ORDER_2 for name in causes)
    return max(second, len(causes) - second)


def _simplest(
    fits: _Fits, candidates: Sequence[tuple[tuple[str, ...], tuple[str, ...]]]
) -> tuple[tuple[str, ...], ...]:
    """Of sets of causes of the orders 1 and 2 the smallest that are not rejected against the largest, the best first.

    The sets differ in one order; what they have in that order is returned.
    """
    sets = {each: joined(*each) for each in candidates}
    most = max(map(len, sets.values()))
    largest = min((fits[one] for one in sets.values() if len(one) == most), key=lambda fit: fit.chi2)
    held = {
        each: one
        for each, one in sets.items()
        if fits[one].chi2 - largest.chi2 < _limit(2 * max(most - len(one), 1), largest.readings)
    }
    fewest = min(map(len, held.values()))
    kept = sorted((each for each, one in held.items() if len(one) == fewest), key=lambda each: fits[held[each]].chi2)
    varied = 0 if len({two for _, two in candidates}) == 1 else 1
    return tuple(each[varied] for each in kept)


def _parting_mm(sweep: GapSweep, fits: _Fits, order_1: tuple[str, ...]) -> float | None:
    """The air gap nearest to those measured at which the electronics and a sensor off the axis differ for certain."""
    rivals = [fits[joined(order_1, one)] for one in (("electronics",), ("sensor",))]
    known, magnet = rivals[0].gap_mm, fits.problem.mounting.magnet
    gaps = np.geomspace(0.3 * known.min(), 3.0 * known.max(), _GAPS_TRIED)
    told = []
    for fit in rivals:
        causes = causes_of(fit.causes, np.tile(fit.numbers, (_GAPS_TRIED, 1)))
        told.append(expected([sweep], magnet, causes, gaps[:, None])[0][:, 0])
    whitened = (told[0] - told[1]) @ np.linalg.inv(np.linalg.cholesky(sweep.covariance)).T
    enough = gaps[np.linalg.norm(whitened, axis=1) > _PARTED_SIGMA]
    if not enough.size:
        return None
    return float(enough[np.argmin(np.min(np.abs(np.log(enough[:, None] / known)), axis=1))])


def _limit(numbers: int, freedom: int) -> float:
    """Difference of chi2 for so many numbers more that chance exceeds with the probability SURE."""
    from scipy.special import fdtri

    return float(numbers * fdtri(numbers, freedom, 1.0 - SURE))


def _chance(chi2: float, freedom: int) -> float:
    from scipy.special import chdtrc

    return float(chdtrc(freedom, chi2)) if freedom > 0 else 1.0


def _errors(sweeps: Sequence[GapSweep]) -> Array:
    return np.array([sweep.quad_error for sweep in sweeps])
