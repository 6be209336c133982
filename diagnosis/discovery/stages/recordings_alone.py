"""Recordings alone: what the common parameters cost each recording of a device."""

from __future__ import annotations

from diagnosis.discovery.proof.alone import each_alone
from diagnosis.discovery.state import State


def recordings_alone(state: State) -> State:
    """Fit the causes found to each recording by itself: where that is much closer, the device is not the same."""
    alone = each_alone(state.fit, state.settings)
    return state.with_(alone=alone) if alone else state
