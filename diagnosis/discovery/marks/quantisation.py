"""Quantisers as causes: the output's grid, and the finite set of angles of a truncated CORDIC."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.marks import footprints
from diagnosis.discovery.marks.stairs import reblurred, stair_step, without_stairs
from diagnosis.discovery.proof.cause import Named
from diagnosis.discovery.search.screening import log_probability
from twin.angles import TAU
from twin.effect import Effect
from twin.sweep import Sweep

STAIRS_GAIN = 25.0
"""Twice the log likelihood, five sigma, that the output's stairs must gain to be named."""


def with_stairs(fit: Fit, sweep: Sweep, effects: Sequence[Effect], bits: int | None, found: list[Named]) -> Fit:
    """The fit with the stairs that the set of values shows: a truncated CORDIC, the output's grid."""
    step = TAU / 2.0**bits if bits is not None else 0.0
    chain = fit.chain
    measured = np.radians(sweep.measured_deg)
    for effect in effects:
        if effect.footprint != "values" or effect.name == "output_quantisation" or effect.name in chain.values:
            continue
        name = effect.roles("level")[0]
        tried = [shape[name] for shape in effect.shapes(fit.evidence.motion)]
        value, log_p = footprints.finite_set(measured, effect, step, tried, name)
        if value and log_p < np.log(1e-6):
            chain = chain.with_values({effect.name: {name: value}})
            found.append(Named((effect.name,), log_p, -2.0 * log_p))
    sigma = footprints.robust_rms(footprints.local_residual(fit.residual[0]))
    if bits is not None and step / np.sqrt(12.0) > 0.1 * sigma and "output_quantisation" not in chain.values:
        chain = chain.with_values({"output_quantisation": {"bits": float(bits)}})
    coarse = stair_step(chain, step)
    if coarse == 0.0:
        return fit
    # Before the stairs are modelled they add step/sqrt(12) to what the noise leaves.
    rest = float(np.mean(fit.residual[0][fit.evidence.usable] ** 2)) - coarse**2 / 12.0
    blur = float(np.sqrt(max(rest, (0.05 * coarse) ** 2)))
    fit = solve(evaluate(chain, fit.free, fit.evidence, replace(fit.setting, blur=blur)))
    return solve(reblurred(fit, step))


def quantisation(fit: Fit, bits: int | None, step: float, found: list[Named]) -> None:
    """The output's grid is a cause where its noise exceeds half of what is left otherwise, and its stairs are seen.

    Noise ahead of the grid blurs the stairs; where it blurs them away, nothing is gained by knowing them.
    """
    if bits is None or "output_quantisation" not in fit.chain.values or fit.setting.blur <= 0.0 or found:
        return
    use = fit.evidence.usable
    plain = without_stairs(fit, "output_quantisation")[use]
    gain = int(use.sum()) * float(np.log(np.mean(plain**2) / np.mean(fit.residual[0][use] ** 2)))
    if step / np.sqrt(12.0) > 0.5 * fit.setting.blur and gain > STAIRS_GAIN:
        log_p = float(log_probability(np.array(gain), 1, int(use.sum())))
        found.append(Named(("output_quantisation",), log_p, gain))
