"""The joint fit: every free parameter of the chain at once, exact model, whitened by the noise as it is."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from diagnosis.discovery.fitting.coefficients import observables_to_cosine
from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.fitting.noise_family import NoiseFamily
from diagnosis.discovery.fitting.observations import Observations
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import Array, wrap
from twin.baseline import FACTORS
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Effect
from twin.mechanics.zero import ZERO
from twin.noise.spectrum import to_rows


@dataclass(frozen=True)
class Free:
    """One free parameter: the instance it belongs to, its name, and the turn where it has one a turn."""

    key: str
    name: str
    turn: int | None = None


ZERO_ANGLE = Free(ZERO.name, "zero_deg")
BASELINE = (ZERO_ANGLE, *(Free(f.key, f.param) for f in FACTORS if f.effect is not ZERO))
"""The paper's error model, always fitted."""


@dataclass(frozen=True, eq=False)
class Weighting:
    """How residuals are weighed: the family member in force, the blur of stairs, the radius against the angle.

    ``radius_weight`` multiplies the radius' whitened squares; ``radius_member`` is its own family member. ``members``
    are the family members that the noise may be; none given: all of them. ``radius_trusted``: what the radius does at
    some angles is taken for a cause's work, never for noise. ``coarse``: stairs
    make most of the spread. ``slopes``: those of blurred edges count, see
    :class:`~diagnosis.discovery.fitting.linearised_chain.Linear`.
    """

    family: NoiseFamily
    member: int = 0
    blur: float = 0.0
    radius_member: int = 0
    radius_weight: float = 0.0
    members: tuple[int, ...] = ()
    radius_trusted: bool = False
    coarse: bool = False
    slopes: bool = False
    settings: DiscoverySettings = field(default_factory=DiscoverySettings)

    @property
    def plausible(self) -> tuple[int, ...]:
        """The members that likelihoods are maximised over."""
        return self.members or tuple(range(len(self.family.members)))


@dataclass(frozen=True, eq=False)
class Fit:
    """A chain fitted to observations.

    ``residual`` (O, n) over the rows, ``jacobian`` (P, O, n) there too; ``cosine_residual`` and ``cosine_jacobian``
    their coefficients with the priors of per-turn zeros appended, flattened to (N,) and (P, N) by :func:`flat`.
    """

    chain: Chain
    free: tuple[Free, ...]
    observations: Observations
    weighting: Weighting
    linear: Linear
    residual: Array
    jacobian: Array
    cosine_residual: Array
    cosine_jacobian: Array
    prior_residual: Array
    prior_jacobian: Array

    def __repr__(self) -> str:
        left = np.degrees(np.sqrt(np.mean(self.residual[0][self.observations.usable] ** 2)))
        return f"Fit({self.chain!r}, {len(self.free)} free parameters, {self.rows} rows, {left:.4g} deg RMS)"

    @property
    def settings(self) -> DiscoverySettings:
        """The thresholds by which the fit is judged."""
        return self.weighting.settings

    @property
    def rows(self) -> int:
        """Rows in use."""
        return int(np.count_nonzero(self.observations.usable))

    def whitened(self, member: int | None = None) -> tuple[Array, Array]:
        """Residual (N,) and Jacobian (P, N) whitened by a family member (the one in force if not given)."""
        root = root_weights(self.weighting, self.observations.observables, member)
        r = (self.cosine_residual * root).ravel()
        j = (self.cosine_jacobian * root).reshape(len(self.free), r.size)
        return np.concatenate([r, self.prior_residual]), np.concatenate([j, self.prior_jacobian], axis=1)

    def covariance(self) -> Array:
        """Covariance (P, P) of the free parameters in their own units; a direction without information is infinite."""
        r, j = self.whitened()
        scale = np.linalg.norm(j, axis=1)
        scale[scale == 0.0] = 1.0
        u, s, _ = np.linalg.svd(j / scale[:, None], full_matrices=False)
        good = s > 1e-9 * s[0]
        inverse = (u[:, good] / s[good] ** 2) @ u[:, good].T
        dof = max(self.rows * self.observations.observables - int(good.sum()), 1)
        if self.weighting.slopes:
            # At the edges of stairs a reading is either above or below: just where it tells most it scatters most.
            rows = inverse @ (self._in_rows(j) * self._in_rows(r) / scale[:, None])
            spread = rows @ rows.T * (self.rows * self.observations.observables / dof)
        else:
            spread = inverse * (float(r @ r) / dof)
        if not good.all():
            spread = spread + np.diag(np.where(np.abs(u[:, ~good]).max(axis=1) > 0.1, np.inf, 0.0))
        return np.asarray(spread / np.outer(scale, scale))

    def _in_rows(self, whitened: Array) -> Array:
        """Whitened coefficients (..., N) of the observables back over the rows; the priors' stay as they are."""
        size = self.observations.observables * len(self.observations)
        shape = (*whitened.shape[:-1], self.observations.observables, len(self.observations))
        rows = to_rows(whitened[..., :size].reshape(shape)).reshape(*whitened.shape[:-1], size)
        return np.concatenate([rows, whitened[..., size:]], axis=-1)


