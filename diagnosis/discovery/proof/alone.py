"""Each recording of a device alone: what the parameters that are common to all cost it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.free_parameters import ZERO_ANGLE
from diagnosis.discovery.fitting.joint_fit import Fit, evaluate, solve
from diagnosis.discovery.fitting.own_zeros import owner, zero_of
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import wrap_deg
from twin.baseline import FACTORS
from twin.effect import BoolArray

_SIGMA = 4.0
"""Standard deviations by which a factor must be off in one recording to be named: of dozens of figures one in 10^4."""


@dataclass(frozen=True, eq=False)
class Alone:
    """One recording: its RMS [deg] with the common parameters and with parameters of its own, fewer readings for more.

    ``zero_deg`` is its zero in the common fit. ``differ`` holds the factors of the error model that stand elsewhere in
    it: value in it alone, value common to all, in their own units; empty where its own parameters gain nothing.
    """

    common_deg: float
    own_deg: float
    zero_deg: float
    differ: dict[str, tuple[float, float]]

    @property
    def ratio(self) -> float:
        """How many times larger the RMS is with the common parameters."""
        return self.common_deg / max(self.own_deg, 1e-12)


def each_alone(fit: Fit, settings: DiscoverySettings) -> tuple[Alone, ...]:
    """Fit the causes found to each recording by itself; nothing of a single recording."""
    recordings = fit.observations.motion.recordings
    if recordings is None:
        return ()
    return tuple(_alone(fit, number, settings) for number in range(len(recordings)))


def _alone(fit: Fit, number: int, settings: DiscoverySettings) -> Alone:
    """One recording fitted by itself, from the common fit."""
    recordings = fit.observations.motion.recordings
    assert recordings is not None
    here = fit.observations.usable & (recordings.number == number)
    free = tuple(one for one in fit.free if owner(one, fit.observations.motion) in (None, number))
    own = solve(evaluate(fit.chain, free, fit.observations.masked(here), fit.weighting))
    common_deg = _rms_deg(fit, here, len(fit.free) / len(recordings))
    own_deg = _rms_deg(own, here, len(free))
    zero = sum(
        float(values[ZERO_ANGLE.name])
        for key, values in fit.chain.values.items()
        if key == ZERO_ANGLE.key or zero_of(key) == number
    )
    apart = common_deg > settings.shared_ratio * own_deg
    return Alone(common_deg, own_deg, float(wrap_deg(zero)), _differing(fit, own) if apart else {})


def _rms_deg(fit: Fit, rows: BoolArray, parameters: float) -> float:
    """RMS [deg] over these rows (n,), less the degrees of freedom that parameters have taken."""
    squares = float(np.sum(fit.residual[0][rows] ** 2))
    return float(np.degrees(np.sqrt(squares / max(np.count_nonzero(rows) - parameters, 1.0))))


def _differing(fit: Fit, own: Fit) -> dict[str, tuple[float, float]]:
    """The factors that stand elsewhere in the recording alone, beyond their scatter: its value, the common one."""
    covariance = own.covariance()
    found = {}
    for factor in FACTORS:
        places = [k for k, one in enumerate(own.free) if (one.key, one.name) == (factor.key, factor.param)]
        if not places or (factor.key, factor.param) == (ZERO_ANGLE.key, ZERO_ANGLE.name):
            continue
        one, common = (float(chain.values[factor.key][factor.param]) for chain in (own.chain, fit.chain))
        sigma = float(np.sqrt(max(covariance[places[0], places[0]], 0.0)))
        if np.isfinite(sigma) and abs(one - common) > _SIGMA * sigma:
            found[factor.name] = (one * factor.scale, common * factor.scale)
    return found
