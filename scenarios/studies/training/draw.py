"""What a training sweep holds: causes, their strengths and parameters, drawn for many sweeps at once.

Each sweep brings one row of uniform numbers, so that what is drawn for it depends on its own stream alone. Strengths
are in degrees of angle error, about its amplitude: an effect's ``typical`` is the size that makes 0.1 deg.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from twin.angles import Array
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.effect import BoolArray, Effect
from twin.motion import Motion

YARDSTICK_DEG = 0.1
CAUSE_UNIFORMS = 4
"""Uniform numbers for a cause's parameters: the most that any needs."""
BASELINE_UNIFORMS = 6
_SPLIT = (0.8, 0.9)
"""Shares of a million sweeps below which a sweep is for training, then for validation; the rest is for testing."""
_FULL_SCALE_PERCENT = 250.0
"""Codes of the converter span this many percent of the nominal amplitude (twin.adc.adc_quantisation)."""
BASELINE_SPREAD = {
    "offset.x_percent": 1.0,
    "offset.y_percent": 1.0,
    "gain_mismatch.ratio": 0.01,
    "phase.beta_deg": 0.2,
    "quadratic_nonlinearity.q_percent": 0.3,
    "zero.zero_deg": 180.0,
}
"""Half width of the uniform draw around the twin's own value; about what devices of the paper's Table 2 show."""

Drawn = dict[str, dict[str, Array]]
Special = Callable[[Array, Array, Motion], dict[str, Array]]
"""strength [deg] (k,), uniform numbers (k, 4), motion -> parameters (k,)."""


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """What is drawn from: strengths and noise [deg] log-uniform, up to ``most`` causes a sweep."""

    strength_deg: tuple[float, float] = (0.02, 0.3)
    noise_deg: tuple[float, float] = (0.003, 0.05)
    most: int = 3


@dataclass(frozen=True, eq=False)
class Draw:
    """Parameters of ``batch`` sweeps by effect, each (batch,); which causes act (batch, causes) and how strongly."""

    values: Drawn
    labels: BoolArray
    strength_deg: Array
    noise_deg: Array
    split: Array


def uniforms_needed(causes: tuple[str, ...]) -> int:
    """Length of a sweep's row of uniform numbers."""
    return 3 + BASELINE_UNIFORMS + len(causes) * (2 + CAUSE_UNIFORMS)


def drawable(motion: Motion) -> tuple[str, ...]:
    """Causes that this motion can show, by name, in chain order."""
    provided = motion.provides
    return tuple(
        effect.name
        for effect in CATALOGUE
        if not effect.baseline and effect.stage != "empirical" and effect.visible_in(provided)
    )


def draw(uniforms: Array, base: Chain, causes: tuple[str, ...], motion: Motion, ranges: Ranges) -> Draw:
    """Turn rows of uniform numbers (batch, :func:`uniforms_needed`) into sweeps around a twin."""
    batch, count = len(uniforms), len(causes)
    head, rest = uniforms[:, : 3 + BASELINE_UNIFORMS], uniforms[:, 3 + BASELINE_UNIFORMS :]
    noise = _log_uniform(head[:, 0], ranges.noise_deg)
    how_many = np.floor(head[:, 1] * (min(ranges.most, count) + 1))
    order, strength_u = rest[:, :count], rest[:, count : 2 * count]
    labels = np.argsort(np.argsort(order, axis=1), axis=1) < how_many[:, None]
    strength = np.where(labels, _log_uniform(strength_u, ranges.strength_deg), 0.0)
    values = baseline_values(head[:, 3:], base)
    values["noise"] = {"rms_deg": noise}
    own = rest[:, 2 * count :].reshape(batch, count, CAUSE_UNIFORMS)
    for column, name in enumerate(causes):
        rows = labels[:, column]
        effect = find(name)
        kept = {**effect.null(), **base.values.get(name, {})}
        params = {key: np.full(batch, value, dtype=np.float64) for key, value in kept.items() if key != "zeros_deg"}
        for key, drawn in parameters_of(effect, strength[rows, column], own[rows, column], motion).items():
            params[key][rows] = drawn
        values[name] = params
    return Draw(values, labels, strength, noise, np.searchsorted(_SPLIT, head[:, 2], side="right").astype(np.float64))


def stripped(twin: Chain, causes: tuple[str, ...]) -> Chain:
    """The twin without causes of its own, so that a label says all; its words and iterations stay as they are."""
    return twin.without(*(name for name in causes if find(name).footprint != "values"))


def baseline_values(uniforms: Array, base: Chain) -> Drawn:
    """The paper's error factors (batch,) around the twin's, from uniform numbers (batch, 6)."""
    out: Drawn = {}
    for column, (key, half) in enumerate(BASELINE_SPREAD.items()):
        name, param = key.split(".")
        effect = find(name)
        centre = float({**effect.null(), **base.values.get(name, {})}[param])
        out.setdefault(name, {})[param] = centre + half * (2.0 * uniforms[:, column] - 1.0)
    return out


def _log_uniform(u: Array, bounds: tuple[float, float]) -> Array:
    low, high = bounds
    return np.asarray(low * (high / low) ** u)


# ---- one cause's parameters ------------------------------------------------------------------------------------------


def parameters_of(effect: Effect, strength: Array, u: Array, motion: Motion) -> Mapping[str, Array]:
    """A cause's parameters (k,) for strengths [deg] (k,) and uniform numbers (k, 4)."""
    special = _SPECIAL.get(effect.name)
    return special(strength, u, motion) if special is not None else _generic(effect, strength, u)


