"""What a study of spins asks the tool: an answer, a correction, and the orders that it says stay open."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from diagnosis import explain
from diagnosis.correction.compensation import correction_of

Array = npt.NDArray[np.float64]


def explained(
    paths: Sequence[str], *, budget_s: float = float("inf")
) -> tuple[Mapping[str, Any], Callable[[Array], Array], frozenset[int]]:
    """The JSON answer to the logs of a device, what its extended twin makes of a reading [deg], orders left open."""
    found = explain(paths[0] if len(paths) == 1 else list(paths), budget_s=budget_s)
    correction = correction_of(found.extended)
    answer = found.to_dict()
    return answer, lambda reading_deg: np.degrees(correction.shaft(np.radians(reading_deg))), open_orders(answer)


def open_orders(answer: Mapping[str, Any]) -> frozenset[int]:
    """Orders that an answer gives to the sensor or to the torque, as one likes: one speed cannot tell."""
    told = (answer.get("motion") or {}).get("not_separable", [])
    return frozenset(int(entry["order"] if isinstance(entry, Mapping) else entry) for entry in told)
