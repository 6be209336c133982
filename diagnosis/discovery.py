"""Discovery: what the simulation gets wrong about a sweep, by name, with proof; or that nothing is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from diagnosis import footprints
from diagnosis.evidence import Evidence, collect
from diagnosis.joint_fit import BASELINE, Fit, Free, Setting, evaluate, free_of, solve, tidy
from diagnosis.likeness import Likeness, likeness
from diagnosis.linear import Linear
from diagnosis.noise_choice import radius_noise
from diagnosis.noise_colour import Colour, colour_of
from diagnosis.noise_model import noise_family
from diagnosis.proof import held_out_residuals, rms_deg
from diagnosis.screening import log_probability
from diagnosis.search import ALPHA, SWAP_MARGIN, judge, search
from diagnosis.separation import Option, options
from diagnosis.trial import drop, likelihood, settle
from twin.angles import TAU, Array, wrap
from twin.catalogue import CATALOGUE, base_name, find
from twin.chain import Chain
from twin.effect import BoolArray, Effect
from twin.motion import Motion
from twin.sweep import Sweep

ROUNDS = 3
BURST_LOG_P = float(np.log(1e-6))
"""A stretch of noise must be this improbable: its test takes the noise to be Gaussian, which is true only nearly."""
SPREAD_LOG_P = -16.0
"""Log probability that a shape of the spread must fall below: as for a burst, noise is Gaussian only nearly."""
BEYOND_DOUBT = -25.0
"""Log probability below which the spread is taken to be uneven before anything else is known."""
STAIRS_GAIN = 25.0
"""Twice the log likelihood, five sigma, that the output's stairs must gain to be named."""
SLACK = 1.004
RADIUS_LEFT = 1.5
"""Variance of the radius against that of its noise above which something in it is unexplained."""
_NUDGE = 1e-9
"""A baseline parameter exactly at null is skipped by the chain and could not be fitted: it starts this far off."""


