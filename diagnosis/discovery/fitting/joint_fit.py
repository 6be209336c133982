"""The joint fit: every free parameter of the chain at once, exact model, whitened by the noise as it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from diagnosis.discovery.fitting.bounded_step import eased, step_within
from diagnosis.discovery.fitting.coefficients import observables_to_cosine, to_rows
from diagnosis.discovery.fitting.columns import Columns
from diagnosis.discovery.fitting.free_parameters import ZERO_ANGLE, Free, bounds, declared, from_centre, value_in
from diagnosis.discovery.fitting.linearised_chain import Linear
from diagnosis.discovery.fitting.noise_family import NoiseFamily
from diagnosis.discovery.fitting.nuisance import without_nuisance
from diagnosis.discovery.fitting.observations import Observations
from diagnosis.discovery.fitting.projection import projected
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import Array, wrap
from twin.chain import Chain


@dataclass(frozen=True, eq=False)
class Weighting:
    """How residuals are weighed: the family member in force, the blur of stairs, the radius against the angle.

    ``radius_weight`` multiplies the radius' whitened squares; ``radius_member`` is its own family member. ``members``
    are the family members that the noise may be; none given: all of them. ``radius_trusted``: what the radius does at
    some angles is taken for a cause's work, never for noise. ``coarse``: stairs
    make most of the spread. ``slopes``: those of blurred edges count, see
    :class:`~diagnosis.discovery.fitting.linearised_chain.Linear`. ``to_come_rad`` is the RMS of the noise that readings
    will have which are planned and not measured yet.
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
    to_come_rad: float = 0.0
    settings: DiscoverySettings = field(default_factory=DiscoverySettings)

    @property
    def plausible(self) -> tuple[int, ...]:
        """The members that likelihoods are maximised over."""
        return self.members or tuple(range(len(self.family.members)))


@dataclass(frozen=True, eq=False)
class Fit:
    """A chain fitted to observations.

    ``residual`` (O, n) over the rows and ``cosine_residual`` (O, n) its coefficients. ``strengths`` (P,) are those of
    the priors.
    """

    chain: Chain
    free: tuple[Free, ...]
    observations: Observations
    weighting: Weighting
    linear: Linear
    columns: Columns
    residual: Array
    cosine_residual: Array
    strengths: Array

    def __repr__(self) -> str:
        left = np.degrees(np.sqrt(np.mean(self.residual[0][self.observations.usable] ** 2)))
        return f"Fit({self.chain!r}, {len(self.free)} free parameters, {self.rows} rows, {left:.4g} deg RMS)"

    @property
    def jacobian(self) -> Array:
        """What each free parameter does to the observables (P, O, n), over the rows."""
        return self.columns.rows

    @property
    def cosine_jacobian(self) -> Array:
        """The same as cosine coefficients (P, O, n)."""
        return self.columns.cosine

    @property
    def settings(self) -> DiscoverySettings:
        """The thresholds by which the fit is judged."""
        return self.weighting.settings

    @property
    def rows(self) -> int:
        """Rows in use."""
        return int(np.count_nonzero(self.observations.usable))

    @property
    def freedom(self) -> int:
        """Degrees of freedom that the fit leaves of all observables, at least one."""
        return max(self.rows * self.observations.observables - len(self.free), 1)

    @property
    def variance(self) -> float:
        """Variance of the noise by the whitened residual."""
        return cost_of(self) / self.freedom

    @property
    def by_average(self) -> bool:
        """Whether stairs lie between the readings and a motion that is estimated from these: they tell on average."""
        return self.weighting.blur > 0.0 and self.observations.motion.estimated is not None

    @property
    def squares_to_first_order(self) -> float:
        """Sum of the whitened squares that would be left were the chain linear in the free parameters."""
        left = projected(*self.whitened())
        return float(left @ left)

    @property
    def prior_residual(self) -> Array:
        """What the parameters that a prior holds lack to its centre, in units of the residual."""
        away: Array = self.strengths * from_centre(self.chain, self.free)
        return -away[self.strengths > 0.0]

    @property
    def prior_jacobian(self) -> Array:
        """How that follows each free parameter, one column for every one that is held."""
        held: Array = np.diag(self.strengths)[:, self.strengths > 0.0]
        return held

    def whitened(self, member: int | None = None) -> tuple[Array, Array]:
        """Residual (N,) and Jacobian (P, N) whitened by a family member (the one in force if not given)."""
        return self.whitened_residual(member), self.whitened_columns(range(len(self.free)), member)

    def whitened_columns(self, places: Sequence[int], member: int | None = None) -> Array:
        """The rows (len(places), N) of the whitened Jacobian that belong to the free parameters at these places."""
        root = root_weights(self.weighting, self.observations.observables, member)
        prior = self.prior_jacobian[places]
        out = np.empty((len(places), root.size + prior.shape[1]))
        np.multiply(self.columns.cosine_at(places), root, out=out[:, : root.size].reshape(len(places), *root.shape))
        out[:, root.size :] = prior
        return out

    def whitened_residual(self, member: int | None = None) -> Array:
        """The residual (N,) alone."""
        root = root_weights(self.weighting, self.observations.observables, member)
        return np.concatenate([(self.cosine_residual * root).ravel(), self.prior_residual])

    def covariance(self) -> Array:
        """Covariance (P, P) of the free parameters in their own units; a direction without information is infinite."""
        return self._covariance

    @cached_property
    def _covariance(self) -> Array:
        if not self.free:
            return np.zeros((0, 0))
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
        rows = to_rows(self.observations, whitened[..., :size].reshape(shape)).reshape(*whitened.shape[:-1], size)
        return np.concatenate([rows, whitened[..., size:]], axis=-1)


