"""Removal: what one cause that is in the joint fit does there, seen from the fit without it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.search.likelihood_ratio import degrees, judged_p, likelihood, solve_tidy, take_out
from diagnosis.discovery.search.screening import Base, Candidate, screen_one
from twin.catalogue import find
from twin.effect import Effect


@dataclass(frozen=True, eq=False)
class Removal:
    """A cause against the fit without it.

    ``removed`` has all else of ``fit`` left where it is, and ``base`` screens what comes back there. ``own`` is the
    effect itself as screened on that.
    """

    effect: Effect
    fit: Fit
    removed: Fit
    base: Base
    own: Candidate | None

    @classmethod
    def of(cls, fit: Fit, key: str) -> Removal:
        """Take the cause out."""
        effect = find(key, fit.chain.effects)
        removed = take_out(fit, key)
        base = Base.of(removed)
        return cls(effect, fit, removed, base, screen_one(base, effect))

    @cached_property
    def without(self) -> Fit:
        """The fit without the cause, all else fitted anew."""
        return solve_tidy(self.removed)

    @cached_property
    def gain(self) -> float:
        """Twice the gain in log likelihood with the noise that the fit has.

        Without the cause the noise stays what it is with it: else structure that comes back would pass for noise.
        """
        return 2.0 * (likelihood(self.fit) - likelihood(self.without))

    @cached_property
    def log_p(self) -> float:
        """Log probability that noise gains as much."""
        return self.judged(self.gain)

    def judged(self, gain: float) -> float:
        """Log probability that noise gains as much by this effect."""
        terms = degrees(self.effect, len(self.removed.linear.terms(self.effect)))
        return judged_p(gain, terms, self.base.dof, self.own.looks if self.own is not None else 1.0)
