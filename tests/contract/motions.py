"""The one motion on which every effect of the catalogue can be seen."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from scenarios.protocol import Protocol
from twin.motion import Motion


def full_motion(points: int = 120) -> Motion:
    """Two turns in both directions at two speeds and two temperatures, everything recorded."""
    return Protocol(
        turns=2,
        points=points,
        both_directions=True,
        speeds_rpm=(60.0, 300.0),
        temperatures_c=(20.0, 60.0),
    ).motion()


def permuted(motion: Motion, order: np.ndarray) -> Motion:
    """The same readings in another order."""
    arrays = [item.name for item in fields(motion) if item.name != "columns"]
    return replace(motion, **{name: getattr(motion, name)[order] for name in arrays})