_HELD = 1e9
"""Strength of a prior that lets a parameter go nowhere: a billionth of a degree weighs as much as a radian of noise."""
SMALL_GAIN = 1e-3
"""Gain in chi-square below which a fit is at its optimum: a parameter that means nothing gains 1 by chance."""


def root_weights(weighting: Weighting, observables: int, member: int | None = None) -> Array:
    """Square roots of the weights (O, n) on cosine coefficients."""
    weights = weighting.family.weights
    rows = [weights[weighting.member if member is None else member]]
    if observables == 2:
        rows.append(weighting.radius_weight * weights[weighting.radius_member])
    return np.asarray(np.sqrt(np.stack(rows)))


def evaluate(
    chain: Chain,
    free: tuple[Free, ...],
    observations: Observations,
    weighting: Weighting,
    strengths: Array | None = None,
) -> Fit:
    """A chain at its present parameters.

    ``strengths`` (P,) are those with which priors hold them; not given, they follow from what the chain leaves.
    """
    seen = observations.observables
    linear = Linear(chain, observations.motion, blur=weighting.blur, observables=seen, slopes=weighting.slopes)
    residual = np.empty((seen, len(observations)))
    residual[0] = wrap(observations.measured - linear.angle) + observations.torques
    if observations.log_radius is not None:
        residual[1] = observations.log_radius - linear.log_radius
    residual = without_nuisance(observations, residual)
    columns = Columns(linear, tuple((f.key, f.name, f.turn) for f in free), observations)
    cosine = observables_to_cosine(observations, residual)
    held = np.zeros(len(free)) if strengths is None else strengths
    fit = Fit(chain, free, observations, weighting, linear, columns, residual, cosine, held)
    return fit if strengths is not None else held_anew(fit)


def held_anew(fit: Fit) -> Fit:
    """The fit with priors as strong as its residual alone says, as one is evaluated that no other went before."""
    return replace(fit, strengths=_prior_strengths(replace(fit, strengths=np.zeros(len(fit.free)))))


def _prior_strengths(fit: Fit) -> Array:
    """How firmly each free parameter (P,) is held by what is known before the sweep, in units of the residual's RMS.

    Per-turn zeros scatter: each is held by the scatter of all. This makes them a random effect, so that an effect
    common to many turns (a direction) is not given away to them, and it fixes their common part, which belongs to
    ``zero``. A shape that its declaration gives a standard deviation is held by that about what is most likely, or
    where nothing is, about where it stands: then it goes where the readings send it, and what they do not tell has a
    finite interval. 0: anything goes.
    """
    chain, free, observations = fit.chain, fit.free, fit.observations
    params = [param for _, param in declared(chain, free)]
    # Whitened residuals are in radians: a prior of one sigma counts as one RMS of the noise, the unit. Noise is what
    # the readings are off by, and what planned ones will be off by beside that.
    rms = np.sqrt(np.mean(fit.residual[0][observations.usable] ** 2))
    unit = float(np.hypot(rms, fit.weighting.to_come_rad))
    strengths = np.array([unit / param.prior_sd if param.prior_sd > 0.0 else 0.0 for param in params])
    if observations.motion.estimated is not None:
        # A motion that no reference recorded counts from where the readings do: a convention, and no unknown.
        zeros = [place for place, f in enumerate(free) if f.name == ZERO_ANGLE.name]
        strengths[zeros] = _HELD
    turns = [place for place, f in enumerate(free) if f.turn is not None]
    if turns:
        strengths[turns] = unit / _scatter(fit, turns, unit)
    return strengths


