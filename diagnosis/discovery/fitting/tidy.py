"""One of the equivalent ways to write a chain down: amplitudes above zero, phases within a turn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from diagnosis.discovery.fitting.free_parameters import ZERO_ANGLE
from twin.catalogue import find
from twin.chain import Chain


def tidy(chain: Chain) -> Chain:
    """Amplitudes made positive, phases and zeros brought to (-180, 180]; the very chain where they are so already."""
    values = {key: dict(params) for key, params in chain.values.items()}
    for key, params in values.items():
        effect = find(key, chain.effects)
        phases = effect.roles("phase")
        for name in effect.roles("strength"):
            if phases and float(params.get(name, 0.0)) < 0.0 and name == effect.roles("strength")[0]:
                # The first strength is positive by convention; half a turn of the phase turns all of them.
                for turned in effect.roles("strength"):
                    params[turned] = -float(params[turned])
                params[phases[0]] = float(params[phases[0]]) + 180.0
        for name in (*phases, *((ZERO_ANGLE.name,) if key == ZERO_ANGLE.key else ())):
            angle = float(params[name])
            if not -180.0 < angle <= 180.0:
                # One that is within stays as it is, to its last digit.
                params[name] = float(-((-angle + 180.0) % 360.0 - 180.0))
    return chain if all(_same(values[key], chain.values[key]) for key in values) else replace(chain, values=values)


def _same(params: Mapping[str, Any], others: Mapping[str, Any]) -> bool:
    """Whether every parameter is the very object of the others'."""
    return all(value is others[name] for name, value in params.items())
