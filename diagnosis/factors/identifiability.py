"""What an angle can and cannot tell: null space, correlations, profile likelihood, mirror solution, all in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model import least_squares, model
from diagnosis.error_model.model import GAIN, NAMES, QUAD, VX, VY, ZERO, Readings
from diagnosis.error_model.result import BaselineFit
from twin.angles import Array

PAPER_NAMES = ("Vx", "Ax", "Vy", "Ay", "beta", "K1", "K2", "K3", "mag", "zero")
"""The unknowns of Eq. 1, 2 and 4 as they stand there, and the zero."""

HIDDEN = (
    "the common scale of Ax, Ay, Vx and Vy",
    "the sensitivities K1, K2, K3 against Ax and Ay",
    "the field mag against K1 and K2, of which only q = K1 mag / K2 shows",
    "the constant K3 against Vx and Vy",
)
"""Changes of the unknowns that leave every angle as it is: the null space of :func:`paper_jacobian`, in words."""

_TIED = 0.9
_WEAK_SIGMA = 5.0
_UNSEEN = 1e-10
"""Smallest eigenvalue of the scaled information that rounding does not explain."""
_PROFILE_POINTS = 81
_PROFILE_REACH = 8.0
_WHAT = {
    "Vx_over_Ax": "x offset",
    "Vy_over_Ay": "y offset",
    "gain_ratio": "gain ratio",
    "beta_rad": "phase",
    "quad": "quadratic term",
    "zero_rad": "zero",
}


@dataclass(frozen=True)
class Profile:
    """95 % limits of one parameter by its profile likelihood; infinite where that never falls far enough."""

    name: str
    low: float
    high: float


@dataclass(frozen=True)
class Identifiability:
    """``correlations`` (6, 6); ``condition`` of the information scaled to a unit diagonal; the rest in words."""

    correlations: Array
    condition: float
    covered_deg: float
    unseen: tuple[tuple[float, ...], ...]
    """Combinations (6,) of parameters, each in its own standard units, that these readings do not see."""
    profiles: tuple[Profile, ...]
    sentences: tuple[str, ...]


def paper_jacobian(point: Array, *, k1: float = 1.896e-5, mag: float = 100.0) -> Array:
    """Derivatives (6, 10) of the visible parameters by the paper's own unknowns, taken where K2 mag = 1 and K3 = 0.

    x = Vx + Ax (K1 mag^2 c^2 + K2 mag c + K3): Vx/Ax -> Vx/(Ax K2 mag) + K3/(K2 mag), Ay/Ax as it is,
    q -> K1 mag / K2. ``k1`` is scaled so that q is that of ``point`` (6,).
    """
    vx, vy, gain = point[VX], point[VY], point[GAIN]
    quad = point[QUAD] if point[QUAD] != 0.0 else k1 * mag
    k2, ax, ay = 1.0 / mag, 1.0, gain
    own_k1 = quad * k2 / mag
    out = np.zeros((6, len(PAPER_NAMES)))
    column = {name: k for k, name in enumerate(PAPER_NAMES)}
    for row, offset, name, gain_name, amplitude in ((VX, vx, "Vx", "Ax", ax), (VY, vy, "Vy", "Ay", ay)):
        out[row, column[name]] = 1.0 / amplitude
        out[row, column[gain_name]] = -offset / amplitude
        out[row, column["K2"]] = -offset / k2
        out[row, column["mag"]] = -offset / mag
        out[row, column["K3"]] = 1.0
    out[GAIN, column["Ax"]], out[GAIN, column["Ay"]] = -ay / ax**2, 1.0 / ax
    out[QUAD, column["K1"]] = mag / k2
    out[QUAD, column["K2"]] = -own_k1 * mag / k2**2
    out[QUAD, column["mag"]] = own_k1 / k2
    out[model.BETA, column["beta"]] = out[ZERO, column["zero"]] = 1.0
    return out


def invisible_count(point: Array) -> int:
    """How many combinations of the paper's ten unknowns no angle can show, whatever the readings."""
    jacobian = paper_jacobian(point)
    scale = np.linalg.norm(jacobian, axis=0)
    return len(PAPER_NAMES) - int(np.linalg.matrix_rank(jacobian / np.where(scale > 0, scale, 1.0), tol=1e-8))


