"""Causes on the two channels: Hall elements and converter.

`plan_*` settles the parameters for a strength; the other functions change x and y, shape (n,) each,
nominal amplitude 1. Drifts are linear in T - 25 C.
"""

from __future__ import annotations

import numpy as np

from .baseline import Baseline, Injected, Setting
from .motion import Array, Motion

Channels = tuple[Array, Array]


def _warmest(setting: Setting) -> float:
    """Largest |T - 25 C| of the sweep."""
    return float(np.max(np.abs(setting.motion.warmth)))


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice((-1.0, 1.0)))


# --- what the y channel sees besides a: extra phase in degrees ------------------------------------


def plan_phase_drift(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the extra phase at the temperature farthest from 25 C."""
    return Injected("phase_drift", strength, {"deg_per_K": _sign(rng) * strength / _warmest(setting)})


def phase_drift(motion: Motion, baseline: Baseline, injected: Injected) -> Array:
    """beta linear in temperature."""
    return injected.parameters["deg_per_K"] * motion.warmth


def plan_xy_skew(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the extra phase at the highest speed; y after x where the delay is positive."""
    fastest = float(np.max(np.abs(setting.motion.speed_deg_s)))
    return Injected("xy_skew", strength, {"delay_us": _sign(rng) * 1e6 * strength / fastest})


def xy_skew(motion: Motion, baseline: Baseline, injected: Injected) -> Array:
    """The field has turned on by the time y is sampled."""
    return baseline.sense * motion.speed_deg_s * injected.parameters["delay_us"] * 1e-6


# --- the response of a channel to the field component on it --------------------------------------


def plan_saturation(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """c - k c^3 leaves an order 4 of amplitude k / 4."""
    return Injected("saturation", strength, {"k_percent": 400.0 * np.radians(strength)})


def saturation(component: Array, injected: Injected) -> Array:
    """The concentrator's cubic."""
    return component - 0.01 * injected.parameters["k_percent"] * component**3


# --- the Hall elements and their amplifiers -------------------------------------------------------


def plan_gain_drift(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """A ratio off by g leaves an order 2 of amplitude g / 2; strength: that at the farthest temperature."""
    slope = 200.0 * np.radians(strength) / _warmest(setting)
    return Injected("gain_drift", strength, {"percent_per_K": _sign(rng) * slope})


def gain_drift(channels: Channels, motion: Motion, injected: Injected) -> Channels:
    """Ay/Ax linear in temperature."""
    x, y = channels
    return x, y * (1.0 + 0.01 * injected.parameters["percent_per_K"] * motion.warmth)


def plan_offset_drift(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: order 1 at the temperature farthest from 25 C."""
    slope = 100.0 * np.radians(strength) / _warmest(setting)
    towards = rng.uniform(0.0, 2 * np.pi)
    return Injected(
        "offset_drift",
        strength,
        {"x_percent_per_K": float(slope * np.cos(towards)), "y_percent_per_K": float(slope * np.sin(towards))},
    )


def offset_drift(channels: Channels, motion: Motion, injected: Injected) -> Channels:
    """Vx and Vy linear in temperature."""
    x, y = channels
    warmth = 0.01 * motion.warmth
    return (
        x + injected.parameters["x_percent_per_K"] * warmth,
        y + injected.parameters["y_percent_per_K"] * warmth,
    )


def plan_mains_pickup(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: sqrt(2) times the RMS in the angle; 50 or 60 Hz within 1 %."""
    frequency = float(rng.choice((50.0, 60.0)) * rng.uniform(0.992, 1.008))
    share = rng.uniform(0.0, 2 * np.pi)
    size = 100.0 * np.sqrt(2.0) * np.radians(strength)
    return Injected(
        "mains_pickup",
        strength,
        {
            "frequency_Hz": frequency,
            "x_percent": float(size * np.cos(share)),
            "y_percent": float(size * np.sin(share)),
            "phase_deg": float(rng.uniform(-180.0, 180.0)),
        },
    )


def mains_pickup(channels: Channels, motion: Motion, injected: Injected) -> Channels:
    """The same hum on both channels, in different amounts."""
    given = injected.parameters
    hum = np.cos(2 * np.pi * given["frequency_Hz"] * motion.time_s + np.radians(given["phase_deg"]))
    return channels[0] + 0.01 * given["x_percent"] * hum, channels[1] + 0.01 * given["y_percent"] * hum


# --- the converter ---------------------------------------------------------------------------------


def plan_reference_ripple(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: sqrt(2) times the RMS in the angle; a frequency that the time stamps resolve."""
    motion = setting.motion
    top = min(400.0, 0.35 / motion.finest_step_s)
    while True:
        frequency = float(np.exp(rng.uniform(np.log(15.0), np.log(max(top, 20.0)))))
        speeds = np.unique(np.abs(motion.speed_rpm))
        cycles = frequency * 60.0 / speeds
        # at a single speed a whole number of cycles a turn would be an order, and nothing else
        if len(speeds) > 1 or np.abs(cycles - np.round(cycles)).min() > 0.25:
            break
    delay_s = float(rng.uniform(0.03, 0.2)) / frequency
    # sin 2a / 2 times a difference of two cosines of amplitude A: 2 A sin(pi f delay)
    size = np.sqrt(2.0) * np.radians(strength) / np.sin(np.pi * frequency * delay_s)
    return Injected(
        "reference_ripple",
        strength,
        {
            "frequency_Hz": frequency,
            "amplitude_percent": float(100.0 * size),
            "delay_us": 1e6 * delay_s,
            "phase_deg": float(rng.uniform(-180.0, 180.0)),
        },
    )


def reference_ripple(channels: Channels, motion: Motion, injected: Injected) -> Channels:
    """Each channel is scaled by what the ripple is when it is converted, x first."""
    given = injected.parameters
    size = 0.01 * given["amplitude_percent"]
    turn = 2 * np.pi * given["frequency_Hz"]
    phase = np.radians(given["phase_deg"])
    later = motion.time_s + given["delay_us"] * 1e-6
    return (
        channels[0] * (1.0 + size * np.cos(turn * motion.time_s + phase)),
        channels[1] * (1.0 + size * np.cos(turn * later + phase)),
    )


def plan_reference_jitter(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Independent noise p on x and y leaves p / 2 RMS in the angle over a turn; strength: sqrt(2) times that."""
    size = np.sqrt(2.0) * np.radians(strength)
    rows = len(setting.motion.time_s)
    return Injected(
        "reference_jitter",
        strength,
        {"percent_rms": float(100.0 * size)},
        {"x": rng.standard_normal(rows), "y": rng.standard_normal(rows)},
    )


def reference_jitter(channels: Channels, motion: Motion, injected: Injected) -> Channels:
    """White noise in the scale of every conversion."""
    size = 0.01 * injected.parameters["percent_rms"]
    return (
        channels[0] * (1.0 + size * injected.hidden["x"]),
        channels[1] * (1.0 + size * injected.hidden["y"]),
    )


def plan_clipping(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the largest of the spots."""
    own = setting.baseline
    angle = np.linspace(0.0, 2 * np.pi, 2880, endpoint=False)
    x = own.offset_x + own.amplitude_x * (np.cos(angle) + own.quadratic * np.cos(angle) ** 2)
    sine = np.sin(angle + np.radians(own.phase_deg))
    y = own.offset_y + own.amplitude_y * (sine + own.quadratic * sine**2)
    free = x + 1j * y
    low, high = 0.5, float(max(np.abs(x).max(), np.abs(y).max()))
    for _ in range(40):
        level = 0.5 * (low + high)
        cut = np.clip(x, -level, level) + 1j * np.clip(y, -level, level)
        worst = np.degrees(np.abs(np.angle(cut * np.conj(free)))).max()
        low, high = (low, level) if worst < strength else (level, high)
    return Injected("clipping", strength, {"level_percent": 100.0 * level})


def clipping(channels: Channels, motion: Motion, injected: Injected) -> Channels:
    """Neither channel exceeds +-L."""
    level = 0.01 * injected.parameters["level_percent"]
    return np.clip(channels[0], -level, level), np.clip(channels[1], -level, level)


def plan_adc_stuck_bit(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """0 or one step in each channel is step / sqrt(2) in the angle (as sqrt(2) times the RMS)."""
    step = np.sqrt(2.0) * np.radians(strength)
    # the range is 2^above steps; full scale between 1.25 and 2.5 holds the signal with room to spare
    above = int(np.ceil(np.log2(2.5 / step)))
    word = int(rng.choice((14, 16)))
    return Injected(
        "adc_stuck_bit",
        strength,
        {
            "bit": float(word - above),
            "level": float(rng.integers(0, 2)),
            "step_percent": float(100.0 * step),
        },
        {"bits": np.array([float(word)]), "full_scale": np.array([step * 2.0 ** (above - 1)])},
    )


def adc_stuck_bit(channels: Channels, motion: Motion, injected: Injected) -> Channels:
    """One bit of the offset-binary code reads the same always."""
    word, full_scale = injected.hidden["bits"][0], injected.hidden["full_scale"][0]
    mask = 1 << int(injected.parameters["bit"])
    high = bool(injected.parameters["level"])

    def convert(channel: Array) -> Array:
        lsb = 2.0 * full_scale / 2.0**word
        code = np.clip(np.round((channel + full_scale) / lsb), 0, 2.0**word - 1).astype(np.int64)
        stuck = code | mask if high else code & ~mask
        level: Array = stuck * lsb - full_scale
        return level

    return convert(channels[0]), convert(channels[1])
