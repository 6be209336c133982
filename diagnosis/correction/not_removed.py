"""What a table of the reading alone cannot take off of a twin's errors: by direction, temperature, speed, and noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.correction.compensation import correction_of, settled_turn
from twin.angles import TAU, Array, radians, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.effect import Effect
from twin.motion import RPM, Motion

_KINDS = {
    "speed": {"moving shaft", "two speeds", "varying speed", "speed_rpm"},
    "direction": {"both directions"},
    "temperature": {"temperature_c", "two temperatures"},
    "current": {"two currents"},
    "turn": {"turn", "several turns", "two turns"},
    "time": {"time_s"},
}
"""What a sweep must hold to show it, by what it differs with."""
FAULTS = "faults of the word"
_OF_FOOTPRINT = {"spread": "noise", "values": "steps of the word", "sequence": "single readings"}
_SCATTERED = (*_OF_FOOTPRINT.values(), FAULTS)
"""What is told of single readings, not of their mean."""
GRID = 720
_AWAY_K = 10.0
_SPEED_RPM = 1000.0
_NOTHING_DEG = 1e-6


@dataclass(frozen=True)
class NotRemoved:
    """What stays, by what it differs with, the causes, and by how much [deg]; None where that depends on the motion."""

    what: str
    causes: tuple[str, ...] = ()
    rms_deg: float | None = None
    largest_deg: float | None = None
    at: str = ""


def of_twin(chain: Chain, temperature_c: float, *, seed: int) -> list[NotRemoved]:
    """What of a twin's errors a table made at a temperature [C] leaves."""
    causes: dict[str, list[str]] = {}
    for key, values in chain.values.items():
        effect = find(key, chain.effects)
        if not effect.is_null(values) and (kind := _kind(effect)):
            causes.setdefault(kind, []).append(key)
    found = []
    for kind, keys in causes.items():
        rms, largest, at = _size(chain, kind, temperature_c, seed=seed)
        found.append(NotRemoved(kind, tuple(keys), rms, largest, at))
    return found


def _kind(effect: Effect) -> str:
    """What an effect differs with; "" where it is the same for each reading."""
    needs = {part for need in effect.needs for part in need.split("|")}
    for kind, words in _KINDS.items():
        if needs & words:
            return kind
    if effect.footprint == "sequence" and effect.in_words is not None:
        return FAULTS
    return _OF_FOOTPRINT.get(effect.footprint, "")


def _size(chain: Chain, kind: str, temperature_c: float, *, seed: int) -> tuple[float | None, float | None, str]:
    """RMS and largest size [deg] of what stays, and where it was taken."""
    shaft = TAU * np.arange(GRID) / GRID
    if kind == "direction":
        kept = chain.without(*correction_of(chain, temperature_c=temperature_c).left_out)
        ways = [settled_turn(kept, shaft, way, temperature_c) for way in (1.0, -1.0)]
        return *measured(0.5 * wrap(ways[0] - ways[1])), "half of what the directions differ by"
    if kind == "temperature":
        here, there = (correction_of(chain, temperature_c=temperature_c + away).shaft(shaft) for away in (0.0, _AWAY_K))
        return *measured(wrap(there - here)), f"{_AWAY_K:g} K away from {temperature_c:g} C"
    if kind == "speed":
        others = (key for key in chain.values if _kind(find(key, chain.effects)) not in ("", kind))
        kept, speed = chain.without(*others), np.full(GRID, _SPEED_RPM * RPM)
        turning = kept.readings(Motion.from_angle(shaft, time_s=shaft / speed, speed_rad_s=speed))
        rms, largest = measured(wrap(turning - kept.readings(Motion.from_angle(shaft))))
        # What a varying speed alone makes is nothing at a steady one.
        return (rms, largest, f"at {_SPEED_RPM:g} rpm") if largest > _NOTHING_DEG else (None, None, "")
    if kind in _SCATTERED:
        moving = [key for key in chain.values if _kind(find(key, chain.effects)) not in ("", *_SCATTERED)]
        kept = chain.without(*moving)
        kinds = {key: _kind(find(key, chain.effects)) for key in kept.values}
        one = kept.without(*(key for key, other in kinds.items() if other not in ("", kind)))
        motion = Motion.from_angle(shaft)
        noisy = radians(one.simulate(motion, seed=seed).measured_deg)
        quiet = one.without(*(key for key, other in kinds.items() if other == kind)).readings(motion)
        return *measured(wrap(noisy - quiet)), ""
    return None, None, ""


def measured(away_rad: Array) -> tuple[float, float]:
    """RMS and largest size [deg]."""
    away = np.degrees(away_rad)
    return float(np.sqrt(np.mean(away**2))), float(np.max(np.abs(away)))
