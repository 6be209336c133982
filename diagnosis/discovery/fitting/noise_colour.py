"""The noise's colour between the members of the family: what the extended twin is to simulate.

The search weighs residuals by the nearest member of a coarse family, which is enough to judge causes by. Sweeps that
are to look like the measured one need the colour itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise_model import NoiseFamily, log_determinant, spectrum
from twin.angles import Array

_HALVINGS = 5
_SMALLEST_RMS_RAD = 1e-6
_REACH_WHITE = 0.35
_MOST_WHITE = 0.95
_REACH_PINK = 0.45
_Range = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Colour:
    """Spectrum (n,) of mean 1 over the cosine coefficients, and the autoregression that comes nearest to it.

    ``correlation`` goes from one reading to the next, ``correlated_share`` is the share of the variance that has it.
    """

    spectrum: Array
    correlation: float
    correlated_share: float


def colour_of(fit: Fit) -> Colour:
    """The colour of highest restricted likelihood near the plausible members of the family, one of each kind.

    These were chosen with structure set aside; farther away structure that is left could pass for colour.
    """
    family, member = fit.setting.family, fit.setting.member
    if fit.rows <= 2 * len(fit.free) or float(np.mean(fit.residual[0] ** 2)) < _SMALLEST_RMS_RAD**2:
        return Colour(family.spectra[member], *family.correlation[member])
    cost = _restricted_cost(fit)
    near = [_nearby(family, start, cost) for start in _one_of_each_kind(fit, cost)]
    return min(near, key=lambda colour: cost(colour.spectrum))


def _nearby(family: NoiseFamily, member: int, cost: Callable[[Array], float]) -> Colour:
    """The best colour in the neighbourhood of a member."""
    n = family.spectra.shape[1]
    start, bounds, pink = _neighbourhood(family.correlation, family.labels, member)

    def of(first: float, white: float) -> Array:
        return spectrum(n, pink=first, white=white) if pink else spectrum(n, phi=first, white=white)

    first, white = _descended(lambda first, white: cost(of(first, white)), start, bounds)
    # The twin's noise is autoregressive: 1/f noise gets the correlation that lies nearest.
    correlation = 0.5 + 0.4 * first if pink else first
    return Colour(of(first, white), min(correlation, 0.995), 1.0 - white)


def _one_of_each_kind(fit: Fit, cost: Callable[[Array], float]) -> list[int]:
    """The member in force and, where it is coloured, the best plausible one of the other coloured kind."""
    family, member = fit.setting.family, fit.setting.member
    if member == 0:
        return [member]
    other = [m for m in fit.setting.plausible if m and _is_pink(family.labels[m]) != _is_pink(family.labels[member])]
    return [member, *([min(other, key=lambda m: cost(family.spectra[m]))] if other else [])]


def _is_pink(label: str) -> bool:
    return label.startswith("1/f")


def _descended(
    cost: Callable[[float, float], float], start: tuple[float, float], bounds: tuple[_Range, _Range]
) -> tuple[float, float]:
    """The lowest point that a compass search finds: a step to each side, halved where none is better."""
    best, lowest = start, cost(*start)
    steps = [(high - low) / 4.0 for low, high in bounds]
    for _ in range(_HALVINGS):
        moved = True
        while moved:
            moved = False
            for axis, sign in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
                low, high = bounds[axis]
                value = min(max(best[axis] + sign * steps[axis], low), high)
                point = (value, best[1]) if axis == 0 else (best[0], value)
                here = cost(*point) if point != best else lowest
                if here < lowest - 1e-6:
                    best, lowest, moved = point, here, True
        steps = [0.5 * step for step in steps]
    return best


def _neighbourhood(
    table: tuple[tuple[float, float], ...], labels: tuple[str, ...], member: int
) -> tuple[tuple[float, float], tuple[_Range, _Range], bool]:
    """Start, bounds of (correlation or exponent, white share), and whether it is 1/f noise."""
    phi, share = table[member]
    white = 1.0 - share
    pink = _is_pink(labels[member])
    whites = (max(white - _REACH_WHITE, 0.0), min(white + _REACH_WHITE, _MOST_WHITE))
    if pink:
        alpha = float(labels[member].removeprefix("1/f^").split()[0])
        return (alpha, white), ((alpha - _REACH_PINK, alpha + _REACH_PINK), whites), True
    if phi == 0.0:
        # Without correlation there is nothing for white noise to stand beside.
        whites = (0.0, 0.0)
    others = sorted({phi for (phi, _), label in zip(table, labels, strict=True) if not _is_pink(label)})
    place = others.index(phi)
    low, high = others[max(place - 2, 0)], (*others, 0.995, 0.995)[place + 2]
    return (phi, white), ((low, high), whites), False


def _restricted_cost(fit: Fit) -> Callable[[Array], float]:
    """Minus the restricted log likelihood of the angle's residual as a function of the spectrum (n,)."""
    c = fit.cosine_residual[0]
    columns = np.concatenate([fit.cosine_jacobian[:, 0], fit.prior_jacobian], axis=1)
    scale = np.linalg.norm(columns, axis=1, keepdims=True)
    columns = columns[scale[:, 0] > 0.0] / scale[scale[:, 0] > 0.0]
    j, prior = columns[:, : c.size], columns[:, c.size :]
    held = prior @ prior.T + 1e-12 * np.eye(len(columns))
    pull, rest = prior @ fit.prior_residual, float(fit.prior_residual @ fit.prior_residual)
    dof = fit.rows - len(columns)

    def cost(shape: Array) -> float:
        weighted = j / shape
        gram = weighted @ j.T + held
        along = weighted @ c + pull
        left = float(np.sum(c * c / shape)) + rest - float(along @ np.linalg.solve(gram, along))
        _, log_det = np.linalg.slogdet(gram)
        return 0.5 * (dof * float(np.log(max(left, 1e-300))) + log_determinant(shape, fit.rows) + float(log_det))

    return cost
