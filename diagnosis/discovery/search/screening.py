"""Screening: how much better each candidate would make the fit, to first order, under every noise of the family.

Columns are projected off the Jacobian of all that is fitted already, so a candidate gains only by what nothing else
can do. The gain is a likelihood ratio in which both sides choose their own noise: coloured noise that explains the
residual as well as a candidate does leaves the candidate no gain.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.coefficients import observables_to_cosine, to_rows
from diagnosis.discovery.fitting.f_test import log_probability
from diagnosis.discovery.fitting.joint_fit import Fit, root_weights
from diagnosis.discovery.fitting.linearised_chain import Term
from diagnosis.discovery.fitting.nuisance import without_nuisance
from diagnosis.discovery.search.periodogram import line_shapes
from twin.angles import TAU, Array, IntArray
from twin.effect import BoolArray, Effect, Line

_CHUNK = 4_000_000
_ZOOMS = 3
_ZOOM_POINTS = 9
"""Three grids of nine between neighbours find a maximum to 1/64 of the first grid's step; a fit goes on from it."""
COARSE = (0, 2, 4, 6, 8, 13, 15)
"""Family members that a first-order gain is taken over, beside the best one; exact fits ask them all."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect at its best shape, with the parameters that a first-order fit gives it.

    ``gain`` is twice the gain in log likelihood, ``terms`` the number of coefficients, ``looks`` how many independent
    shapes were tried, ``log_p`` the log of the probability that noise gains as much at any of them.
    """

    effect: Effect
    values: Mapping[str, Any]
    gain: float
    terms: int
    looks: float
    log_p: float


@dataclass(frozen=True, eq=False)
class Base:
    """What is fitted already, whitened by each family member, for one residual or for a batch of simulated ones.

    Residuals (batch, N), orthonormal rows (P, N), log determinants (members,), likelihood (batch, members).
    """

    fit: Fit
    roots: Array
    residuals: list[Array]
    rows: list[Array]
    log_det: Array
    likelihood: Array
    dof: int

    @classmethod
    def of(cls, fit: Fit) -> Base:
        """Prepare a fit for screening."""
        roots: list[Array] = []
        rows: list[Array] = []
        log_det: list[float] = []
        for member in range(len(fit.weighting.family.members)):
            if member not in fit.weighting.plausible:
                roots.append(np.zeros_like(fit.cosine_residual))
                rows.append(np.zeros((0, 0)))
                log_det.append(np.inf)
                continue
            roots.append(root_weights(fit.weighting, fit.observations.observables, member))
            _, j = fit.whitened(member)
            scale = np.linalg.norm(j, axis=1, keepdims=True)
            q, triangle = np.linalg.qr((j / np.where(scale > 0.0, scale, 1.0)).T)
            kept = np.abs(np.diag(triangle)) > 1e-7
            rows.append(q[:, kept].T)
            # Restricted likelihood: the baseline's coefficients are integrated out, not maximised.
            log_det.append(
                2.0 * float(np.sum(np.log(np.abs(np.diag(triangle)[kept]))))
                + 2.0 * float(np.sum(np.log(scale[scale > 0])))
            )
        dof = fit.rows * fit.observations.observables - len(fit.free) + fit.prior_residual.size
        empty = cls(fit, np.stack(roots), [], rows, np.array(log_det), np.zeros((0, 0)), dof)
        return empty.with_residuals(fit.cosine_residual[None])

    def with_residuals(self, cosine_residuals: Array) -> Base:
        """The same fit with residuals (batch, O, n) in the place of its own, as cosine coefficients."""
        prior = self.fit.prior_residual
        costs = self.fit.weighting.family.cost(self.fit.rows)
        residuals: list[Array] = []
        likelihood = np.full((len(cosine_residuals), len(self.rows)), -np.inf)
        for member, q in enumerate(self.rows):
            if member not in self.fit.weighting.plausible:
                residuals.append(np.zeros((0, 0)))
                continue
            white = (cosine_residuals * self.roots[member]).reshape(len(cosine_residuals), -1)
            r = np.concatenate([white, np.broadcast_to(prior, (len(white), prior.size))], axis=1)
            r = r - (r @ q.T) @ q
            residuals.append(r)
            squares = np.maximum(np.einsum("sn,sn->s", r, r), 1e-300)
            cost = costs[member] + self.log_det[member]
            likelihood[:, member] = -0.5 * (self.dof * np.log(squares) + cost)
        return replace(self, residuals=residuals, likelihood=likelihood)

    def part(self, chosen: IntArray) -> Base:
        """The same with these residuals of the batch alone."""
        residuals = [residual[chosen] if residual.size else residual for residual in self.residuals]
        return replace(self, residuals=residuals, likelihood=self.likelihood[chosen])

    @property
    def member(self) -> int:
        """The family member that fits best (the first residual of a batch)."""
        return int(np.argmax(self.likelihood[0]))


