"""The 95 % interval of the length of a vector of two numbers, right down to length zero."""

from __future__ import annotations

import numpy as np

from twin.confidence import Z95


def modulus_interval(length: float, error: float) -> tuple[float, float]:
    """Limits of the true length where one of this length was found, with this standard error along each axis.

    The square of a found length, in standard errors, is noncentral chi-squared with two degrees of freedom (Rice): the
    limits are the true lengths that put it at the upper and the lower 2.5 %. A length that is compatible with none
    starts at 0; its upper limit is never below that of a found length of one standard error.
    """
    from scipy.special import chndtr, chndtrinc

    if error <= 0.0:
        return length, length
    square = (length / error) ** 2
    if square > 1e4:
        # Far out Rice's distribution is the normal one, and its inverse loses digits.
        return length - Z95 * error, length + Z95 * error
    none = float(chndtr(square, 2.0, 0.0))
    low = float(chndtrinc(square, 2.0, 0.975)) if none > 0.975 else 0.0
    high = float(chndtrinc(max(square, 1.0), 2.0, 0.025))
    return error * float(np.sqrt(low)), error * float(np.sqrt(high))
