"""``--band``: Delta E (Eq. 7) as people write it, a number in deg, or the twin whose converters and noise make it."""

from __future__ import annotations

import numpy as np

from diagnosis.error_model.error_band import delta_e_rad
from twin.errors import UserError
from twin.presets import read_twin_or_preset


def band_deg(given: str) -> float:
    """Delta E [deg]. Raises UserError for a twin that cannot be read, or that nothing makes a reading uncertain in."""
    try:
        return float(given.removesuffix("deg"))
    except ValueError:
        pass
    size = float(np.degrees(delta_e_rad(read_twin_or_preset(given))))
    if size == 0.0:
        raise UserError(
            f"band is {given}, a twin without noise, converter, word or CORDIC, whose Delta E is 0; "
            "expected a twin that has one of them, or a number in deg"
        )
    return size
