"""How far an interval reaches, of estimates whose scatter is normal and known, or told by a number of readings."""

from __future__ import annotations

Z95 = 1.959964
"""Standard deviations on either side that hold 95 % of a normal distribution."""
OF_MAD = 1.4826
"""Standard deviation of a normal distribution over the median of how far its values are from the middle."""


def student_95(freedom: float) -> float:
    """Half width of a 95 % interval in standard errors that so many degrees of freedom tell: Student's t."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))
