"""The noise's colour between the members of the family: what the extended twin is to simulate.

The search weighs residuals by the nearest member of a coarse family, which is enough to judge causes by. Sweeps that
are to look like the measured one need the colour itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.fitting.noise_family import MEMBERS, log_determinant
from twin.angles import Array
from twin.noise.description import Noise

_HALVINGS = 5
"""Of the search's steps, from a quarter of a range to 1/128: what a thousand readings tell is three times as coarse."""
_REACH_WHITE = 0.35
"""To the next but one white share in the family."""
_MOST_WHITE = 0.95
"""With more white noise beside it a colour cannot be told from none."""
_REACH_FLICKER = 0.45
"""Almost to the next exponent in the family."""
_MOST_CORRELATED = 0.995
"""Of noise that is slower than 200 readings a record of some hundreds shows a drift only."""
_Range = tuple[float, float]
_Cost = Callable[[Noise], float]


def coloured(fit: Fit) -> Noise:
    """The colour of highest restricted likelihood near the family's member in force, and its RMS.

    That member was chosen with structure set aside; farther away structure that is left could pass for colour. The RMS
    is that of a reading whose row has the scale 1 in the observations.
    """
    noise = fit.weighting.family.members[fit.weighting.member]
    left = (fit.residual[0] / fit.observations.scale)[fit.observations.usable]
    rms = float(np.sqrt(np.mean(left**2)))
    if fit.rows <= 2 * len(fit.free) or rms < np.radians(fit.settings.smallest_rms_deg):
        return replace(noise, rms_rad=rms)
    likelihood = _Restricted.of(fit)
    best = _Neighbourhood.of(noise).best(likelihood.cost)
    return replace(best, rms_rad=likelihood.rms(best))


def _flickers(noise: Noise) -> bool:
    return noise.flicker_exponent > 0.0


@dataclass(frozen=True)
class _Neighbourhood:
    """Where to look about a member: its correlation, exponent or quality, and its white share, each within bounds."""

    start: Noise
    name: str
    bounds: tuple[_Range, _Range]

    @classmethod
    def of(cls, noise: Noise) -> _Neighbourhood:
        """As far as the second neighbour in the family."""
        white = noise.white_share
        whites = (max(white - _REACH_WHITE, 0.0), min(white + _REACH_WHITE, _MOST_WHITE))
        if _flickers(noise):
            exponent = noise.flicker_exponent
            return cls(noise, "flicker_exponent", ((exponent - _REACH_FLICKER, exponent + _REACH_FLICKER), whites))
        if noise.rings:
            quality = noise.ringing_quality
            return cls(noise, "ringing_quality", ((0.5 * quality, 2.0 * quality), whites))
        if noise.white:
            # Without correlation there is nothing for white noise to stand beside.
            whites = (0.0, 0.0)
        others = sorted({member.correlation for member in MEMBERS if not _flickers(member)})
        place = others.index(noise.correlation)
        high = (*others, _MOST_CORRELATED, _MOST_CORRELATED)[place + 2]
        return cls(noise, "correlation", ((others[max(place - 2, 0)], high), whites))

    def at(self, point: tuple[float, float]) -> Noise:
        """The noise with this correlation, exponent or quality and this white share."""
        first, white = point
        moved: dict[str, Any] = {self.name: first, "white_share": white}
        return replace(self.start, **moved)

    def best(self, cost: _Cost) -> Noise:
        """The lowest point that a compass search finds: a step to each side, halved where none is better."""
        best = (getattr(self.start, self.name), self.start.white_share)
        lowest = cost(self.at(best))
        steps = [(high - low) / 4.0 for low, high in self.bounds]
        for _ in range(_HALVINGS):
            moved = True
            while moved:
                moved = False
                for axis, sign in ((0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)):
                    low, high = self.bounds[axis]
                    value = min(max(best[axis] + sign * steps[axis], low), high)
                    point = (value, best[1]) if axis == 0 else (best[0], value)
                    here = cost(self.at(point)) if point != best else lowest
                    if here < lowest - 1e-6:
                        best, lowest, moved = point, here, True
            steps = [0.5 * step for step in steps]
        return self.at(best)


@dataclass(frozen=True, eq=False)
class _Restricted:
    """Restricted likelihood of the angle's residual, as a function of the noise's spectrum.

    The residual's coefficients (n,), columns (P, n) of the free parameters and of the priors on them (P, M), the
    priors' own residual (M,), the rows in use, and the spectrum of a noise over the coefficients.
    """

    coefficients: Array
    columns: Array
    priors: Array
    prior_residual: Array
    rows: int
    spectrum: Callable[[Noise], Array]

    @classmethod
    def of(cls, fit: Fit) -> _Restricted:
        """Columns are of unit length; those of parameters that change nothing are left out."""
        columns = np.concatenate([fit.cosine_jacobian[:, 0], fit.prior_jacobian], axis=1)
        length = np.linalg.norm(columns, axis=1, keepdims=True)
        columns = columns[length[:, 0] > 0.0] / length[length[:, 0] > 0.0]
        c = fit.cosine_residual[0]
        own, priors = columns[:, : c.size], columns[:, c.size :]
        return cls(c, own, priors, fit.prior_residual, fit.rows, fit.observations.spectrum)

    def cost(self, noise: Noise) -> float:
        """Minus the log likelihood of the spectrum, the noise's variance at its best."""
        shape = self.spectrum(noise)
        left, log_det = self._left(shape)
        dof = self.rows - len(self.columns)
        return 0.5 * (dof * float(np.log(max(left, 1e-300))) + log_determinant(shape, self.rows) + log_det)

    def rms(self, noise: Noise) -> float:
        """The RMS at its best: what the free parameters have taken out of the residual is put back."""
        left, _ = self._left(self.spectrum(noise))
        return float(np.sqrt(max(left, 0.0) / (self.rows + self.prior_residual.size - len(self.columns))))

    def _left(self, shape: Array) -> tuple[float, float]:
        """Whitened squares that the parameters leave, and the log determinant of their information."""
        c = self.coefficients
        weighted = self.columns / shape
        gram = weighted @ self.columns.T + self.priors @ self.priors.T + 1e-12 * np.eye(len(self.columns))
        along = weighted @ c + self.priors @ self.prior_residual
        total = float(np.sum(c * c / shape)) + float(self.prior_residual @ self.prior_residual)
        _, log_det = np.linalg.slogdet(gram)
        return total - float(along @ np.linalg.solve(gram, along)), float(log_det)
