"""Heat: laws of the plates, chips that lag the chamber, warming after switch-on, frames that expand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..baseline import Setting
from ..channel_causes import Channels
from ..motion import Array, Motion
from .device import Mechanism
from .kind import Planned


def lagged(temperature_c: Array, time_s: Array, constant_s: float) -> Array:
    """A body behind its surroundings by a first-order lag, exact for steps; settled at the first reading."""
    out = np.empty_like(temperature_c)
    out[0] = temperature_c[0]
    keep = np.exp(-np.diff(time_s) / constant_s)
    for row, share in enumerate(keep, start=1):
        out[row] = temperature_c[row] + share * (out[row - 1] - temperature_c[row])
    return out


def _farthest(setting: Setting) -> float:
    return float(np.max(np.abs(setting.motion.warmth)))


def _offset(rng: np.random.Generator, size_deg: float, law: Callable[[Motion], Array]) -> Planned:
    """An offset on both channels, in some direction, by a law of which 1 is the largest value."""
    towards, size = float(rng.uniform(0.0, 2 * np.pi)), float(np.radians(size_deg))

    def electric(channels: Channels, motion: Motion) -> Channels:
        share = size * law(motion)
        return channels[0] + np.cos(towards) * share, channels[1] + np.sin(towards) * share

    return Planned(Mechanism(electric=electric), size_deg)


def lagging_offset(rng: np.random.Generator, setting: Setting) -> Planned:
    """The offset follows the chip, which is half a minute behind the chamber."""
    far, constant = _farthest(setting), float(rng.uniform(10.0, 40.0))
    law = lambda motion: (lagged(motion.temperature_c, motion.time_s, constant) - 25.0) / far  # noqa: E731
    return _offset(rng, float(rng.uniform(0.15, 0.4)), law)


def curved_offset(rng: np.random.Generator, setting: Setting) -> Planned:
    """An offset that bends with temperature, as a diode's."""
    far, bend = _farthest(setting), float(rng.uniform(0.1, 0.4))
    law = lambda motion: motion.warmth / far + bend * (motion.warmth / far) ** 2  # noqa: E731
    return _offset(rng, float(rng.uniform(0.15, 0.4)), law)


def self_heating(rng: np.random.Generator, setting: Setting) -> Planned:
    """Switched on with the first reading, the chip warms up, its offset with it."""
    constant = float(np.ptp(setting.motion.time_s)) * float(rng.uniform(0.1, 0.4))
    law = lambda motion: -np.expm1(-(motion.time_s - motion.time_s[0]) / constant)  # noqa: E731
    return _offset(rng, float(rng.uniform(0.15, 0.4)), law)


def mobility(rng: np.random.Generator, setting: Setting) -> Planned:
    """The two plates' sensitivities fall with different powers of the absolute temperature."""
    far = _farthest(setting)
    power = float(rng.choice((-1, 1)) * np.radians(rng.uniform(0.15, 0.4)) * 2 / np.log1p(far / 298.15))

    def electric(channels: Channels, motion: Motion) -> Channels:
        return channels[0], channels[1] * ((motion.temperature_c + 273.15) / 298.15) ** power

    return Planned(Mechanism(electric=electric), 0.25)


def turned_plate(rng: np.random.Generator, setting: Setting) -> Planned:
    """Stress of the package turns one plate's axis with temperature."""
    slope = float(rng.choice((-1, 1)) * rng.uniform(0.15, 0.4)) / _farthest(setting)

    def axes(field: Channels, motion: Motion) -> Channels:
        turned = np.radians(slope * motion.warmth)
        return field[0], field[1] * np.cos(turned) + field[0] * np.sin(turned)

    return Planned(Mechanism(axes=axes), 0.25, {"phase_drift": {"deg_per_K": slope}})


def expanding_frame(rng: np.random.Generator, setting: Setting) -> Planned:
    """The frame that holds the sensor expands and turns it, in proportion to temperature."""
    slope = float(rng.choice((-1, 1)) * rng.uniform(0.1, 0.3)) / _farthest(setting)
    acts = Mechanism(shaft=lambda at, motion: at + slope * motion.warmth)
    return Planned(acts, 0.2, {"thermal_zero_shift": {"deg_per_K": slope}})


def creeping_frame(rng: np.random.Generator, setting: Setting) -> Planned:
    """The frame relaxes after it was clamped: fast first, then slower."""
    size = float(rng.choice((-1, 1)) * rng.uniform(0.1, 0.3))
    constant = float(np.ptp(setting.motion.time_s)) * float(rng.uniform(0.2, 0.5))

    def shaft(at: Array, motion: Motion) -> Array:
        return at - size * np.expm1(-(motion.time_s - motion.time_s[0]) / constant)

    return Planned(
        Mechanism(shaft=shaft), abs(size), {"zero_drift": {"amplitude_deg": size, "time_constant_s": constant}}
    )
