"""Further measurements: what would part each cause from those that explain the same readings as well."""

from __future__ import annotations

from dataclasses import replace

from diagnosis.discovery.further.power import options
from diagnosis.discovery.state import State


def further_measurements(state: State) -> State:
    """Simulate the menu of further measurements for every cause that has rivals."""
    return state.with_(causes=tuple(replace(cause, options=options(state.fit, cause.rivals)) for cause in state.causes))