def _generic(effect: Effect, strength: Array, u: Array) -> dict[str, Array]:
    """Strengths by their yardstick, of either sign where the effect has one; two of them share it as a vector does."""
    names = effect.roles("strength")
    turn = 2.0 * np.pi * u[:, 0]
    shares = (np.cos(turn), np.sin(turn)) if len(names) == 2 else (np.where(u[:, 0] < 0.5, -1.0, 1.0),)
    out = {}
    for name, share in zip(names, shares, strict=True):
        param = effect.params[name]
        signed = share if param.lower < param.null else np.abs(share)
        out[name] = param.null + strength / YARDSTICK_DEG * param.typical * signed
    for name in effect.roles("phase"):
        out[name] = 360.0 * u[:, 1]
    return out


def _span(u: Array, low: float, high: float) -> Array:
    return np.asarray(low + (high - low) * u)


def _whole(u: Array, low: int, high: int) -> Array:
    """Whole numbers from low to high, both included."""
    return np.asarray(np.minimum(np.floor(low + (high - low + 1) * u), high))


def _with(name: str, shape: str, chosen: Callable[[Array, Motion], Array]) -> Special:
    """The generic draw and one shape parameter from the third uniform number."""

    def special(strength: Array, u: Array, motion: Motion) -> dict[str, Array]:
        return {**_generic(find(name), strength, u), shape: chosen(u[:, 2], motion)}

    return special


def _delay(strength: Array, u: Array, motion: Motion) -> dict[str, Array]:
    """The delay in which the fastest shaft turns by the strength, of either sign."""
    fastest = float(np.max(np.abs(motion.speed_rad_s)))
    return {"delay_us": 1e6 * np.radians(strength) / fastest * np.where(u[:, 0] < 0.5, -1.0, 1.0)}


def _slip(strength: Array, u: Array, motion: Motion) -> dict[str, Array]:
    start, end = motion.time_s[0], motion.time_s[-1]
    return {**_generic(find("index_slip"), strength, u), "time_s": start + (end - start) * _span(u[:, 2], 0.2, 0.8)}


def _mains(strength: Array, u: Array, motion: Motion) -> dict[str, Array]:
    nominal = np.where(u[:, 2] < 0.5, 50.0, 60.0)
    return {**_generic(find("mains_pickup"), strength, u), "frequency_Hz": nominal * _span(u[:, 3], 0.995, 1.005)}


def _ripple(strength: Array, u: Array, motion: Motion) -> dict[str, Array]:
    """A ripple that the time stamps resolve, and the delay at which its effect on the angle is largest."""
    interval = float(np.median(np.diff(motion.time_s)))
    frequency = _log_uniform(u[:, 2], (2.0 / (motion.time_s[-1] - motion.time_s[0]), 0.4 / interval))
    return {
        "frequency_Hz": frequency,
        "amplitude_percent": strength / YARDSTICK_DEG * find("reference_ripple").params["amplitude_percent"].typical,
        "delay_us": np.minimum(0.5e6 / frequency, 1e6),
        "phase_deg": 360.0 * u[:, 1],
    }


def _stuck(strength: Array, u: Array, motion: Motion) -> dict[str, Array]:
    """A bit of weight w errs by up to w / 2 in each channel: 0.1 deg is 0.35 % of the amplitude."""
    weight = 0.35 * strength / YARDSTICK_DEG
    return {
        "step_percent": _FULL_SCALE_PERCENT * 2.0 ** np.round(np.log2(weight / _FULL_SCALE_PERCENT)),
        "level": np.where(u[:, 0] < 0.5, 0.0, 1.0),
    }


def _truncated(strength: Array, u: Array, motion: Motion) -> dict[str, Array]:
    """n iterations leave up to atan 2^-(n-1), evenly spread."""
    return {"iterations": np.clip(np.round(1.0 - np.log2(np.sqrt(3.0) * np.radians(strength))), 5, 14)}


_SPECIAL: dict[str, Special] = {
    "bearing_wobble": _with("bearing_wobble", "order", lambda u, m: _span(u, 0.3, 0.5)),
    "zero_drift": _with(
        "zero_drift", "time_constant_s", lambda u, m: float(np.ptp(m.time_s)) * _log_uniform(u, (0.1, 2))
    ),
    "magnet_harmonic": _with("magnet_harmonic", "order", lambda u, m: _whole(u, 3, 8)),
    "hysteresis": _with("hysteresis", "memory_deg", lambda u, m: _log_uniform(u, (2.0, 30.0))),
    "drive_ripple": _with(
        "drive_ripple", "order", lambda u, m: _whole(u, 20, max(20, int(m.points_per_turn) // 2 - 1))
    ),
    "xy_skew": _delay,
    "latency": _delay,
    "index_slip": _slip,
    "mains_pickup": _mains,
    "reference_ripple": _ripple,
    "adc_stuck_bit": _stuck,
    "cordic_truncation": _truncated,
    # c - L lost near an axis turns the angle by up to about 0.5 (1 - L)^1.5: the yardstick is 2 %.
    "clipping": lambda s, u, m: {"level_percent": 100.0 - 2.0 * (s / YARDSTICK_DEG) ** (2.0 / 3.0)},
    # e = sin 2a / 2 times the difference of two draws: RMS 0.5 p.
    "reference_jitter": lambda s, u, m: {"percent_rms": 200.0 * np.radians(s)},
    # A word's rounding has the RMS step / sqrt 12.
    "output_quantisation": lambda s, u, m: {"bits": np.round(np.log2(360.0 / (np.sqrt(12.0) * s)))},
    "reference_rezero": lambda s, u, m: {"spread_deg": s},
    "stale_frames": lambda s, u, m: {"fraction_percent": _span(u[:, 0], 1.0, 10.0)},
    "bus_glitch": lambda s, u, m: {"count": _whole(u[:, 0], 1, 6)},
}
