"""The fits of sets of causes over several air gaps, each made when it is asked for."""

from __future__ import annotations

from functools import cached_property

from diagnosis.factors.gap_fit import GapFit, Problem
from diagnosis.factors.gap_sets import BESIDE_SENSOR, BOTH, TILTED, CauseSet, joined, order_1_sets

SEEN_SIGMA = 5.0
"""Standard errors of a sensor's displacement from which a magnet's can be looked for: it shows in their product."""
CLEAR_CHI2 = SEEN_SIGMA**2
"""By how much worse electronics or sensor alone fit than the other for certain."""


SAME_CHI2 = 1e-3
"""Difference of chi2 that the fit's own tolerance may leave."""


class GapFits(dict[CauseSet, GapFit]):
    """Fits by their causes, made when they are first asked for, from the best simpler one that is there.

    None fits worse than one with some of its causes: where a simpler one turns out better, it is fitted anew from that.
    """

    def __init__(self, problem: Problem, freedom: int) -> None:
        super().__init__()
        self.problem, self.freedom = problem, freedom

    def __missing__(self, causes: CauseSet) -> GapFit:
        # What stands in a product beside the sensor's displacement has no slope where that is still none, and one of
        # two such causes may lead the other astray.
        for name in causes:
            if name in BESIDE_SENSOR:
                self[tuple(other for other in causes if other != name)]
        self[causes] = self.problem.fitted(causes, self.freedom, start=self._best_within(causes))
        for one in sorted((one for one in self if set(causes) <= set(one)), key=len):
            self._improve(one)
        return self[causes]

    def _best_within(self, causes: CauseSet) -> GapFit | None:
        """The best of the fits with some of these causes."""
        simpler = (fit for one, fit in self.items() if set(one) < set(causes))
        return min(simpler, key=lambda fit: fit.chi2, default=None)

    def _improve(self, causes: CauseSet) -> None:
        """Fit again from a simpler fit that is better: this one ended in a local minimum."""
        simpler = self._best_within(causes)
        if simpler is not None and self[causes].chi2 > simpler.chi2 + SAME_CHI2:
            self[causes] = self.problem.fitted(causes, self.freedom, start=simpler)

    @cached_property
    def sees_sensor(self) -> bool:
        """Whether a sensor off the axis stands out: what shows in a product with it can then be looked for."""
        return _stands_out(self[joined(("voltage",), BOTH)], "sensor")

    def full_2(self) -> CauseSet:
        """The causes of order 2 that can be looked for together: each takes a gap."""
        return TILTED if self.sees_sensor and len(self.problem.sweeps) >= len(TILTED) else BOTH

    def order_1(self) -> tuple[CauseSet, ...]:
        """The sets of causes of order 1 that can be looked for.

        What shows beside a sensor off the axis where there may be one; what a tilted sensor on the axis senses where
        the electronics, whose share a tilt has, fit as well as or better than a sensor off the axis.
        """
        sensor, electronics = (self[("voltage", name)] for name in ("sensor", "electronics"))
        worse = sensor.chi2 - electronics.chi2
        off_axis = self.sees_sensor or (_stands_out(sensor, "sensor") and worse < CLEAR_CHI2)
        tilted = not self.sees_sensor and _stands_out(electronics, "electronics") and -worse < CLEAR_CHI2
        return order_1_sets(len(self.problem.sweeps), off_axis=off_axis, tilted=tilted)


def _stands_out(fit: GapFit, cause: str) -> bool:
    value, error = fit.pair(cause)
    return abs(value) > SEEN_SIGMA * error
