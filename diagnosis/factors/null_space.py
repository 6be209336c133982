"""Which combinations of the paper's unknowns no angle can show: the null space of its error model."""

from __future__ import annotations

import numpy as np

from diagnosis.error_model.model import BETA, GAIN, QUAD, VX, VY, ZERO
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
    out[BETA, column["beta"]] = out[ZERO, column["zero"]] = 1.0
    return out


def invisible_count(point: Array) -> int:
    """How many combinations of the paper's ten unknowns no angle can show, whatever the readings."""
    jacobian = paper_jacobian(point)
    scale = np.linalg.norm(jacobian, axis=0)
    return len(PAPER_NAMES) - int(np.linalg.matrix_rank(jacobian / np.where(scale > 0, scale, 1.0), tol=1e-8))
