"""Parts: of a cause that joins what shows by itself each part has to, or the others are something else."""

from __future__ import annotations

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise.plausible import either, plausible_members
from diagnosis.discovery.search.likelihood_ratio import judged_p, likelihood, refit
from twin.catalogue import find
from twin.effect import Effect


def of_parts(effect: Effect) -> bool:
    """Whether an effect joins what shows by itself."""
    return effect.comb is not None and bool(effect.comb.parts)


def lacks_a_part(fit: Fit, key: str, level: float) -> bool:
    """Whether noise gains as much as one of the parts of a cause does, by a log probability above ``level``."""
    effect = find(key, fit.chain.effects)
    return any(_log_p(fit, key, part) > level for part in effect.comb.parts) if effect.comb is not None else False


def _log_p(fit: Fit, key: str, part: tuple[str, ...]) -> float:
    """Log probability that noise gains as much as these strengths of a cause."""
    null = find(key, fit.chain.effects).null()
    values = {**fit.chain.values[key], **{name: null[name] for name in part}}
    free = [one for one in fit.free if one.key != key or one.name not in part]
    plain = refit(fit.chain.with_values({key: values}), free, fit)
    members = either(plausible_members(plain), plausible_members(fit))
    gain = 2.0 * (likelihood(fit, members) - likelihood(plain, members))
    return judged_p(gain, len(part), plain.freedom, 1.0)
