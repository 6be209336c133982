"""Discovery: what the simulation gets wrong about a sweep, by name, with proof; or that nothing is wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.initial_fit import first_fit, mirrored
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.noise_colour import Colour, colour_of
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.further.power import options
from diagnosis.discovery.marks import footprints
from diagnosis.discovery.marks.quantisation import quantisation, with_stairs
from diagnosis.discovery.marks.row_masks import mask_spikes, raw_residual, scaled, without_rows
from diagnosis.discovery.marks.stairs import stair_step, with_slopes
from diagnosis.discovery.proof.cause import Named, merge, of_readings, of_single_readings, with_figures
from diagnosis.discovery.proof.cross_validation import rms_deg
from diagnosis.discovery.proof.predictive_check import Likeness, likeness
from diagnosis.discovery.proof.selection import prove
from diagnosis.discovery.search.iterate import searched, trusting
from diagnosis.discovery.search.likelihood_ratio import HANDICAP, SWAP_MARGIN, likelihood, settle
from diagnosis.discovery.search.stepwise import ALPHA
from twin.angles import TAU
from twin.catalogue import CATALOGUE, unnamed
from twin.chain import Chain
from twin.effect import BoolArray, Effect
from twin.sweep import Sweep

BURST_LOG_P = float(np.log(1e-6))
"""A stretch of noise must be this improbable: its test takes the noise to be Gaussian, which is true only nearly."""
GLITCH_ALPHA = 0.01
"""Probability of a false alarm by which single readings are called flipped bits: only those that stand far out are."""
SPREAD_LOG_P = -16.0
"""Log probability that a shape of the spread must fall below: as for a burst, noise is Gaussian only nearly."""
BEYOND_DOUBT = -25.0
"""Log probability below which the spread is taken to be uneven before anything else is known."""


@dataclass(frozen=True, eq=False)
class Discovery:
    """The answer to a sweep.

    ``baseline`` is the paper's error model alone, ``fit`` the extended one; ``masked`` the raw rows (n_raw,) that
    belong to single-reading causes; ``held`` the held-out residuals of the baseline and after each cause.
    """

    sweep: Sweep
    baseline: Fit
    fit: Fit
    causes: tuple[Named, ...]
    masked: BoolArray
    bits: int | None
    baseline_held_deg: float
    extended_held_deg: float
    noise_floor_deg: float
    looked_at: int
    given: Chain | None = None
    invisible: dict[str, tuple[str, ...]] = field(default_factory=dict)
    likeness: Likeness | None = None

    def __repr__(self) -> str:
        names = ", ".join(cause.name for cause in self.causes) or "no cause"
        held = f"held-out RMS {self.baseline_held_deg:.4g} -> {self.extended_held_deg:.4g} deg"
        return f"Discovery({self.sweep.name!r}, {self.verdict}: {names}; {held})"

    @property
    def verdict(self) -> str:
        """adequate, explained, partly explained or unnamed."""
        named = any(cause.name != "unnamed" for cause in self.causes)
        unnamed = any(cause.name == "unnamed" for cause in self.causes)
        if named:
            return "partly explained" if unnamed else "explained"
        return "unnamed" if unnamed else "adequate"


def discover(
    sweep: Sweep,
    *,
    start: Chain,
    given: Chain | None = None,
    effects: tuple[Effect, ...] = CATALOGUE,
    rng: np.random.Generator | None = None,
) -> Discovery:
    """Explain a sweep.

    ``start`` is the fitted baseline (or a given twin, passed as ``given`` too: then only its zeros are fitted).
    ``rng`` draws the simulated sweeps that the measured one is compared with (seed 0 if not given).
    """
    rng = rng or np.random.default_rng(0)
    evidence = collect(sweep)
    candidates = [e for e in effects if not e.baseline]
    means = [e for e in candidates if e.footprint == "mean"]
    measured = np.radians(sweep.measured_deg)
    bits = footprints.grid_bits(measured)
    step = TAU / 2.0**bits if bits is not None else 0.0
    fit = first_fit(evidence, start, given)
    evidence, fit = mask_spikes(fit, step)
    values_found: list[Named] = []
    fit = with_stairs(fit, sweep, candidates, bits, values_found)
    sequence_mask, sequence_found = _sequence(
        fit, sweep, candidates, step, "stale_frames", np.zeros(len(sweep), dtype=bool)
    )
    fit = without_rows(fit, sequence_mask)
    burst = footprints.bursts(fit)
    uneven = [s for s in footprints.spread_shapes(fit, candidates) if s.log_p < BEYOND_DOUBT]
    if burst is not None and burst.log_p < BURST_LOG_P:
        fit = scaled(fit, burst.variance)
    elif uneven:
        # Noise that is loudest at some angles passes for structure there, unless those rows weigh less.
        fit = scaled(fit, min(uneven, key=lambda s: s.log_p).variance)
    baseline = fit
    fit, keys, looked = trusting(fit, means, step, sequence_mask) or searched(fit, means, [], step, sequence_mask)
    if given is None and evidence.observables == 1:
        # Angles alone tell who counts which way by the quadratic term only, and a cause may have stood in for it.
        other = solve(evaluate(mirrored(fit.chain), fit.free, fit.evidence, fit.setting))
        if likelihood(other) > likelihood(fit) + SWAP_MARGIN:
            fresh = solve(evaluate(other.chain.without(*keys), baseline.free, fit.evidence, fit.setting))
            fit, keys, looked = searched(fresh, means, [], step, sequence_mask)
            baseline = fresh
    stairs = [named.keys[0] for named in values_found]
    baseline = solve(evaluate(baseline.chain.without(*stairs), baseline.free, fit.evidence, fit.setting))
    spread_found, fit = _spread(fit, candidates, looked)
    if spread_found:
        # Rows weighed by their noise tell more than they told before.
        fit, keys, looked = searched(fit, means, keys, step, sequence_mask)
    fit, entries, held = prove(fit, means, keys, rng=rng)
    if not sequence_found:
        # Repeats that structure hid at first.
        sequence_mask, sequence_found = _sequence(fit, sweep, candidates, step, "stale_frames", sequence_mask)
        fit = without_rows(fit, sequence_mask)
    glitch_mask, glitches = _sequence(fit, sweep, candidates, step, "bus_glitch", sequence_mask, alpha=GLITCH_ALPHA)
    masked = sequence_mask | glitch_mask
    quantisation(fit, bits, step, values_found)
    fit = with_slopes(fit)
    everything = merge([*entries, *values_found, *sequence_found, *glitches, *spread_found])
    use = fit.evidence.usable
    everything = [of_single_readings(with_figures(c, fit, held, use), evidence) for c in everything]
    baseline_held = of_readings(rms_deg(held[0], use), evidence)
    extended_held = of_readings(rms_deg(held[-1], use), evidence)
    everything = [replace(c, options=options(fit, c.rivals)) for c in everything]
    colour = colour_of(fit)
    fit = replace(fit, chain=_with_noise(fit, step, everything, colour))
    floor = np.degrees(evidence.repeat_rms) if evidence.repeat_rms else extended_held
    invisible = {
        e.name: e.missing(evidence.motion.provides)
        for e in candidates
        if not unnamed(e.name) and not e.visible_in(evidence.motion.provides)
    }
    return Discovery(
        sweep=sweep,
        baseline=baseline,
        fit=fit,
        causes=tuple(everything),
        masked=masked,
        bits=bits,
        baseline_held_deg=baseline_held,
        extended_held_deg=extended_held,
        noise_floor_deg=float(floor),
        looked_at=looked,
        given=given,
        invisible=invisible,
        likeness=likeness(fit, rng=rng, colour=colour),
    )


# ---- steps of the discovery -------------------------------------------------------------------------------------


def _sequence(
    fit: Fit,
    sweep: Sweep,
    effects: Sequence[Effect],
    step: float,
    name: str,
    spoken_for: BoolArray,
    *,
    alpha: float = ALPHA,
) -> tuple[BoolArray, list[Named]]:
    """Raw rows that a single-reading effect has touched, and the effect where chance does not explain them.

    Rows ``spoken_for`` (n_raw,) belong to another effect already.
    """
    effect = next((e for e in effects if e.name == name), None)
    residual = np.where(spoken_for, 0.0, raw_residual(fit, sweep))
    nothing = np.zeros(len(sweep), dtype=bool)
    if effect is None or effect.marks is None:
        return nothing, []
    # What a CORDIC's uneven stairs leave stands out of the noise too.
    stairs = stair_step(fit.chain, step) / np.sqrt(12.0)
    sigma = max(footprints.robust_rms(footprints.local_residual(residual)), stairs)
    mask, log_p = effect.marks(np.radians(sweep.measured_deg), residual, sigma, step, sweep.motion())
    if log_p > np.log(alpha) or not mask.any():
        return nothing, []
    rows = tuple(int(row) for row in np.flatnonzero(mask))
    # Looked for by itself, on readings that no other effect touches: there is no family to pay for.
    return mask, [Named((name,), log_p, -2.0 * log_p, rows=rows, family_log_p=log_p)]


def _spread(fit: Fit, effects: Sequence[Effect], looked: int) -> tuple[list[Named], Fit]:
    """Causes that show in the spread of the readings; the rows are weighed by it where there is one."""
    fit, _ = settle(fit)
    shapes = footprints.spread_shapes(fit, [e for e in effects if e.footprint == "spread"])
    burst = footprints.bursts(fit)
    if burst is not None and burst.log_p < BURST_LOG_P:
        shapes.append(burst)
    shapes = [s for s in shapes if s.log_p < min(np.log(ALPHA / max(looked, 1)), SPREAD_LOG_P)]
    if not shapes:
        # What looked like uneven noise before the search was structure: a scale that no cause carries goes.
        return [], fit if np.all(fit.evidence.scale == 1.0) else scaled(fit, np.ones(len(fit.evidence)))
    best = min(shapes, key=lambda s: s.log_p + (HANDICAP if unnamed(s.name) else 0.0))
    chain = fit.chain.with_values({best.name: best.values})
    fit = evaluate(chain, fit.free, fit.evidence, fit.setting)
    named = Named((best.name,), best.log_p, best.gain, intervals=best.intervals)
    return [named], scaled(fit, best.variance)


def _with_noise(fit: Fit, step: float, causes: Sequence[Named], colour: Colour) -> Chain:
    """The extended chain with the noise that is left and the rare events found, so that it simulates alike."""
    use = fit.evidence.usable
    total = left = float(np.mean(fit.residual[0][use] ** 2))
    if "output_quantisation" in fit.chain.values:
        left = fit.setting.blur**2 if fit.setting.blur > 0.0 else left - step**2 / 12.0
    for _, effect, own in fit.chain.active("channels"):
        if effect.spread is not None:
            left -= float(np.mean(effect.spread(fit.linear.sensor_angle, own)))
    # What rounding adds is white: the noise ahead of it is the more correlated.
    share = min(colour.correlated_share * total / max(left, 1e-300), 1.0)
    rms_deg_left = float(np.degrees(np.sqrt(max(left, 0.0))))
    values: dict[str, dict[str, Any]] = {
        "noise": {"rms_deg": rms_deg_left, "correlation": colour.correlation, "correlated_share": share}
    }
    if "reference_rezero" in fit.chain.values:
        own = fit.chain.values["reference_rezero"]
        values["reference_rezero"] = {**own, "spread_deg": float(np.std(own["zeros_deg"], ddof=1))}
    for cause in causes:
        if cause.name == "bus_glitch":
            values["bus_glitch"] = {"count": float(len(cause.rows))}
        elif cause.name == "stale_frames":
            values["stale_frames"] = {"fraction_percent": 100.0 * len(cause.rows) / max(fit.evidence.group.size, 1)}
    return fit.chain.with_values(values)