@dataclass(frozen=True, eq=False)
class Named:
    """One entry of the answer: a cause, its probability, rivals, and the held-out RMS around it [deg].

    ``rivals`` are the fits with another effect in its place, ``options`` the measurements that would part them.
    ``rows`` are the raw rows (from 0) that a cause of single readings has touched; ``intervals`` are of parameters
    that no fit of the mean has.
    """

    keys: tuple[str, ...]
    log_p: float
    gain: float
    rivals: Mapping[str, Fit] = field(default_factory=dict)
    options: tuple[Option, ...] = ()
    before_deg: float = float("nan")
    after_deg: float = float("nan")
    rows: tuple[int, ...] = ()
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """The catalogue's name, or ``unnamed``."""
        name = base_name(self.keys[0])
        return "unnamed" if name.startswith("unnamed") else name


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
    ``rng`` draws the sweeps that the measured one is compared with (seed 0 if not given).
    """
    evidence = collect(sweep)
    candidates = [e for e in effects if not e.baseline]
    means = [e for e in candidates if e.footprint == "mean"]
    measured = np.radians(sweep.measured_deg)
    bits = footprints.grid_bits(measured)
    step = TAU / 2.0**bits if bits is not None else 0.0
    fit = _first_fit(evidence, start, given)
    evidence, fit = _mask_spikes(fit, step)
    values_found: list[Named] = []
    fit = _with_stairs(fit, sweep, candidates, bits, values_found)
    sequence_mask, sequence_found = _sequence(
        fit, sweep, candidates, step, "stale_frames", np.zeros(len(sweep), dtype=bool)
    )
    fit = _masked(fit, sequence_mask)
    burst = footprints.bursts(fit)
    uneven = [s for s in footprints.spread_shapes(fit, candidates) if s.log_p < BEYOND_DOUBT]
    if burst is not None and burst.log_p < BURST_LOG_P:
        fit = _scaled(fit, burst.variance)
    elif uneven:
        # Noise that is loudest at some angles passes for structure there, unless those rows weigh less.
        fit = _scaled(fit, min(uneven, key=lambda s: s.log_p).variance)
    baseline = fit
    fit, keys, looked = _trusting(fit, means, step, sequence_mask) or _searched(fit, means, [], step, sequence_mask)
    if given is None and evidence.observables == 1:
        # Angles alone tell who counts which way by the quadratic term only, and a cause may have stood in for it.
        other = solve(evaluate(mirrored(fit.chain), fit.free, fit.evidence, fit.setting))
        if likelihood(other) > likelihood(fit) + SWAP_MARGIN:
            fresh = solve(evaluate(other.chain.without(*keys), baseline.free, fit.evidence, fit.setting))
            fit, keys, looked = _searched(fresh, means, [], step, sequence_mask)
            baseline = fresh
    stairs = [named.keys[0] for named in values_found]
    baseline = solve(evaluate(baseline.chain.without(*stairs), baseline.free, fit.evidence, fit.setting))
    spread_found, fit = _spread(fit, candidates, looked)
    if spread_found:
        # Rows weighed by their noise tell more than they told before.
        fit, keys, looked = _searched(fit, means, keys, step, sequence_mask)
    fit, entries, held = _prove(fit, means, keys)
    if not sequence_found:
        # Repeats that structure hid at first.
        sequence_mask, sequence_found = _sequence(fit, sweep, candidates, step, "stale_frames", sequence_mask)
        fit = _masked(fit, sequence_mask)
    glitch_mask, glitches = _sequence(fit, sweep, candidates, step, "bus_glitch", sequence_mask)
    masked = sequence_mask | glitch_mask
    _quantisation(fit, bits, step, values_found)
    everything = _merge([*entries, *values_found, *sequence_found, *glitches, *spread_found])
    use = fit.evidence.usable
    everything = [_of_readings(_with_figures(c, fit, held, use), evidence) for c in everything]
    baseline_held = of_readings(rms_deg(held[0], use), evidence)
    extended_held = of_readings(rms_deg(held[-1], use), evidence)
    everything = [replace(c, options=options(fit, c.rivals)) for c in everything]
    colour = colour_of(fit)
    fit = replace(fit, chain=_with_noise(fit, step, everything, colour))
    floor = np.degrees(evidence.repeat_rms) if evidence.repeat_rms else extended_held
    invisible = {
        e.name: e.missing(evidence.motion.provides)
        for e in candidates
        if not e.name.startswith("unnamed") and not e.visible_in(evidence.motion.provides)
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
        likeness=likeness(fit, rng=rng or np.random.default_rng(0), colour=colour),
    )


def senses_of_channels(sweep: Sweep) -> tuple[int, int] | None:
    """Who counts which way, (s, h), where the recorded channels say it: the reading follows h atan2(vy, vx)."""
    if sweep.vx is None or sweep.vy is None:
        return None
    measured, reference = np.radians(sweep.measured_deg), np.radians(sweep.reference_deg)
    channel = np.arctan2(sweep.vy, sweep.vx)

    def together(a: Array, b: Array) -> int:
        return 1 if abs(np.mean(np.exp(1j * (a - b)))) >= abs(np.mean(np.exp(1j * (a + b)))) else -1

    output = together(measured, channel)
    return together(measured, reference) * output, output


def mirrored(chain: Chain) -> Chain:
    """The chain that counts the other way on both sides: the same readings but for the quadratic term."""
    values: dict[str, dict[str, Any]] = {key: dict(params) for key, params in chain.values.items()}
    for params in values.values():
        for name in params:
            if name.startswith("y_") or name in ("beta_deg", "deg_per_K", "zero_deg"):
                params[name] = -params[name]
    return Chain(values, -chain.sensor_sense, -chain.output_sense, chain.effects)


# ---- steps of the discovery -------------------------------------------------------------------------------------


def _searched(
    fit: Fit, effects: Sequence[Effect], keys: Sequence[str], step: float, also: BoolArray
) -> tuple[Fit, list[str], int]:
    """Search, look again for spikes and at the blur of the stairs in what is left, and search on until all is still."""
    keys = list(keys)
    looked = 0
    for _ in range(ROUNDS):
        found = search(fit, effects, keys=keys)
        fit, looked = found.fit, found.looked_at
        changed = list(found.keys) != keys
        keys = list(found.keys)
        _, refined = _mask_spikes(fit, step, also)
        refined = _reblurred(refined, step)
        if not changed and np.array_equal(refined.evidence.usable, fit.evidence.usable):
            break
        fit = solve(refined)
    return fit, keys, looked


def _trusting(fit: Fit, effects: Sequence[Effect], step: float, also: BoolArray) -> tuple[Fit, list[str], int] | None:
    """The search that takes all the radius does over the turn for the work of causes; None where they leave some of it.

    A shaft's error shows in the angle alone, and it is the radius that tells it from offset, gain and phase; but a
    field that changes over the turn for reasons of its own would pass for such an error.
    """
    if fit.evidence.observables == 1 or _radius_explained(settle(fit)[0]):
        return None
    trusting = evaluate(fit.chain, fit.free, fit.evidence, replace(fit.setting, radius_trusted=True))
    found = _searched(solve(trusting), effects, [], step, also)
    return found if _radius_explained(found[0]) else None


def _radius_explained(fit: Fit) -> bool:
    """Whether what is left of the radius is no more than its noise, as it is beside all that the angle could explain."""
    noise = radius_noise(fit)
    if noise is None:
        return True
    left = fit.cosine_residual[1] ** 2 @ fit.setting.family.weights[noise[0]]
    return float(left / fit.rows) < RADIUS_LEFT * noise[1]


def _first_fit(evidence: Evidence, start: Chain, given: Chain | None) -> Fit:
    """The fit that the search sets out from: the baseline, or a given twin with its zeros set free."""
    setting = Setting(noise_family(len(evidence)), radius_weight=1.0 if evidence.observables == 2 else 0.0)
    turns = int(evidence.motion.turn.max(initial=0)) + 1
    if given is None:
        return solve(evaluate(awake(start), BASELINE, evidence, setting))
    free: list[Free] = [BASELINE[0]]
    chain = start
    rezeroed = "reference_rezero" in chain.values and turns > 1
    chain = chain.without("reference_rezero")
    if rezeroed:
        free += free_of(find("reference_rezero"), "reference_rezero", turns=turns, channels=False)
    chain = chain.with_values({"zero": {"zero_deg": 0.0, **chain.values.get("zero", {})}})
    chain = aligned(chain, evidence.motion, evidence.measured)
    if rezeroed:
        # Each turn's zero from its own readings: zeros that all begin alike would be held there by their own scatter.
        motion = chain.shaft(evidence.motion)
        off = wrap(evidence.measured - chain.readings(motion))
        sense = chain.sensor_sense * chain.output_sense
        zeros = [-sense * np.degrees(np.median(off[motion.turn == turn])) for turn in range(turns)]
        chain = chain.with_values({"reference_rezero": {"zeros_deg": np.array(zeros), "spread_deg": 0.0}})
    fit = solve(evaluate(chain, tuple(free), evidence, setting))
    return solve(evaluate(fit.chain, fit.free, evidence, setting))


def awake(chain: Chain) -> Chain:
    """The chain with the whole baseline present, so that every one of its parameters can be fitted."""
    values: dict[str, dict[str, Any]] = {}
    for free in BASELINE:
        effect = find(free.key)
        null = effect.params[free.name].null
        present = chain.values.get(free.key, {}).get(free.name, null)
        values.setdefault(free.key, {})[free.name] = present + (_NUDGE if present == null else 0.0)
    return chain.with_values(values)


def aligned(chain: Chain, recorded: Motion, measured: Array) -> Chain:
    """The chain with its zero turned so that its readings agree with the measured ones (n,) on average."""
    zero = float(chain.values["zero"]["zero_deg"])
    for _ in range(2):
        off = np.angle(np.mean(np.exp(1j * (measured - chain.readings(chain.shaft(recorded))))))
        zero += float(np.degrees(off)) * chain.output_sense
        chain = chain.with_values({"zero": {"zero_deg": zero}})
    return tidy(chain)


def _mask_spikes(fit: Fit, step: float, also: BoolArray | None = None) -> tuple[Evidence, Fit]:
    """The fit without the rows that stand out alone; fitted anew where there are any, until the set is stable."""
    for _ in range(4):
        mask, _sigma = footprints.spikes(fit.residual[0], fit.evidence.motion, max(step, stair_step(fit.chain, step)))
        usable = ~mask & fit.evidence.sure
        if fit.evidence.observables == 2:
            # Channels that fall out for a reading say nothing true about the radius.
            radius = fit.residual[1] - np.median(fit.residual[1])
            usable &= np.abs(radius) < 10.0 * max(footprints.robust_rms(radius), 1e-6)
        if also is not None:
            usable &= ~_rows_of(fit.evidence, also)
        if np.array_equal(usable, fit.evidence.usable):
            break
        fit = solve(evaluate(fit.chain, fit.free, fit.evidence.masked(usable), fit.setting))
    return fit.evidence, fit


def _rows_of(evidence: Evidence, raw: BoolArray) -> BoolArray:
    """Rows of the evidence whose raw rows are mostly marked."""
    count = np.bincount(evidence.group)
    return np.asarray(np.bincount(evidence.group, raw) > 0.5 * count)


def _masked(fit: Fit, raw: BoolArray) -> Fit:
    rows = _rows_of(fit.evidence, raw)
    if not np.any(rows & fit.evidence.usable):
        return fit
    return solve(evaluate(fit.chain, fit.free, fit.evidence.masked(fit.evidence.usable & ~rows), fit.setting))


def _scaled(fit: Fit, variance: Array) -> Fit:
    evidence = replace(fit.evidence, scale=footprints.row_scale(fit.evidence, variance))
    return solve(evaluate(fit.chain, fit.free, evidence, fit.setting))


def _with_stairs(fit: Fit, sweep: Sweep, effects: Sequence[Effect], bits: int | None, found: list[Named]) -> Fit:
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
    return solve(_reblurred(fit, step))


def stair_step(chain: Chain, step: float) -> float:
    """Step [rad] of the coarsest stairs in the chain: the output grid, or the CORDIC's mean spacing."""
    iterations = float(chain.values.get("cordic_truncation", {}).get("iterations", 0.0))
    grid = step if "output_quantisation" in chain.values else 0.0
    return max(grid, 2.0 * float(np.arctan(2.0 ** (1.0 - iterations))) if iterations else 0.0)