def _scatter(fit: Fit, turns: Sequence[int], unit: float) -> float:
    """Standard deviation of the turns' zeros, in their own unit, by how many of them the readings tell.

    As they are drawn towards one another by it, their own scatter is less, and would draw itself to nothing. Their
    squares are shared among the zeros that are told, each by what its readings weigh against what holds it, until
    this is what is most likely (MacKay, Neural Computation 4, 415, 1992).
    """
    zeros = from_centre(fit.chain, fit.free)[turns]
    spread = max(float(np.std(zeros, ddof=1)) if zeros.size > 1 else 0.0, 1e-4)
    root = root_weights(fit.weighting, fit.observations.observables)
    weight = np.sum((fit.columns.cosine_at(turns) * root) ** 2, axis=(1, 2))
    held = np.where(fit.strengths[turns] > 0.0, fit.strengths[turns], unit / spread)
    share = float(np.mean(weight / (weight + held**2)))
    # Zeros that no reading tells stay as they are.
    return spread / float(np.sqrt(share)) if share > 1e-9 else spread


def solve(fit: Fit, *, iterations: int = 12, tolerance: float = 1e-4, least_gain: float = SMALL_GAIN) -> Fit:
    """Levenberg-Marquardt from the fit's chain: the same free parameters at their optimum.

    Ends when no parameter moves by more than ``tolerance`` of its standard deviation, or a step gains less than
    ``least_gain`` in chi-square.
    """
    if not fit.free:
        return fit
    damping = 0.0
    cost = cost_of(fit)
    for _ in range(iterations):
        r, j = fit.whitened()
        scale = np.linalg.norm(j, axis=1)
        alive = scale > 1e-12 * max(scale.max(), 1e-300)
        unit = np.where(alive, scale, 1.0)
        a = j / unit[:, None]
        normal = a @ a.T
        gradient = a @ r
        sigma = np.sqrt(cost / max(fit.rows - len(fit.free), 1))
        lower, upper = (room * unit for room in _room(fit))
        growth = 2.0
        improved = False
        for _ in range(6):
            system = normal + (1e-12 + damping) * np.eye(len(unit))
            step = np.where(alive, step_within(system, gradient, lower, upper), 0.0)
            # What priors hold follows from the residual: a trial is compared by those of the fit that it starts from.
            trial = evaluate(moved_by(fit, step / unit), fit.free, fit.observations, fit.weighting, fit.strengths)
            new_cost = cost_of(trial)
            promised = float(step @ (2.0 * gradient - normal @ step))
            if new_cost <= cost * (1.0 + 1e-12):
                improved = True
                break
            if promised < least_gain * sigma**2:
                # Not even what it promised would have counted, and a shorter step promises less.
                break
            damping, growth = (growth * damping if damping else 1e-3), 2.0 * growth
        if not improved:
            break
        moved = float(np.max(np.abs(step)))
        gained = cost - new_cost
        damping *= eased(gained / max(promised, 1e-300))
        fit = replace(trial, strengths=_prior_strengths(trial))
        cost = cost_of(fit)
        if moved < tolerance * sigma or gained < least_gain * sigma**2:
            break
    return fit


def _room(fit: Fit) -> tuple[Array, Array]:
    """How far each free parameter may move down and up (P,), in its own unit; phases and turns' zeros go anywhere."""
    lower, upper = np.full(len(fit.free), -np.inf), np.full(len(fit.free), np.inf)
    parameters = declared(fit.chain, fit.free)
    for place, (free, (effect, param)) in enumerate(zip(fit.free, parameters, strict=True)):
        if free.turn is None and param.role != "phase":
            value = value_in(fit.chain, free, param)
            least, most = bounds(effect, param)
            lower[place], upper[place] = min(least - value, 0.0), max(most - value, 0.0)
    return lower, upper


def cost_of(fit: Fit) -> float:
    """Sum of the whitened squares that a fit leaves."""
    r = fit.whitened_residual()
    return float(r @ r)


def moved_by(fit: Fit, step: Array) -> Chain:
    """The chain with its free parameters moved by ``step`` (P,), in the parameters' own units."""
    values = {key: dict(params) for key, params in fit.chain.values.items()}
    parameters = declared(fit.chain, fit.free)
    for place, (free, (effect, param)) in enumerate(zip(fit.free, parameters, strict=True)):
        if free.turn is not None:
            zeros = np.array(values[free.key][free.name], dtype=np.float64)
            zeros[free.turn] += step[place]
            values[free.key][free.name] = zeros
            continue
        moved = value_in(fit.chain, free, param) + float(step[place])
        if param.role != "phase":
            # A rounding beyond its bound.
            least, most = bounds(effect, param)
            moved = min(max(moved, least), most)
        values[free.key][free.name] = moved
    return replace(fit.chain, values=values)
