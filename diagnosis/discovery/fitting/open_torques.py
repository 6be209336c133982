"""How far torques that the speeds do not tell from the sensor may have put the parameters of a fit."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from diagnosis.discovery.fitting.coefficients import observables_to_cosine
from diagnosis.discovery.fitting.joint_fit import Fit, root_weights
from diagnosis.discovery.fitting.nuisance import without_nuisance
from diagnosis.discovery.fitting.observations import Observations
from diagnosis.spin.torques import as_large_as_seen
from twin.angles import Array, wrap


@lru_cache(maxsize=4)
def shifts(fit: Fit) -> Array:
    """By how much (P, m) each torque of one standard deviation moves the free parameters, in their own units.

    A fit gives to the sensor what is seen of an order that the log's speeds leave open. Beforehand a torque is as
    likely to have made it: as large as all that is seen of that order, in either phase. None (P, 0) where no order is
    open, or a reference was recorded.
    """
    turned = _turned(fit.observations)
    if not len(turned) or not fit.free:
        return np.zeros((len(fit.free), 0))
    _, jacobian = fit.whitened()
    root = root_weights(fit.weighting, fit.observations.observables)
    torques = (turned * root).reshape(len(turned), root.size)
    scale = np.linalg.norm(jacobian, axis=1)
    scale[scale == 0.0] = 1.0
    unit = jacobian / scale[:, None]
    along = unit[:, : torques.shape[1]] @ torques.T
    return np.asarray(np.linalg.pinv(unit @ unit.T, rcond=1e-12, hermitian=True) @ along / scale[:, None])


def _turned(observations: Observations) -> Array:
    """What the torques make of the cosine coefficients (m, O, n) of readings."""
    off = wrap(observations.measured - observations.motion.shaft_rad)
    columns = as_large_as_seen(observations.motion, off, observations.usable)
    both = np.zeros((len(columns), observations.observables, len(observations)))
    both[:, 0] = columns
    return observables_to_cosine(observations, without_nuisance(observations, both))
