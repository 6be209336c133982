"""Quantisation: the grid that all readings lie on, the finite set of a truncated CORDIC, and when either is a cause."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise.rounding import coarsest_stair
from diagnosis.discovery.marks.outliers import local_rms
from diagnosis.discovery.marks.row_masks import raw_residual
from diagnosis.discovery.marks.stairs import reblurred, without_stairs
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import TAU, Array
from twin.catalogue import output_grid
from twin.chain import Chain
from twin.effect import Effect
from twin.sweep import Sweep
from twin.words import decimal_step, word_length

CELLS_OFF = (np.array([0]), np.array([-1, 0, 1]))
"""Cells of the output's grid that a word may be off its angle: none, or one where it was cut off or rounded twice."""


def grid_bits(measured: Array, settings: DiscoverySettings) -> float | None:
    """The smallest word length (6 to 20 bits) on whose grid all readings (n,) [rad] lie; None: no such grid.

    The grid of a file with few decimals has no whole number of bits: 0.1 deg are 11.81.
    """
    words = np.unique(np.round(measured % TAU, 9)).size
    if words < settings.fewest_words:
        # A few angles lie on a coarse grid by the bench's choice, not by the word's length.
        return None
    word = word_length(measured, shortest=6)
    if word is not None:
        return float(word)
    step = decimal_step(measured)
    return None if step is None else float(np.log2(TAU / step))


def rounded(fit: Fit, sweep: Sweep, step: float) -> bool:
    """Whether the readings may have come to lie on their grid of ``step`` [rad] by rounding.

    Rounding leaves each off by anything up to half a step; that all lie much nearer to a smooth error has the
    probability of that share, to the power of the independent readings. Then they were chosen, as the index of a table
    is, or the bench stood at the middle of the codes: neither says anything of a word's length.
    """
    if sweep.reading_grid_deg is not None:
        return False
    off = np.abs(raw_residual(fit, sweep))[fit.observations.usable[fit.observations.group]]
    freedom = min(off.size, fit.rows) - len(fit.free)
    if freedom <= 0:
        return True
    share = 2.0 * float(np.max(off)) / step
    return bool(freedom * np.log(max(share, 1e-12)) > fit.settings.footprint_log_p)


def finite_set(
    measured: Array, effect: Effect, tried: Sequence[Mapping[str, float]], *, step: float, settings: DiscoverySettings
) -> tuple[Mapping[str, float], float]:
    """At which of the parameters tried the effect's set of attainable angles holds the readings (n,) [rad].

    ``step`` is the output grid [rad] that the set is rounded to. Chance is the share of the grid's cells that are in
    the set, to the power of the different words; a reading outside it is an error of the link, as rare as these are.
    Readings at even steps all round tell of no set: they were chosen, as the index of a table is.
    Returns the parameters and the log of the chance at any of those tried; none and 0: no such set.
    """
    assert effect.attainable is not None
    resolution = step if step > 0.0 else np.radians(2e-4)
    cells = round(TAU / resolution)
    words = np.round(measured / resolution).astype(np.int64) % cells
    different = np.unique(words)
    distinct = different.size
    if np.ptp(np.diff(different, append=different[0] + cells)) <= 2:
        # Each is rounded to a cell, so that two steps differ by up to two.
        return {}, 0.0
    best: tuple[Mapping[str, float], float] = ({}, 0.0)
    for values in tried:
        cell = np.round(effect.attainable(values) / resolution).astype(np.int64)[:, None]
        for off in CELLS_OFF:
            allowed = np.unique((cell + off) % cells)
            share = allowed.size / cells
            missed = int(np.count_nonzero(~np.isin(words, allowed)))
            if share > settings.set_share or missed > settings.set_missed * words.size:
                continue
            chance = (distinct - missed) * np.log(share) + missed * -np.log(settings.set_missed)
            log_p = chance + np.log(len(tried) * len(CELLS_OFF))
            if log_p < best[1]:
                best = (values, float(log_p))
    return best


