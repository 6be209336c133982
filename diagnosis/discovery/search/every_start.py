"""Every start: a rival whose shape a sweep leaves open, fitted at each point of its grid (a profile likelihood).

One fit with its covariance tells how well a parameter is known near one optimum. Where an angle alone leaves a whole
curve of shapes that fit as well, the fits along that curve together tell how far it reaches.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.search.likelihood_ratio import TO_THE_END, likelihood, solve_tidy, take_out
from diagnosis.discovery.search.screening import Base, candidate_at, gains_of
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Effect
from twin.motion import Motion


def from_every_start(rival: Fit, name: str) -> tuple[Fit, ...]:
    """The fits that are as good as that of a rival, with its shape held at each point of its grid.

    Held is what nothing is known of before a sweep. Of an effect that the sweep shows by itself there is the one fit.
    """
    effect, motion = find(name, rival.chain.effects), rival.linear.motion
    if effect.visible_in(motion.provides):
        return (rival,)
    shapes = likeliest(effect, motion)
    held = {key for shape in shapes for key in shape if effect.params[key].prior_mean is None}
    free = tuple(one for one in rival.free if one.key != name or one.name not in held)
    least = likelihood(rival) - 0.5 * rival.settings.same_fit(coarse=rival.weighting.coarse)
    own = evaluate(rival.chain, free, rival.observations, rival.weighting)
    starts = (evaluate(chain, free, own.observations, own.weighting) for chain in _starts(rival, effect, shapes))
    fits = (solve_tidy(start, iterations=TO_THE_END) for start in starts)
    return (own, *(fit for fit in fits if likelihood(fit) > least))


def _starts(rival: Fit, effect: Effect, shapes: Sequence[Mapping[str, float]]) -> Iterator[Chain]:
    """The chain with the effect at each of the shapes, as strong as the best fit to first order there."""
    removed = take_out(rival, effect.name)
    base = Base.of(removed)
    gains, coefficients = gains_of(base, effect, shapes)
    for one in zip(shapes, gains[0], coefficients[0], strict=True):
        values = candidate_at(base, effect, *one).values
        # To first order it may be stronger than anything that its field can do.
        sizes = {
            key: np.clip(values[key], effect.params[key].lower, effect.params[key].upper)
            for key in effect.roles("strength")
        }
        yield removed.chain.with_values({effect.name: {**values, **sizes}})


def likeliest(effect: Effect, motion: Motion) -> Sequence[Mapping[str, float]]:
    """Shapes of the grid of an effect at which all that is known before a sweep is as likely as anywhere on it."""
    shapes = effect.shapes(motion)
    away = [sum(_away(effect, name, value) ** 2 for name, value in shape.items()) for shape in shapes]
    return [shape for shape, far in zip(shapes, away, strict=True) if far <= np.min(away) + 1e-9]


def _away(effect: Effect, name: str, value: float) -> float:
    """How many standard deviations a shape's parameter is from what is most likely; 0 where anything goes."""
    param = effect.params[name]
    return 0.0 if param.prior_mean is None else (value - param.prior_mean) / param.prior_sd
