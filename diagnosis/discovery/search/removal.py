"""Removal: what one cause that is in the joint fit does there, seen from the fit without it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import degrees, judged_p, likelihood, solve_tidy, take_out
from diagnosis.discovery.search.screening import Base, Candidate, screen_one
from twin.catalogue import find
from twin.effect import Effect


@dataclass(frozen=True, eq=False)
class Removal:
    """A cause against the fit without it.

    ``without`` is fitted anew; ``removed`` has all else left where it is, and ``base`` screens what comes back there.
    ``own`` is the effect itself as screened on that. ``gain`` is twice the gain in log likelihood with the noise that
    the fit has, ``log_p`` the log probability that noise gains as much.
    """

    effect: Effect
    without: Fit
    removed: Fit
    base: Base
    own: Candidate | None
    gain: float
    log_p: float

    @classmethod
    def of(cls, fit: Fit, key: str) -> Removal:
        """Take the cause out and see what is lost."""
        effect = find(key, fit.chain.effects)
        removed = take_out(fit, key)
        without = solve_tidy(removed)
        base = Base.of(removed)
        # Without it the noise stays what it is with it: else structure that comes back would pass for noise.
        gain = 2.0 * (likelihood(fit) - likelihood(without))
        own = screen_one(base, effect)
        removal = cls(effect, without, removed, base, own, gain, 0.0)
        return replace(removal, log_p=removal.judged(gain))

    def judged(self, gain: float) -> float:
        """Log probability that noise gains as much by this effect."""
        terms = degrees(self.effect, len(self.without.linear.terms(self.effect)))
        return judged_p(gain, terms, self.base.dof, self.own.looks if self.own is not None else 1.0)