def with_stairs(
    fit: Fit, sweep: Sweep, effects: Sequence[Effect], *, bits: float | None, family: int
) -> tuple[Fit, tuple[Finding, ...]]:
    """The fit with the stairs that the set of values shows, and those of them that are causes by that alone.

    ``bits`` is the word length on whose grid all readings lie, if there is one; ``family`` the number of effects that
    are looked for in the values. The grid becomes part of the model where it is not small against the noise; a finite
    set of angles is a cause.
    """
    step = TAU / 2.0**bits if bits is not None else 0.0
    chain, grid, settings = fit.chain, output_grid(effects), fit.settings
    measured = np.radians(sweep.measured_deg)
    found: list[Finding] = []
    for effect in effects:
        if effect.footprint != "values" or effect is grid or effect.name in chain.values:
            continue
        tried = effect.shapes(fit.observations.motion)
        values, log_p = finite_set(measured, effect, tried, step=step, settings=settings)
        if values and log_p < settings.effect_log_p(family):
            chain = chain.with_values({effect.name: dict(values)})
            found.append(Finding.among(family, effect.name, log_p, gain=-2.0 * log_p))
    if grid is not None and bits is not None and grid.name not in chain.values:
        sigma = local_rms(fit.residual[0])
        if step / np.sqrt(12.0) > settings.stairs_in_noise * sigma:
            chain = chain.with_values({grid.name: {grid.roles("level")[0]: bits}})
    return _blurred(fit, chain), tuple(found)


def _blurred(fit: Fit, chain: Chain) -> Fit:
    """The fit with a chain that has stairs, their blur found from what is left."""
    coarse = coarsest_stair(chain)
    if coarse == 0.0:
        return fit
    # Before the stairs are modelled they add step/sqrt(12) to what the noise leaves.
    rest = float(np.mean(fit.residual[0][fit.observations.usable] ** 2)) - coarse**2 / 12.0
    blur = float(np.sqrt(max(rest, (0.05 * coarse) ** 2)))
    fit = solve(evaluate(chain, fit.free, fit.observations, replace(fit.weighting, blur=blur)))
    return solve(reblurred(fit))


def grid_as_cause(fit: Fit, grid: Effect, *, step: float, family: int) -> Finding | None:
    """The output's grid as a cause: where its noise exceeds half of what is left otherwise, and its stairs are seen.

    Noise ahead of the grid blurs the stairs; where it blurs them away, nothing is gained by knowing them. ``step`` is
    the grid's [rad], ``family`` the number of effects that are looked for in the values.
    """
    blur, settings = fit.weighting.blur, fit.settings
    if grid.name not in fit.chain.values or blur <= 0.0 or step / np.sqrt(12.0) <= settings.stairs_cause_share * blur:
        return None
    use = fit.observations.usable
    plain = without_stairs(fit, grid.name)[use]
    rows = independent_rows(fit)
    # Nothing is left where the readings keep to the stairs exactly.
    left = max(float(np.mean(fit.residual[0][use] ** 2)), float(np.finfo(np.float64).tiny))
    gain = rows * float(np.log(np.mean(plain**2) / left))
    log_p = float(log_probability(np.array(gain), 1, int(rows)))
    return Finding.among(family, grid.name, log_p, gain=gain) if log_p < settings.effect_log_p(family) else None


def independent_rows(fit: Fit) -> float:
    """How many independent readings tell a mean square as well as the rows in use do, whose noise is correlated.

    With a spectrum S of mean 1 over the cosine coefficients the sum of squares has the variance ``2 sum(S^2)`` (in
    units of the noise's variance squared), where independent readings have 2 each.
    """
    spectrum = fit.observations.noise_spectrum(fit.weighting.family.members[fit.weighting.member])
    return max(fit.rows / float(np.mean(spectrum**2)), 1.0)
