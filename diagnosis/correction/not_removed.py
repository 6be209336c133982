"""What a table of the reading alone cannot take off: what differs by direction, temperature, speed, turn, and noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.correction.compensation import Correction, correction_of, settled_turn
from diagnosis.thermal.recording import Recording
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
_OF_FOOTPRINT = {"spread": "noise", "values": "steps of the word", "sequence": "single readings"}
_GRID = 720
_AWAY_K = 10.0
_SPEED_RPM = 1000.0
_NOTHING_DEG = 1e-6
_BINS = 36


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
    return _OF_FOOTPRINT.get(effect.footprint, "")


def _size(chain: Chain, kind: str, temperature_c: float, *, seed: int) -> tuple[float | None, float | None, str]:
    """RMS and largest size [deg] of what stays, and where it was taken."""
    shaft = TAU * np.arange(_GRID) / _GRID
    if kind == "direction":
        kept = chain.without(*correction_of(chain, temperature_c=temperature_c).left_out)
        ways = [settled_turn(kept, shaft, way, temperature_c) for way in (1.0, -1.0)]
        return *_measured(0.5 * wrap(ways[0] - ways[1])), "half of what the directions differ by"
    if kind == "temperature":
        here, there = (correction_of(chain, temperature_c=temperature_c + away).shaft(shaft) for away in (0.0, _AWAY_K))
        return *_measured(wrap(there - here)), f"{_AWAY_K:g} K away from {temperature_c:g} C"
    if kind == "speed":
        others = (key for key in chain.values if _kind(find(key, chain.effects)) not in ("", kind))
        kept, speed = chain.without(*others), np.full(_GRID, _SPEED_RPM * RPM)
        turning = kept.readings(Motion.from_angle(shaft, time_s=shaft / speed, speed_rad_s=speed))
        rms, largest = _measured(wrap(turning - kept.readings(Motion.from_angle(shaft))))
        # What a varying speed alone makes is nothing at a steady one.
        return (rms, largest, f"at {_SPEED_RPM:g} rpm") if largest > _NOTHING_DEG else (None, None, "")
    if kind in _OF_FOOTPRINT.values():
        moving = [key for key in chain.values if _kind(find(key, chain.effects)) not in ("", *_OF_FOOTPRINT.values())]
        kept = chain.without(*moving)
        kinds = {key: _kind(find(key, chain.effects)) for key in kept.values}
        one = kept.without(*(key for key, other in kinds.items() if other not in ("", kind)))
        motion = Motion.from_angle(shaft)
        noisy = radians(one.simulate(motion, seed=seed).measured_deg)
        quiet = one.without(*(key for key, other in kinds.items() if other == kind)).readings(motion)
        return *_measured(wrap(noisy - quiet)), ""
    return None, None, ""


def of_readings(
    recording: Recording, error_rad: Array, correction: Correction, temperature_c: float
) -> list[NotRemoved]:
    """What of the errors of readings a table made at a temperature [C] leaves; ``error_rad`` (n,) with the table."""
    scatter = _measured(error_rad)[0]
    apart = _between_directions(recording, error_rad)
    rest = float(np.sqrt(max(scatter**2 - (apart or 0.0) ** 2, 0.0)))
    left = [] if apart is None else [NotRemoved("direction", rms_deg=apart, at="half of what the directions differ by")]
    if correction.drift is not None:
        grid = TAU * np.arange(_GRID) / _GRID
        here = correction.shaft(grid, temperature_c)
        ends = (correction.drift.low_c, correction.drift.high_c)
        moved = [wrap(correction.shaft(grid, end) - here) for end in ends]
        rms, largest = _measured(max(moved, key=lambda away: float(np.max(np.abs(away)))))
        left.append(NotRemoved("temperature", (), rms, largest, f"between {ends[0]:.1f} and {ends[1]:.1f} C"))
        return left
    return [*left, NotRemoved("noise", rms_deg=rest, at="and all else that the angle does not tell")]


def _between_directions(recording: Recording, error_rad: Array) -> float | None:
    """RMS [deg] of half of what the errors (n,) of both directions differ by over the turn, less what is noise.

    None where there is one direction alone.
    """
    place = (np.mod(recording.reference_rad, TAU) / TAU * _BINS).astype(np.int64) % _BINS
    means, variances = [], []
    for way in (recording.direction > 0, recording.direction < 0):
        count = np.bincount(place[way], minlength=_BINS)
        if np.count_nonzero(count > 1) < _BINS // 2:
            return None
        many = np.maximum(count, 1)
        mean = np.bincount(place[way], weights=error_rad[way], minlength=_BINS) / many
        away = np.bincount(place[way], weights=(error_rad[way] - mean[place[way]]) ** 2, minlength=_BINS)
        means.append(np.where(count > 1, mean, np.nan))
        variances.append(away / np.maximum(count - 1, 1) / many)
    half = 0.5 * (means[0] - means[1])
    noise = 0.25 * (variances[0] + variances[1])[np.isfinite(half)]
    square = float(np.nanmean(half**2) - np.mean(noise))
    return float(np.degrees(np.sqrt(max(square, 0.0))))


def _measured(away_rad: Array) -> tuple[float, float]:
    """RMS and largest size [deg]."""
    away = np.degrees(away_rad)
    return float(np.sqrt(np.mean(away**2))), float(np.max(np.abs(away)))
