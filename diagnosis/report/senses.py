"""Who counts which way, and whether these readings tell: the mirrored twin differs in its quadratic term alone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from diagnosis.discovery.fitting.joint_fit import evaluate, solve
from diagnosis.discovery.result import Discovery
from diagnosis.discovery.search.likelihood_ratio import likelihood
from twin.baseline import FACTORS
from twin.chain import Chain


def senses(found: Discovery) -> dict[str, Any]:
    """Senses of sensor and output, whether the data decide between them and the mirrored pair, and that pair's factors.

    Recorded channels and a given twin decide; angles alone do by the odds that the search asks for.
    """
    fit = found.fit
    said: dict[str, Any] = {"sensor": fit.chain.sensor_sense, "output": fit.chain.output_sense, "decided": True}
    said |= {"log_odds": None, "mirrored": None}
    by_channels = fit.observations.observables == 2 or found.sweep.senses is not None
    if found.given is not None or by_channels:
        return said
    other = solve(evaluate(fit.chain.mirrored(), fit.free, fit.observations, replace(fit.weighting, slopes=False)))
    same = evaluate(fit.chain, fit.free, fit.observations, replace(fit.weighting, slopes=False))
    odds = likelihood(same) - likelihood(other)
    decided = odds > fit.settings.swap_log_odds
    return {**said, "decided": decided, "log_odds": odds, "mirrored": None if decided else _factors(other.chain)}


def _factors(chain: Chain) -> dict[str, float]:
    """The values of the six factors in a chain, by the names of the JSON."""
    return {f.name: float(chain.values.get(f.key, {}).get(f.param, f.null)) * f.scale for f in FACTORS}