def _reblurred(fit: Fit, step: float) -> Fit:
    """The fit with the blur of its stairs set from what is left."""
    coarse = stair_step(fit.chain, step)
    if coarse <= 0.0:
        return fit
    rms = float(np.sqrt(np.mean(fit.residual[0][fit.evidence.usable] ** 2)))
    blur = footprints.blur_behind(rms, coarse)
    if fit.setting.blur > 0.0 and abs(blur / fit.setting.blur - 1.0) < 0.1:
        return fit
    return evaluate(fit.chain, fit.free, fit.evidence, replace(fit.setting, blur=blur))


def raw_residual(fit: Fit, sweep: Sweep) -> Array:
    """Residual [rad] of every raw reading (n_raw,) against the fit."""
    if len(sweep) == len(fit.evidence):
        return np.asarray(fit.residual[0])
    predicted: Array = fit.linear.angle[fit.evidence.group] + fit.evidence.ahead
    return wrap(np.radians(sweep.measured_deg) - predicted)


def _sequence(
    fit: Fit, sweep: Sweep, effects: Sequence[Effect], step: float, name: str, spoken_for: BoolArray
) -> tuple[BoolArray, list[Named]]:
    """Raw rows that a single-reading effect has touched, and the effect where chance does not explain them.

    Rows ``spoken_for`` (n_raw,) belong to another effect already.
    """
    effect = next((e for e in effects if e.name == name), None)
    residual = np.where(spoken_for, 0.0, raw_residual(fit, sweep))
    nothing = np.zeros(len(sweep), dtype=bool)
    if effect is None or effect.marks is None:
        return nothing, []
    sigma = footprints.robust_rms(footprints.local_residual(residual))
    mask, log_p = effect.marks(np.radians(sweep.measured_deg), residual, sigma, step, sweep.motion())
    if log_p > np.log(ALPHA) or not mask.any():
        return nothing, []
    return mask, [Named((name,), log_p, -2.0 * log_p, rows=tuple(int(row) for row in np.flatnonzero(mask)))]


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
        return [], fit if np.all(fit.evidence.scale == 1.0) else _scaled(fit, np.ones(len(fit.evidence)))
    best = min(shapes, key=lambda s: s.log_p + (6.0 if s.name.startswith("unnamed") else 0.0))
    chain = fit.chain.with_values({best.name: best.values})
    fit = evaluate(chain, fit.free, fit.evidence, fit.setting)
    named = Named((best.name,), best.log_p, best.gain, intervals=best.intervals)
    return [named], _scaled(fit, best.variance)


