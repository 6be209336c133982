"""What sweeps at several air gaps tell of one sensor: which causes, each with its law over the magnet's own field.

All gaps are fitted together (:mod:`diagnosis.factors.gap_fit`), with every set of causes that could be behind the
orders 1 and 2. A cause is named where every simplest set that fits has it; where two sets of equal size fit, the class
is named; where none does, nothing is.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from diagnosis.factors.displacement import MEASURED, Displacement, hull, tilt_on_axis
from diagnosis.factors.gap_fit import GapFit, Problem
from diagnosis.factors.gap_fits import GapFits
from diagnosis.factors.gap_model import GapSweep
from diagnosis.factors.gap_sets import (
    BESIDE_SENSOR,
    OF_ORDER_2,
    ORDER_2,
    CauseSet,
    go_together,
    joined,
    most_of_an_order,
)
from diagnosis.factors.mounting import Mounting, held_at_one_size
from twin.angles import Array

SURE = 6.3e-5
"""Probability by chance below which a simpler set of causes is rejected: four standard deviations."""
MISFIT = 1e-3
"""Probability of a chi2 as large below which no set of causes is said to hold the readings."""
MOST_SWEEPS = 64
"""More are not fitted together: the work goes with the square of their number."""
SMALLEST_CHANGE = 0.1
"""Relative change of the field from which sweeps count as different air gaps."""
_GAPS_TRIED = 15
_PARTED_SIGMA = 6.0
"""Standard errors by which a further gap is to tell two causes apart: four are asked for, and its own noise may take
away two."""

Pair = tuple[CauseSet, CauseSet]


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
    pairs: tuple[Pair, ...]
    """The simplest sets of causes of the offsets, and of gain ratio and phase: equally good ones, the best first."""
    fullest: GapFit
    """With every cause that could be told from the others."""
    full_2: CauseSet
    """The causes of order 2 that could be told from one another."""
    fits: GapFits = field(repr=False)
    parting_mm: float | None = None
    """The nearest air gap that would part the two best of several sets of ``order_2``; None: there is none in reach."""
    order_1_parting_mm: float | None = None
    """The same for ``order_1``."""
    amplitudes_held: bool = False
    """Whether the channels are of one size at all stated gaps, so that they gauge no gap."""

    @property
    def order_1(self) -> tuple[CauseSet, ...]:
        """The simplest sets of causes that hold the offsets, equally good ones side by side."""
        return tuple(dict.fromkeys(one for one, _ in self.pairs))

    @property
    def order_2(self) -> tuple[CauseSet, ...]:
        """The same for gain ratio and phase."""
        return tuple(dict.fromkeys(two for _, two in self.pairs))

    @property
    def misfit(self) -> bool:
        """Whether no set of causes holds the readings, or only one that no reading is left to check."""
        return not self.holds or self.unchecked

    @property
    def holds(self) -> bool:
        """Whether the readings do not contradict some set of causes."""
        return max(fit.p for fit in self.fits.values()) >= MISFIT

    @property
    def unchecked(self) -> bool:
        """Whether the simplest sets have as many numbers as there are readings of their order."""
        return max(map(len, (*self.order_1, *self.order_2))) >= len(self.names)

    @property
    def best(self) -> GapFit:
        """The fit of the simplest sets; of several equally good ones, that with the smallest chi2."""
        return self.equally_good[0]

    @property
    def equally_good(self) -> tuple[GapFit, ...]:
        """The fits of the simplest sets of both orders, the best first."""
        return tuple(self.fits[joined(*pair)] for pair in self.pairs)

    @property
    def simpler(self) -> GapFit:
        """The best fit whose causes some reading is left to check."""
        few = (fit for fit in self.fits.values() if most_of_an_order(fit.causes) < len(self.names))
        return min(few, key=lambda fit: fit.chi2)

    @property
    def told(self) -> GapFit:
        """The fit whose figures are told: the best one, or where none holds that which says by how much."""
        if not self.misfit:
            return self.best
        return self.simpler if self.holds else self.fullest

    def best_with(self, order_2: CauseSet) -> GapFit:
        """The best fit of those that have this set of order 2."""
        return next(self.fits[joined(*pair)] for pair in self.pairs if pair[1] == order_2)

    def displaced(self, cause: str) -> Displacement | None:
        """The displacement [mm] of ``sensor`` or ``magnet``, or their tilts [deg]; None where it is not named.

        ``tilt`` is the sensor's, ``magnet_tilt`` the magnet's.

        Of several equally good sets the interval holds what each of them says.
        """
        if cause not in self.named:
            return None
        return hull([found for fit in self.equally_good if (found := MEASURED[cause](fit)) is not None])

    @property
    def tilt_alone(self) -> Displacement | None:
        """The tilt [deg] of a sensor on the axis that would do what the electronics do.

        None where these are not named, or where a tilt beside the sensor's displacement was held against the gaps too.
        """
        if "electronics" not in self.named or ("sensor" in self.named and "tilt" in self.full_2):
            return None
        return hull([found for fit in self.equally_good if (found := tilt_on_axis(fit)) is not None])

    def magnet_bound(self, cause: str) -> float | None:
        """Upper end of the magnet's displacement ``magnet`` [mm] or tilt ``magnet_tilt`` [deg], beside what is named.

        Were it that alone of the two; of several equally good sets of offsets the largest end. None where either is
        named, where the sensor is not seen off the axis, or where no such fit holds the readings.
        """
        if "sensor" not in self.named or any(BESIDE_SENSOR & set(one) for one in self.order_1):
            return None
        beside = (joined((*one, cause), self.full_2) for one in self.order_1 if len(one) < len(self.names))
        fits = [fit for causes in beside if (fit := self.fits[causes]).p >= MISFIT]
        return max((found.high for fit in fits if (found := MEASURED[cause](fit)) is not None), default=None)

    @cached_property
    def quadratic(self) -> Law:
        """How the quadratic term goes, without what the field's own order 3 adds to it."""
        problem = self.fits.problem
        errors = np.array([sweep.quad_error for sweep in problem.sweeps])
        return quadratic_law(problem.quadratic(self.told), errors, self.mounting.field_mT(self.told.gap_mm))

    @property
    def named(self) -> CauseSet:
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
    fits = GapFits(Problem(tuple(sweeps), mounting, start), freedom)
    full_2, sets_1 = fits.full_2(), fits.order_1()
    pairs = _simplest_pairs(fits, sets_1, full_2)
    full = [fits[joined(one, full_2)] for one in sets_1 if joined(one, full_2) in fits]
    most = max(len(fit.causes) for fit in full)
    found = AirGaps(
        mounting=mounting,
        names=tuple(names),
        pairs=pairs,
        full_2=full_2,
        fullest=min((fit for fit in full if len(fit.causes) == most), key=lambda fit: fit.chi2),
        fits=fits,
        amplitudes_held=held,
    )
    if found.misfit:
        return found
    return replace(found, parting_mm=_parts(found, 1), order_1_parting_mm=_parts(found, 0))


