"""Falling lines: whether lines that one cause makes at two orders belong to a body that has lines at the others too.

A sensor of p periods makes lines at p and 2p and nothing in between. A magnet makes lines at all orders, which fall off
with the order: the potential of each falls with another power of the distance. Two descriptions of the lines at all
orders are held against each other by their evidence: either their sizes are draws from one law that falls with the
order, or those at p and 2p have sizes of their own, and the law is that of the others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.intervals import standard_deviations
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.usual_factors import with_usual_factors
from diagnosis.discovery.search.lines import in_their_place, lines_of
from diagnosis.discovery.search.parts import of_parts
from diagnosis.discovery.search.screening import Base, screen_one
from twin.angles import Array
from twin.catalogue import find
from twin.effect import BoolArray, Effect

_LEVELS = 60
_FALLS = np.linspace(0.05, 1.0, 20)
"""From one order to the next a line is so many times as large: outside the body less than once."""

_ABSENT = 0.5
"""A line of the law is as likely there as not."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Sizes (n,) of lines at ascending orders (n,), and the standard deviations (n,) of each of their two waves."""

    orders: Array
    sizes: Array
    deviations: Array

    def of(self, chosen: BoolArray) -> Lines:
        """Those of a mask (n,)."""
        return Lines(self.orders[chosen], self.sizes[chosen], self.deviations[chosen])

    def log_evidence(self, levels: Array, *, absent: float) -> float:
        """Log probability density of the lines as draws from one law, over all levels and falls, each as likely.

        A line of the law has two waves, draws from one normal distribution, whose scatter falls with the order. A line
        is ``absent`` with that probability: what makes them need not be at every order.
        """
        if not self.orders.size:
            return 0.0
        fall = _FALLS[:, None] ** (self.orders - self.orders[0])
        there = self._log_density((levels[:, None, None] * fall) ** 2) + np.log1p(-absent)
        if absent > 0.0:
            there = np.logaddexp(there, self._log_density(0.0) + np.log(absent))
        log_density = np.sum(there, axis=-1)
        return float(np.logaddexp.reduce(log_density, axis=None) - np.log(log_density.size))

    def _log_density(self, scatter: Array | float) -> Array:
        """That of each line (..., n), but for a constant, where its waves scatter by so much (variance)."""
        variance = scatter + self.deviations**2
        return np.asarray(-np.log(variance) - 0.5 * self.sizes**2 / variance)


def falling_odds(lines: Lines, own: Sequence[int], largest: float) -> float:
    """Log odds that lines of the orders ``own`` are draws from the law of all, against sizes of their own.

    ``largest`` is the largest size that a line may have: from the noise up to it each size is as likely, by its log.
    """
    levels = np.geomspace(float(np.min(lines.deviations)), largest, _LEVELS)
    apart = sum(lines.of(lines.orders == order).log_evidence(levels, absent=0.0) for order in own)
    others = lines.of(~np.isin(lines.orders, own))
    return lines.log_evidence(levels, absent=_ABSENT) - apart - others.log_evidence(levels, absent=_ABSENT)


def as_lines_of_a_body(fit: Fit, keys: Sequence[str], effect: Effect) -> tuple[Fit, tuple[str, ...]] | None:
    """The fit with the lines of a cause as those of a body of which others are found; None where they are not.

    ``effect`` is a line of the body. Only the readings' own likelihood is asked first: the lines must explain them as
    well as the cause does.
    """
    lines = lines_of(fit, keys)
    orders = _orders(fit, effect)
    held = [key for key, own in lines.items() if len(own) == 1 and own[0] in orders]
    for key, own in lines.items():
        cause = find(key, fit.chain.effects)
        # Where its orders are known beforehand, as by --pole-pairs, they are not asked for.
        chosen = len(cause.shapes(fit.linear.motion)) > 1
        if not of_parts(cause) or not chosen or not held or not set(own) <= set(orders):
            continue
        replaced = [key, *held]
        covered = sorted({order for one in replaced for order in lines[one]})
        trial = in_their_place(fit, effect, replaced, shape={}, orders=covered)
        if trial is None:
            continue
        joint, added = trial
        if _fall_off(joint, dict(zip(covered, added, strict=True)), own, effect):
            return joint, (*(one for one in keys if one not in replaced), *added)
    return None


def of_a_body(fit: Fit, keys: Sequence[str], own: Sequence[int], effect: Effect) -> bool:
    """Whether lines of the orders ``own``, which these keys of the fit make one each, are those of such a body.

    ``effect`` is a line of the body; where one of the orders is none of its, they are not.
    """
    orders = _orders(fit, effect)
    held = {found[0]: key for key, found in lines_of(fit, keys).items() if len(found) == 1 and found[0] in orders}
    return set(own) <= set(held) and _fall_off(fit, held, own, effect)


def _orders(fit: Fit, effect: Effect) -> list[int]:
    """The orders, ascending, at which a body may have a line on this record."""
    return sorted({int(shape["order"]) for shape in effect.shapes(fit.linear.motion)})


def _fall_off(fit: Fit, held: Mapping[int, str], own: Sequence[int], effect: Effect) -> bool:
    """Whether lines of the orders ``own`` are likelier draws from the law of all lines than of sizes of their own.

    How large they are is counted beside usual factors: the quadratic term makes order 3 too, of any size.
    """
    found = _at_all_orders(with_usual_factors(fit), effect, held)
    return found is not None and falling_odds(found, own, effect.params["amplitude_deg"].upper) > 0.0


def _at_all_orders(fit: Fit, effect: Effect, held: Mapping[int, str]) -> Lines | None:
    """The lines that the fit holds, by order, and what it leaves at the other orders; None where one is not told."""
    deviations, base = standard_deviations(fit), Base.of(fit)
    orders, sizes, scatters = _orders(fit, effect), [], []
    for order in orders:
        if order in held:
            sizes.append(float(fit.chain.values[held[order]]["amplitude_deg"]))
            scatters.append(deviations[held[order], "amplitude_deg"])
            continue
        candidate = screen_one(base, effect, shapes=[{"order": float(order)}])
        if candidate is None:
            return None
        sizes.append(float(candidate.values["amplitude_deg"]))
        # Twice the gain in log likelihood is the square of a size over its deviation.
        scatters.append(sizes[-1] / float(np.sqrt(candidate.gain)))
    found = Lines(np.array(orders, dtype=np.float64), np.array(sizes), np.array(scatters))
    return found if np.all(np.isfinite(found.deviations) & (found.deviations > 0.0)) else None