def _prove(fit: Fit, effects: Sequence[Effect], keys: Sequence[str]) -> tuple[Fit, list[Named], list[Array]]:
    """Entries with their held-out figures; what gains nothing on readings it never saw is no cause."""
    keys = list(keys)
    while True:
        causes = sorted((judge(fit, key, effects, keys) for key in keys), key=lambda cause: -cause.gain)
        use = fit.evidence.usable
        ordered = [cause.key for cause in causes]
        held = held_out_residuals(fit, ordered)
        weighed = [rms_deg(residual / fit.evidence.scale, use) for residual in held]
        idle = None
        listed = float(np.log(0.01 / max(len(effects), 1)))
        for place, key in enumerate(ordered):
            if causes[place].log_p > listed:
                # What was added after it has taken over what it was added for.
                idle = key
                break
            if weighed[place + 1] < weighed[place]:
                continue
            # Not the last step: its turn may come only with what was added after it.
            alone = held_out_residuals(fit, [*(k for k in ordered if k != key), key])
            # The RMS counts correlated noise in full: a strong cause that leaves it as it is shows elsewhere.
            slack = SLACK if causes[place].log_p < np.log(1e-10) else 1.0
            before, after = (rms_deg(residual / fit.evidence.scale, use) for residual in alone[-2:])
            if after >= slack * before:
                idle = key
                break
        if idle is None:
            break
        fit, _ = settle(drop(fit, idle))
        keys.remove(idle)
    figures = [rms_deg(residual, use) for residual in held]
    entries = [
        Named(
            (cause.key,),
            cause.log_p,
            cause.gain,
            cause.rivals,
            before_deg=figures[place],
            after_deg=figures[place + 1],
        )
        for place, cause in enumerate(causes)
    ]
    return fit, entries, held