def identifiability(
    fit: BaselineFit, reference_rad: Array, measured_rad: Array, *, has_channels: bool = False
) -> Identifiability:
    """What these readings (n,) can tell of the six visible parameters."""
    readings = Readings.of(
        reference_rad,
        measured_rad,
        sensor_sense=float(fit.senses.sensor),
        output_sense=float(fit.senses.output),
        weights=np.where(fit.outliers, 0.0, 1.0),
    )
    gram = readings.gram(fit.point)
    curvature, _, _ = least_squares.on_gram(gram[None])(fit.point[None])
    scale = np.sqrt(np.maximum(np.diagonal(curvature[0]), 1e-300))
    values, vectors = np.linalg.eigh(curvature[0] / scale[:, None] / scale)
    error = fit.standard_errors
    correlations = fit.covariance / error[:, None] / error
    unseen = tuple(tuple(map(float, vectors[:, k])) for k in np.flatnonzero(values < _UNSEEN * values[-1]))
    weak = _weak(fit, correlations)
    profiles = tuple(_profile(fit, gram, int(index)) for index in np.flatnonzero(weak))
    covered = _covered(reference_rad[~fit.outliers])
    return Identifiability(
        correlations=correlations,
        condition=float(values[-1] / max(values[0], 1e-300)),
        covered_deg=covered,
        unseen=unseen,
        profiles=profiles,
        sentences=(
            *_always(fit, has_channels),
            *_here(covered, unseen, correlations),
            *_weak_words(fit, profiles),
            *_mirror(fit),
        ),
    )


def _weak(fit: BaselineFit, correlations: Array) -> NDArray[np.bool_]:
    """Parameters (6,) whose interval may be lopsided: hardly different from none, or nearly tied to another."""
    away = np.abs(fit.point - model.NOMINAL) / np.maximum(fit.standard_errors, 1e-300)
    away[ZERO] = np.inf
    tied = (np.abs(correlations - np.eye(6)) > _TIED).any(axis=1)
    return (away < _WEAK_SIGMA) | tied


def _profile(fit: BaselineFit, gram: Array, index: int) -> Profile:
    """Least squares over the other five at fixed values of one, on the quadratic form: no pass over the readings."""
    from scipy.special import stdtrit

    error = fit.standard_errors[index]
    offsets = np.linspace(-_PROFILE_REACH, _PROFILE_REACH, _PROFILE_POINTS) * error
    start = np.tile(fit.point, (_PROFILE_POINTS, 1))
    start[:, index] += offsets
    start = np.clip(start, model.LOWER_LIMIT, model.UPPER_LIMIT)
    fixed = np.arange(6) == index
    lanes = np.broadcast_to(gram, (_PROFILE_POINTS, 10, 10))
    count = fit.residual_rad.size
    found = least_squares.descend(least_squares.on_gram(lanes), start, count=count, fixed=fixed)
    middle = _PROFILE_POINTS // 2
    # The covariance may count angles instead of readings: its variance of a reading sets the scale.
    curvature, _, _ = least_squares.on_gram(gram[None])(fit.point[None])
    variance = float(np.mean(np.diagonal(fit.covariance @ curvature[0])))
    rise = (found.cost - found.cost[middle]) / max(variance, 1e-300)
    limit = float(stdtrit(max(fit.degrees_of_freedom, 1), 0.975)) ** 2
    low = _crossing(start[middle::-1, index], rise[middle::-1], limit)
    high = _crossing(start[middle:, index], rise[middle:], limit)
    return Profile(NAMES[index], low if low is not None else -np.inf, high if high is not None else np.inf)


