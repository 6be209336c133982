"""One step of a damped least-squares fit: within the bounds of its parameters, and the damping of the next one.

Levenberg-Marquardt with the damping of Nielsen: K. Madsen, H. B. Nielsen and O. Tingleff, Methods for Non-Linear Least
Squares Problems, 2nd ed. (2004), section 3.2.
"""

from __future__ import annotations

import numpy as np

from twin.angles import Array


def step_within(system: Array, gradient: Array, lower: Array, upper: Array) -> Array:
    """The step (P,) that solves ``system @ step = gradient`` as far as bounds on it allow.

    A parameter that would pass its bound is held there, and the others are solved for anew: with their steps left as
    they were, they would go on making up for a move that does not take place.

    Parameters
    ----------
    system : numpy.ndarray, shape (P, P)
        Normal matrix, symmetric and positive definite.
    gradient : numpy.ndarray, shape (P,)
        Right-hand side.
    lower, upper : numpy.ndarray, shape (P,)
        What a step may be at least and at most; ``lower <= 0 <= upper``.

    Returns
    -------
    numpy.ndarray, shape (P,)
        The step.
    """
    step = np.zeros(gradient.size)
    free = np.ones(gradient.size, dtype=bool)
    while free.any():
        rest = gradient[free] - system[np.ix_(free, ~free)] @ step[~free]
        step[free] = np.linalg.solve(system[np.ix_(free, free)], rest)
        within = np.clip(step, lower, upper)
        beyond = free & (within != step)
        if not beyond.any():
            break
        step, free = within, free & ~beyond
    return step


def eased(share: float) -> float:
    """What becomes of the damping behind a step that gained this share, maybe beyond all bounds, of the expected."""
    return max(1.0 / 3.0, 1.0 - (2.0 * min(max(share, 0.0), 1.0) - 1.0) ** 3)