def screen(base: Base, effects: Iterable[Effect]) -> list[Candidate]:
    """The best shape of each effect that gains at all, strongest first."""
    found = []
    for effect in effects:
        candidate = screen_one(base, effect)
        if candidate is not None:
            found.append(candidate)
    return sorted(found, key=lambda c: c.log_p)


def screen_one(base: Base, effect: Effect, *, shapes: Sequence[Mapping[str, float]] | None = None) -> Candidate | None:
    """The effect at the shape that gains most, zoomed in on where its shape is continuous. None: no gain."""
    fit = base.fit
    motion = fit.linear.motion
    looks = 0.0
    if shapes is None:
        if effect.line is not None:
            shapes, looks = line_shapes(matched(base), fit, effect)
        else:
            shapes = list(effect.shapes(motion))
    if not shapes:
        return None
    looks = max(looks, float(len(shapes)))
    gains, coefficients = gains_of(base, effect, shapes)
    # Where the speed changes the sides are told by how they follow it; at one speed each is a line like any other.
    lines_alone = fit.observations.observables == 1 and "two speeds" not in fit.observations.motion.provides
    if effect.line is not None and effect.line.sidebands and lines_alone:
        gains = np.where(one_sided(base, effect, effect.line, shapes), 0.0, gains)
    if effect.comb is not None and effect.comb.parts:
        gains = np.where(borne_out(base, effect, shapes, gains, looks=looks), gains, 0.0)
    if not np.any(gains > 0.0):
        return None
    (point,) = sharpened(base, effect, shapes, gains, coefficients)
    return candidate_at(base, effect, point.shape, point.gain, point.coefficient, looks=looks)


def borne_out(
    base: Base, effect: Effect, shapes: Sequence[Mapping[str, float]], gains: Array, *, looks: float
) -> BoolArray:
    """At which shapes (batch, G) of these gains each part of the effect shows by itself beside the others."""
    level = base.fit.settings.footprint_log_p
    terms = len(base.fit.linear.terms(effect))
    found = np.asarray(by_chance(base, effect, gains, terms, looks) < level)
    for part in effect.comb.parts if effect.comb is not None and found.any() else ():
        rest, _ = gains_of(base, effect.without_strengths(part), shapes)
        found &= by_chance(base, effect, gains - rest, len(part), 1.0) < level
    return found


def one_sided(base: Base, effect: Effect, line: Line, shapes: Sequence[Mapping[str, float]]) -> BoolArray:
    """At which shapes (batch, G) of a line with two sidebands one of them alone explains the readings as well.

    That wave has no name: the other sideband has to stand out of the noise beside it, of the same size. The sidebands'
    phases are free.
    """
    fit, motion = base.fit, base.fit.linear.motion
    frequency = np.array([shape[line.param] for shape in shapes])[:, None]
    gains = []
    for order in (line.sidebands, -line.sidebands):
        phase = TAU * frequency * motion.time_s + order * motion.shaft_rad
        gain, _ = _gains_of_columns(base, None, np.stack([np.cos(phase), np.sin(phase)], axis=1)[:, :, None])
        gains.append(np.sqrt(np.maximum(gain, 0.0)))
    # A wave gains the square of its size: one size for both is their mean.
    gain = np.stack(gains)
    together = 0.5 * np.sum(gain, axis=0) ** 2
    beside = np.maximum(together - np.max(gain, axis=0) ** 2, 0.0)
    return np.asarray(by_chance(base, effect, beside, 2, 1.0) > fit.settings.footprint_log_p)


def candidate_at(
    base: Base, effect: Effect, shape: Mapping[str, float], gain: float, coefficient: Array, *, looks: float = 1.0
) -> Candidate:
    """The effect at a shape with the coefficients (T,) of its first-order fit, the best of so many looks."""
    linear = base.fit.linear
    found = _parameters(effect, linear.terms(effect), coefficient, linear.motion)
    log_p = float(by_chance(base, effect, np.array(gain), coefficient.size, looks))
    return Candidate(effect, {**effect.null(), **shape, **found}, float(gain), coefficient.size, looks, log_p)


def by_chance(base: Base, effect: Effect, gain: Array, terms: int, looks: float) -> Array:
    """Log of the probability that noise gains as much by an effect at the best of so many looks."""
    if drawn := effect.drawn_of(terms):
        # Draws from a distribution of their own: integrating them out costs each about half the log of its evidence
        # (Laplace), and what is left to test is one scatter, or what stands beside them.
        gain = gain - drawn * (1.0 + np.log(np.maximum(gain / drawn, 1.0)))
    return np.asarray(log_probability(gain, terms - drawn or 1, base.dof) + np.log(looks))