def _quantisation(fit: Fit, bits: int | None, step: float, found: list[Named]) -> None:
    """The output's grid is a cause where its noise exceeds half of what is left otherwise, and its stairs are seen.

    Noise ahead of the grid blurs the stairs; where it blurs them away, nothing is gained by knowing them.
    """
    if bits is None or "output_quantisation" not in fit.chain.values or fit.setting.blur <= 0.0 or found:
        return
    use = fit.evidence.usable
    plain = _without_stairs(fit, "output_quantisation")[use]
    gain = int(use.sum()) * float(np.log(np.mean(plain**2) / np.mean(fit.residual[0][use] ** 2)))
    if step / np.sqrt(12.0) > 0.5 * fit.setting.blur and gain > STAIRS_GAIN:
        log_p = float(log_probability(np.array(gain), 1, int(use.sum())))
        found.append(Named(("output_quantisation",), log_p, gain))


def _without_stairs(fit: Fit, key: str) -> Array:
    """Angle residual (n,) [rad] against the smooth angle ahead of one effect's stairs."""
    smooth = Linear(fit.chain.without(key), fit.evidence.motion, blur=fit.setting.blur, observables=1)
    return wrap(fit.evidence.measured - smooth.angle)


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


def _merge(entries: list[Named]) -> list[Named]:
    """Instances of one effect, and all structure without a name, as one entry each; strongest first."""
    merged: dict[str, Named] = {}
    for entry in entries:
        if entry.name in merged:
            first = merged[entry.name]
            merged[entry.name] = replace(
                first,
                keys=(*first.keys, *entry.keys),
                log_p=min(first.log_p, entry.log_p),
                gain=first.gain + entry.gain,
                rivals={name: fit for name, fit in first.rivals.items() if name in entry.rivals},
                after_deg=entry.after_deg,
            )
        else:
            merged[entry.name] = entry
    return sorted(merged.values(), key=lambda e: -e.gain)


def of_readings(row_rms_deg: float, evidence: Evidence) -> float:
    """RMS [deg] over single readings, from that over rows which average several of them."""
    return float(np.hypot(row_rms_deg, np.degrees(np.sqrt(evidence.within))))


def _of_readings(entry: Named, evidence: Evidence) -> Named:
    return replace(
        entry,
        before_deg=of_readings(entry.before_deg, evidence),
        after_deg=of_readings(entry.after_deg, evidence),
    )


def _with_figures(entry: Named, fit: Fit, held: list[Array], use: BoolArray) -> Named:
    """RMS before and after for causes that no fit of the mean carries."""
    if np.isfinite(entry.before_deg):
        return entry
    after = rms_deg(held[-1], use)
    if entry.rows:
        return replace(entry, before_deg=rms_deg(held[-1], np.ones_like(use)), after_deg=after)
    effect = find(entry.keys[0], fit.chain.effects)
    if effect.footprint == "values":
        before = rms_deg(_without_stairs(fit, entry.keys[0]), use)
        return replace(entry, before_deg=before, after_deg=rms_deg(fit.residual[0], use))
    return replace(entry, before_deg=after, after_deg=after)
