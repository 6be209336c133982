"""Of estimates that scatter as a normal distribution: how far an interval reaches."""

from __future__ import annotations

Z95 = 1.959964
"""Standard deviations on either side that hold 95 % of a normal distribution."""