def root_weights(weighting: Weighting, observables: int, member: int | None = None) -> Array:
    """Square roots of the weights (O, n) on cosine coefficients."""
    weights = weighting.family.weights
    rows = [weights[weighting.member if member is None else member]]
    if observables == 2:
        rows.append(weighting.radius_weight * weights[weighting.radius_member])
    return np.asarray(np.sqrt(np.stack(rows)))


def evaluate(chain: Chain, free: tuple[Free, ...], observations: Observations, weighting: Weighting) -> Fit:
    """Residual and Jacobian of a chain at its present parameters."""
    observables = observations.observables
    linear = Linear(chain, observations.motion, blur=weighting.blur, observables=observables, slopes=weighting.slopes)
    residual = np.empty((observations.observables, len(observations)))
    residual[0] = wrap(observations.measured - linear.angle)
    nuisance: list[Array] = []
    if observations.log_radius is not None:
        residual[1] = observations.log_radius - linear.log_radius
        nuisance = radius_nuisance(observations)
    columns = [linear.derivative(f.key, find(f.key, chain.effects), f.name, f.turn) for f in free]
    jacobian = np.stack(columns) if columns else np.zeros((0, observations.observables, len(observations)))
    if nuisance:
        # The channels' common scale and its drift with temperature tell nothing about an angle: projected out.
        basis = np.linalg.qr(np.stack(nuisance).T)[0].T
        residual[1] -= (residual[1] @ basis.T) @ basis
        jacobian[:, 1] -= (jacobian[:, 1] @ basis.T) @ basis
    prior_residual, prior_jacobian = _priors(chain, free, observations, residual[0])
    return Fit(
        chain=chain,
        free=free,
        observations=observations,
        weighting=weighting,
        linear=linear,
        residual=residual,
        jacobian=jacobian,
        cosine_residual=observables_to_cosine(observations, residual),
        cosine_jacobian=observables_to_cosine(observations, jacobian),
        prior_residual=prior_residual,
        prior_jacobian=prior_jacobian,
    )


def radius_nuisance(observations: Observations) -> list[Array]:
    """What the radius may do for reasons of its own: a scale, and a quadratic in temperature. Masked rows are zero."""
    usable = observations.usable.astype(np.float64)
    columns = [usable]
    if "two temperatures" in observations.motion.provides:
        warm = (observations.motion.temperature_c - 25.0) / 50.0
        columns += [usable * warm, usable * warm**2]
    return columns


def _priors(chain: Chain, free: tuple[Free, ...], observations: Observations, residual: Array) -> tuple[Array, Array]:
    """What is known of parameters before the sweep, in units of the residual's RMS.

    Per-turn zeros scatter: each is held by the scatter of all. This makes them a random effect, so that an effect
    common to many turns (a direction) is not given away to them, and it fixes their common part, which belongs to
    ``zero``. A shape that its declaration gives a standard deviation is held by that about where it stands: it goes
    where the readings send it, and what they do not tell has a finite interval.
    """
    turns = [k for k, f in enumerate(free) if f.turn is not None]
    known = [(k, find(f.key, chain.effects).params[f.name].prior_sd) for k, f in enumerate(free) if f.turn is None]
    shapes = [(k, sd) for k, sd in known if sd > 0.0]
    held = np.zeros(len(turns) + len(shapes))
    jacobian = np.zeros((len(free), held.size))
    if not held.size:
        return held, jacobian
    # Whitened residuals are in radians: a prior of one sigma counts as one residual RMS.
    unit = float(np.sqrt(np.mean(residual[observations.usable] ** 2)))
    if turns:
        zeros = np.array([float(np.asarray(chain.values[free[k].key][free[k].name])[free[k].turn or 0]) for k in turns])
        strength = unit / max(float(np.std(zeros, ddof=1)) if zeros.size > 1 else 0.0, 1e-4)
        held[: zeros.size] = -strength * zeros
        jacobian[turns, np.arange(zeros.size)] = strength
    for row, (k, sd) in enumerate(shapes, start=len(turns)):
        jacobian[k, row] = unit / sd
    return held, jacobian