def _simplest_pairs(fits: GapFits, sets_1: Sequence[CauseSet], full_2: CauseSet) -> tuple[Pair, ...]:
    """The simplest sets of order 1 beside all of order 2, and with these the simplest pairs of both.

    A pair that turns out better than the sets of order 1 were fitted from makes them better too: they are asked again.
    """
    sets_2 = [two for two in ORDER_2 if set(two) <= set(full_2)]
    asked: list[CauseSet] = []
    pairs: tuple[Pair, ...] = ()
    while (first := [one for one, _ in _simplest(fits, [(one, full_2) for one in sets_1])]) != asked:
        pairs = _simplest(fits, [(one, two) for one in first for two in sets_2 if go_together(one, two)])
        asked = first
    return pairs


def _parts(found: AirGaps, order: int) -> float | None:
    """The further gap that would tell the best pair from the best that differs in its first or second set."""
    best = found.pairs[0]
    other = next((pair for pair in found.pairs if pair[order] != best[order]), None)
    if other is None:
        return None
    return _parting_mm(found.fits, found.fits[joined(*best)], found.fits[joined(*other)])


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

    See :func:`~diagnosis.factors.mounting.held_at_one_size`.
    """
    logs = [sweep.log_amplitude for sweep in sweeps]
    if len(mounting.air_gap_mm) != len(sweeps) or None in logs:
        return sweeps, False
    field = mounting.field_mT(np.array(mounting.air_gap_mm))
    if not held_at_one_size(np.exp(np.array(logs, dtype=np.float64)), field=field):
        return sweeps, False
    return [replace(sweep, log_amplitude=None) for sweep in sweeps], True


def quadratic_law(values: Sequence[float] | Array, errors: Array, field_mT: Array) -> Law:
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

    def law(part: str, sets: Iterable[CauseSet], stays: CauseSet) -> Law:
        words = " or ".join(" and ".join(_LAWS[name] for name in one) or "none" for one in sets)
        change = float(np.sqrt(max(found.fits[stays].chi2 - best.chi2, 0.0)))
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
    "magnet_tilt": "follows the tilted magnet's field off the axis",
    "tilt_and_magnet": "follows the upright field of a magnet off the shaft",
    "both_tilts": "follows the upright field of a tilted magnet",
}


def _simplest(fits: GapFits, candidates: Sequence[Pair]) -> tuple[Pair, ...]:
    """Of pairs of sets of the orders 1 and 2 the smallest that are not rejected against larger ones, the best first.

    Once the misses of a pair are so few that two numbers more could not take away enough of them, no larger one is
    fitted.
    """
    asked: list[Pair] = []
    for size in sorted({len(one) + len(two) for one, two in candidates}):
        same = [pair for pair in candidates if len(joined(*pair)) == size]
        asked += same
        largest = min((fits[joined(*pair)] for pair in same), key=lambda fit: fit.chi2)
        if largest.chi2 < _limit(2, largest.readings) and largest.p >= MISFIT:
            break
    # As they are by now: a simpler fit that turned out better has made others better.
    fitted = {pair: fits[joined(*pair)] for pair in asked}
    held = [
        pair
        for pair, fit in fitted.items()
        if fit.chi2 - largest.chi2 < _limit(2 * max(size - len(fit.causes), 1), largest.readings)
    ]
    fewest = min(len(joined(*pair)) for pair in held)
    return tuple(sorted((pair for pair in held if len(joined(*pair)) == fewest), key=lambda pair: fitted[pair].chi2))


def _parting_mm(fits: GapFits, first: GapFit, second: GapFit) -> float | None:
    """The air gap nearest to those measured whose sweep would reject the second fit, were the first true.

    None where there is no such gap in reach.
    """
    known = first.gap_mm
    tried = np.geomspace(0.3 * known.min(), 3.0 * known.max(), _GAPS_TRIED)
    for gap in tried[np.argsort(np.min(np.abs(np.log(tried[:, None] / known)), axis=1))]:
        problem = fits.problem.with_sweep(float(gap), first)
        again = problem.fitted(second.causes, fits.freedom, start=second.with_gap(float(gap)))
        if again.chi2 - second.chi2 > _PARTED_SIGMA**2:
            return float(gap)
    return None


def _limit(numbers: int, freedom: int) -> float:
    """Difference of chi2 for so many numbers more that chance exceeds with the probability SURE."""
    from scipy.special import fdtri

    return float(numbers * fdtri(numbers, freedom, 1.0 - SURE))


def _chance(chi2: float, freedom: int) -> float:
    from scipy.special import chdtrc

    return float(chdtrc(freedom, chi2)) if freedom > 0 else 1.0
