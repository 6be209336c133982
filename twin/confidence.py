"""How far an interval reaches, of estimates whose scatter is normal and known, or told by a number of readings."""

from __future__ import annotations

import math
from collections.abc import Sequence

Z95 = 1.959964
"""Standard deviations on either side that hold 95 % of a normal distribution."""
OF_MAD = 1.4826
"""Standard deviation of a normal distribution over the median of how far its values are from the middle."""


def student_95(freedom: float) -> float:
    """Half width of a 95 % interval in standard errors that so many degrees of freedom tell: Student's t."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))


def mixed_95(told: Sequence[tuple[float, float, float, float]]) -> tuple[float, float]:
    """Ends between which a figure lies with 95 % where one of several explanations is true.

    ``told`` are, for each explanation, how likely it is against the others, the figure's value by it, and the ends of
    its 95 % interval. On either side of the value the figure is taken to scatter normally.
    """
    from scipy.optimize import brentq
    from scipy.special import ndtr

    total = sum(likely for likely, _, _, _ in told)
    ways = [end for _, _, low, high in told for end in (low, high) if math.isfinite(end)]
    least, most = min(ways, default=-math.inf), max(ways, default=math.inf)
    # Where an improbable explanation has no end, the others' is a little farther out.
    least, most = least - (most - least), most + (most - least)

    def below(at: float, share: float) -> float:
        found = 0.0
        for likely, value, low, high in told:
            reach = (value - low if at < value else high - value) / Z95
            found += likely * float(ndtr((at - value) / reach)) if reach > 0.0 else likely * float(at >= value)
        return found / total - share

    def end(share: float, beyond: float) -> float:
        if below(least, share) < 0.0 < below(most, share):
            return float(brentq(below, least, most, args=(share,)))
        return beyond

    return end(0.025, min(low for _, _, low, _ in told)), end(0.975, max(high for _, _, _, high in told))