def matched(base: Base) -> list[Array]:
    """The angle's residual (n,) weighted by the inverse noise spectrum: of white noise, and of the best member."""
    return matched_to(base, base.fit.cosine_residual[0], base.member)


def matched_to(base: Base, cosine_residual: Array, best: int) -> list[Array]:
    """An angle's residual, cosine coefficients (n,), weighted likewise and back over the rows."""
    fit, observations = base.fit, base.fit.observations
    rows = []
    for member in dict.fromkeys((0, best)):
        weighted = to_rows(observations, cosine_residual * fit.weighting.family.weights[member])
        weighted = weighted * (observations.usable / observations.scale)
        # Lines are matched as they are: what whitens them beside the noise is turned on the residual.
        rows.append(weighted if observations.loose is None else observations.loose.matched(weighted))
    return rows


def _smooth(effect: Effect, shape: Mapping[str, float]) -> list[str]:
    return [
        name for name in shape if not effect.params[name].counts and (name in effect.zoomed or _is_line(effect, name))
    ]


def _is_line(effect: Effect, name: str) -> bool:
    return effect.line is not None and effect.line.param == name


def gains_of(base: Base, effect: Effect, shapes: Sequence[Mapping[str, float]]) -> tuple[Array, Array]:
    """Gain (batch, G) of each shape, and the coefficients (batch, G, T) of its fit."""
    fit = base.fit
    n = len(fit.observations)
    terms = len(fit.linear.terms(effect))
    per = max(1, _CHUNK // max(n * terms * fit.observations.observables, 1))
    gains, coefficients = [], []
    for start in range(0, len(shapes), per):
        columns = fit.linear.columns(effect, shapes[start : start + per])
        g, c = _gains_of_columns(base, effect, columns)
        gains.append(g)
        coefficients.append(c)
    return np.concatenate(gains, axis=1), np.concatenate(coefficients, axis=1)


def _gains_of_columns(base: Base, effect: Effect | None, columns: Array) -> tuple[Array, Array]:
    """Gains (batch, G) of columns (G, T, O, n), and their coefficients: those that the effect allows, None: any."""
    fit = base.fit
    count, terms = columns.shape[:2]
    batch = len(base.likelihood)
    cosine = observables_to_cosine(fit.observations, without_nuisance(fit.observations, columns))
    best_gain = np.full((batch, count), -np.inf)
    best_coefficient = np.zeros((batch, count, terms))
    top = base.likelihood.max(axis=1)
    for member in sorted(
        {base.member, *COARSE} if len(fit.weighting.plausible) > len(COARSE) else fit.weighting.plausible
    ):
        if member not in fit.weighting.plausible:
            continue
        white = (cosine * base.roots[member]).reshape(count * terms, -1)
        q = base.rows[member]
        r = base.residuals[member]
        along = white @ q[:, : white.shape[1]].T
        size = np.einsum("ij,ij->i", white, white).reshape(count, terms)
        dot = (r[:, : white.shape[1]] @ white.T).reshape(batch, count, terms)
        # The part of q that lies in the priors' rows is orthogonal to the candidate.
        if terms == 1:
            norm = size[:, 0] - np.einsum("ij,ij->i", along, along)
            good = norm > 1e-6 * np.maximum(size[:, 0], 1e-300)
            coefficient = np.where(good[:, None], dot / np.where(good, norm, 1.0)[:, None], 0.0)
        else:
            white3 = white.reshape(count, terms, -1)
            along3 = along.reshape(count, terms, -1)
            gram = white3 @ white3.transpose(0, 2, 1) - along3 @ along3.transpose(0, 2, 1)
            scale = np.sqrt(np.maximum(np.einsum("gtt->gt", white3 @ white3.transpose(0, 2, 1)), 1e-300))
            unit = gram / (scale[:, :, None] * scale[:, None, :]) + 1e-7 * np.eye(terms)
            solved = np.linalg.solve(unit, (dot / scale).transpose(1, 2, 0))
            coefficient = solved.transpose(2, 0, 1) / scale
        explained = np.einsum("sgt,sgt->sg", dot, coefficient)
        if effect is not None:
            explained = np.where(_allowed(effect, fit.linear.terms(effect), coefficient), explained, 0.0)
        rss = np.maximum(np.einsum("sn,sn->s", r, r), 1e-300)[:, None]
        remaining = np.maximum(rss - explained, 1e-12 * rss)
        gain = 2.0 * (base.likelihood[:, member] - top)[:, None] - base.dof * np.log(remaining / rss)
        better = gain > best_gain
        best_gain = np.where(better, gain, best_gain)
        best_coefficient = np.where(better[..., None], coefficient, best_coefficient)
    return best_gain, best_coefficient


def _allowed(effect: Effect, terms: tuple[Term, ...], coefficients: Array) -> Array:
    """Which fits (...) of coefficients (..., T) are physical: a lag is no lead, a level's change comes whole."""
    ok = np.ones(coefficients.shape[:-1], dtype=bool)
    for place, term in enumerate(terms):
        param = effect.params[term.param]
        if param.role == "level":
            ok &= (coefficients[..., place] > 0.5) & (coefficients[..., place] < 1.6)
        elif term.phase_deg is None and term.turn is None and param.lower == 0.0:
            ok &= coefficients[..., place] > 0.0
        elif term.phase_deg is None and term.turn is None and param.upper == 0.0:
            ok &= coefficients[..., place] < 0.0
    return ok


@dataclass(frozen=True, eq=False)
class Point:
    """A shape of an effect, what it gains, and the coefficients (T,) of its first-order fit."""

    shape: Mapping[str, float]
    gain: float
    coefficient: Array


def sharpened(
    base: Base, effect: Effect, shapes: Sequence[Mapping[str, float]], gains: Array, coefficients: Array
) -> list[Point]:
    """The best shape for each residual (batch,), zoomed in on where shapes are continuous.

    ``gains`` (batch, G) and ``coefficients`` (batch, G, T) are those of the ``shapes`` (see :func:`gains_of`).
    """
    points = []
    for place, best in enumerate(gains.argmax(axis=1)):
        alone = base.part(np.array([place]))
        point = Point(shapes[best], float(gains[place, best]), coefficients[place, best])
        for name in _smooth(effect, point.shape):
            point = _zoom(alone, effect, point, name=name, axis=np.unique([shape[name] for shape in shapes]))
        points.append(point)
    return points


def _zoom(base: Base, effect: Effect, point: Point, *, name: str, axis: Array) -> Point:
    """Climb from the best point of a grid ``axis`` of one parameter: finer grids between its neighbours."""
    place = int(np.searchsorted(axis, point.shape[name]))
    low, high = axis[max(place - 1, 0)], axis[min(place + 1, axis.size - 1)]
    if effect.line is not None:
        low, high = line_neighbours(base.fit, effect, point.shape[name])
    for _ in range(_ZOOMS):
        fine = [{**point.shape, name: float(value)} for value in np.linspace(low, high, _ZOOM_POINTS)]
        if effect.line is not None:
            inside = effect.line.within(np.array([f[name] for f in fine]))
            fine = [f for f, good in zip(fine, inside, strict=True) if good]
        if not fine:
            break
        gains, coefficients = (found[0] for found in gains_of(base, effect, fine))
        best = int(np.argmax(gains))
        if gains[best] > point.gain:
            point = Point(fine[best], float(gains[best]), coefficients[best])
        width = (high - low) / (_ZOOM_POINTS - 1)
        low, high = max(low, point.shape[name] - width), min(high, point.shape[name] + width)
    return point


def line_neighbours(fit: Fit, effect: Effect, value: float) -> tuple[float, float]:
    """Half the resolution of the line's clock to either side: where a finer search begins."""
    assert effect.line is not None
    motion = fit.linear.motion
    if effect.line.clock == "channels":
        # The clock is the value, the frequency 1/(2 step): resolved to the inverse of the range of values.
        reach = 2.0 * float(np.max(np.abs(fit.linear.at(effect).signal)))
        frequency = 100.0 / (2.0 * value)
        return 50.0 / (frequency + 0.5 / reach), 50.0 / max(frequency - 0.5 / reach, 1.0)
    span = np.ptp(motion.shaft_rad) / (2 * np.pi) if effect.line.clock == "shaft" else np.ptp(motion.time_s)
    step = 0.5 / max(float(span), 1e-12)
    return value - step, value + step


def _parameters(effect: Effect, terms: tuple[Term, ...], coefficient: Array, motion: Any) -> dict[str, Any]:
    """Parameters of the effect from its linear coefficients."""
    if effect.roles("per turn"):
        zeros = np.zeros(len(terms) + 1)
        zeros[1:] = coefficient
        return {terms[0].param: zeros - zeros.mean()}
    if effect.whole:
        return {}
    names = effect.roles("strength")
    if not effect.roles("phase"):
        return {name: float(c) for name, c in zip(names, coefficient, strict=True)}
    # One phase for all strengths: the leading direction of the pairs (cos, sin).
    pairs = coefficient.reshape(len(names), 2)
    _, _, right = np.linalg.svd(pairs)
    phase = right[0]
    found: dict[str, Any] = {name: float(pairs[k] @ phase) for k, name in enumerate(names)}
    if len(names) == 1 and found[names[0]] < 0.0:
        found[names[0]], phase = -found[names[0]], -phase
    found[effect.roles("phase")[0]] = float(np.degrees(np.arctan2(phase[1], phase[0])))
    return found