def solve(fit: Fit, *, iterations: int = 12, tolerance: float = 1e-4) -> Fit:
    """Levenberg-Marquardt from the fit's chain: the same free parameters at their optimum.

    Ends when no parameter moves by more than ``tolerance`` of its standard deviation.
    """
    if not fit.free:
        return fit
    damping = 0.0
    cost = _cost(fit)
    for _ in range(iterations):
        r, j = fit.whitened()
        scale = np.linalg.norm(j, axis=1)
        alive = scale > 1e-12 * max(scale.max(), 1e-300)
        unit = np.where(alive, scale, 1.0)
        a = j / unit[:, None]
        normal = a @ a.T
        gradient = a @ r
        sigma = np.sqrt(cost / max(fit.rows - len(fit.free), 1))
        improved = False
        for _ in range(6):
            system = normal + (1e-12 + damping) * np.eye(len(unit))
            step = np.where(alive, np.linalg.solve(system, gradient), 0.0)
            trial = evaluate(_moved(fit, step / unit), fit.free, fit.observations, fit.weighting)
            new_cost = _cost(trial)
            if new_cost <= cost * (1.0 + 1e-12):
                improved = True
                break
            damping = max(4.0 * damping, 1e-3)
        if not improved:
            break
        moved = float(np.max(np.abs(step)))
        gained = cost - new_cost
        fit, cost = trial, new_cost
        damping *= 0.25
        if moved < tolerance * sigma or gained < 1e-7 * cost:
            break
    return fit


def _cost(fit: Fit) -> float:
    r, _ = fit.whitened()
    return float(r @ r)


def _moved(fit: Fit, step: Array) -> Chain:
    """The chain with its free parameters moved by ``step`` (P,), in the parameters' own units."""
    values = {key: dict(params) for key, params in fit.chain.values.items()}
    for place, free in enumerate(fit.free):
        param = find(free.key, fit.chain.effects).params[free.name]
        if free.turn is not None:
            zeros = np.array(values[free.key][free.name], dtype=np.float64)
            zeros[free.turn] += step[place]
            values[free.key][free.name] = zeros
            continue
        moved = float(values[free.key][free.name]) + step[place]
        # An amplitude may pass through zero on its way: its phase then turns by half a turn, afterwards.
        lower = -param.upper if param.role == "strength" and param.lower == 0.0 else param.lower
        if param.role == "phase":
            values[free.key][free.name] = moved
        else:
            values[free.key][free.name] = float(np.clip(moved, lower, param.upper))
    return replace(fit.chain, values=values)


def free_of(effect: Effect, key: str, *, turns: int, channels: bool) -> tuple[Free, ...]:
    """The parameters of an effect that a fit may move: strengths, phases, and shapes that are no whole numbers."""
    found: list[Free] = []
    for name, param in effect.params.items():
        if param.role in ("strength", "phase") or (
            param.role in ("level", "shape") and not param.counts and name in searched(effect, channels)
        ):
            found.append(Free(key, name))
        elif param.role == "per turn":
            found.extend(Free(key, name, turn) for turn in range(turns))
    return tuple(found)


def searched(effect: Effect, channels: bool) -> frozenset[str]:
    """Names of the shape and level parameters that a fit may move, with or without recorded channels."""
    names = {effect.line.param} if effect.line else set()
    return frozenset(names | set(effect.fitted_shapes) | (set(effect.channel_shapes) if channels else set()))


def tidy(chain: Chain) -> Chain:
    """Amplitudes made positive, phases and zeros brought to (-180, 180]."""
    values = {key: dict(params) for key, params in chain.values.items()}
    for key, params in values.items():
        effect = find(key, chain.effects)
        phases = effect.roles("phase")
        for name in effect.roles("strength"):
            if phases and float(params.get(name, 0.0)) < 0.0 and name == effect.roles("strength")[0]:
                # The first strength is positive by convention; half a turn of the phase turns all of them.
                for turned in effect.roles("strength"):
                    params[turned] = -float(params[turned])
                params[phases[0]] = float(params[phases[0]]) + 180.0
        for name in (*phases, *((ZERO_ANGLE.name,) if key == ZERO_ANGLE.key else ())):
            params[name] = float(-((-float(params[name]) + 180.0) % 360.0 - 180.0))
    return replace(chain, values=values)