def _crossing(values: Array, rise: Array, limit: float) -> float | None:
    above = np.flatnonzero(rise >= limit)
    if not above.size:
        return None
    k = int(above[0])
    # The rise is nearly a parabola, so its root is nearly straight.
    a, b = np.sqrt(np.maximum(rise[k - 1], 0.0)), np.sqrt(rise[k])
    return float(values[k - 1] + (values[k] - values[k - 1]) * (np.sqrt(limit) - a) / max(b - a, 1e-300))


def _covered(reference_rad: Array) -> float:
    """How much of the circle the readings cover [deg]: 360 less the widest gap, plus one usual step."""
    angles = np.sort(np.remainder(reference_rad, 2.0 * np.pi))
    gaps = np.diff(np.concatenate([angles, angles[:1] + 2.0 * np.pi]))
    moved = gaps[gaps > 1e-4]
    usual = float(np.median(moved)) if moved.size else 0.0
    return float(np.degrees(min(2.0 * np.pi - gaps.max() + usual, 2.0 * np.pi)))


def _always(fit: BaselineFit, has_channels: bool) -> tuple[str, ...]:
    visible = "an angle shows only Vx/Ax, Vy/Ay, Ay/Ax, beta, q and the zero"
    hidden = f"{visible}; of the paper's ten unknowns {invisible_count(fit.point)} combinations stay hidden:"
    first = f"{hidden} {'; '.join(HIDDEN)}"
    if has_channels:
        return (first, "vx and vy show Ax, Ay, Vx and Vy singly, in the unit of the channels")
    return (first, "vx and vy would show Ax, Ay, Vx and Vy singly and part the sensor's errors from the reference's")


def _here(covered: float, unseen: tuple[tuple[float, ...], ...], correlations: Array) -> tuple[str, ...]:
    said = []
    if covered < 330.0:
        said.append(f"the readings cover {covered:.0f} deg of the turn: parameters trade against each other there")
    for direction in unseen:
        size = np.abs(direction)
        parts = " and ".join(_WHAT[NAMES[k]] for k in np.argsort(-size) if size[k] > 0.25 * size.max())
        said.append(f"these readings do not see a combination of {parts}: only intervals of the others mean anything")
    if not unseen:
        rows, columns = np.nonzero(np.triu(np.abs(correlations), 1) > _TIED)
        if rows.size > 2:
            names = ", ".join(_WHAT[NAMES[k]] for k in np.unique([rows, columns]))
            said.append(f"{names} are nearly tied to one another (correlations above {_TIED})")
        else:
            said += [
                f"{_WHAT[NAMES[i]]} and {_WHAT[NAMES[j]]} are nearly tied (correlation {correlations[i, j]:+.2f})"
                for i, j in zip(rows, columns, strict=True)
            ]
    return tuple(said)


def _weak_words(fit: BaselineFit, profiles: tuple[Profile, ...]) -> tuple[str, ...]:
    said = []
    for profile in profiles:
        k = NAMES.index(profile.name)
        null = model.NOMINAL[k]
        if k != ZERO and profile.low <= null <= profile.high:
            said.append(f"{_WHAT[profile.name]}: compatible with none at all")
        if not np.isfinite(profile.low) or not np.isfinite(profile.high):
            said.append(f"{_WHAT[profile.name]}: the likelihood never falls off on one side; no bound there")
    said += [
        f"{_WHAT[name]} stands at the limit of the model" for name, at in zip(NAMES, fit.at_bound, strict=True) if at
    ]
    return tuple(said)


def _mirror(fit: BaselineFit) -> tuple[str, ...]:
    senses = fit.senses
    if senses.other is None:
        return ()
    beta, offset = np.degrees(senses.other[model.BETA]), 100.0 * senses.other[model.VY]
    pair = f"s = {-senses.sensor:+d}, h = {-senses.output:+d} (beta {beta:+.3f} deg, Vy/Ay {offset:+.3f} %)"
    if senses.matters:
        return (f"the mirror solution {pair} is {senses.sigma:.0f} standard errors worse, through q alone",)
    return (f"the mirror solution {pair} fits as well: an angle with so small a q cannot part them",)
