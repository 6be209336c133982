"""Numbers of an answer to seven digits, as plain Python has them."""

from __future__ import annotations

from typing import Any

import numpy as np


def rounded(value: Any) -> Any:
    """An answer with each float at seven digits, None where it is not finite, and lists in the place of tuples."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(item) for item in value]
    if isinstance(value, float | np.floating):
        number = float(value)
        return float(f"{number:.7g}") if np.isfinite(number) else None
    if isinstance(value, np.integer):
        return int(value)
    return value
