"""How far an interval reaches, of estimates whose scatter is normal and known, or told by a number of readings."""

from __future__ import annotations

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
    least, most = min(low for _, _, low, _ in told), max(high for _, _, _, high in told)

    def below(at: float, share: float) -> float:
        found = 0.0
        for likely, value, low, high in told:
            reach = (value - low if at < value else high - value) / Z95
            found += likely * float(ndtr((at - value) / reach)) if reach > 0.0 else likely * float(at >= value)
        return found / total - share

    ends = []
    for share in (0.025, 0.975):
        inside = below(least, share) < 0.0 < below(most, share)
        ends.append(float(brentq(below, least, most, args=(share,))) if inside else (least, most)[share > 0.5])
    return ends[0], ends[1]
