"""One table: for every effect an example of its parameters, its leading signature, and what it remembers.

A signature gives the angle error [rad] (n,) to leading order in the strengths, from first principles and not from
the code under test: with x += dx and y += dy the angle turns by cos a dy - sin a dx.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from twin import example
from twin.angles import TAU, Array
from twin.motion import Motion

Params = Mapping[str, float]
Signature = Callable[[Motion, Params], Array]


@dataclass(frozen=True, kw_only=True)
class Example(example.Example):
    """An example of :mod:`twin.example` with the error that it must leave, worked out apart from the code.

    ``kinks``: the effect's slope jumps, so a few readings near the jumps may follow another branch at half the
    strength: the share of the readings for which that is allowed.
    """

    signature: Signature | None
    kinks: float = 0.0


def _rad(value: float) -> float:
    return float(np.radians(value))


def shift(motion: Motion, dx: Array | float, dy: Array | float) -> Array:
    """Angle error of small additions to the channels."""
    a = motion.shaft_rad
    return np.asarray(np.cos(a) * dy - np.sin(a) * dx)


def line(motion: Motion, p: Params, order: float, sign: float = 1.0, weight: Array | float = 1.0) -> Array:
    wave = np.sin(order * motion.shaft_rad + _rad(p["phase_deg"]))
    return np.asarray(sign * _rad(p["amplitude_deg"]) * weight * wave)


def _middle(motion: Motion) -> Array:
    """Time from the middle of the record [s]."""
    return np.asarray(motion.time_s - 0.5 * (motion.time_s[0] + motion.time_s[-1]))


def _mains(motion: Motion, p: Params) -> Array:
    wave = 0.01 * np.cos(TAU * p["frequency_Hz"] * _middle(motion) + _rad(p["phase_deg"]))
    return shift(motion, p["x_percent"] * wave, p["y_percent"] * wave)


def _ripple(motion: Motion, p: Params) -> Array:
    phase = TAU * p["frequency_Hz"] * _middle(motion) + _rad(p["phase_deg"])
    lag = TAU * p["frequency_Hz"] * 1e-6 * p["delay_us"]
    difference = np.cos(phase + lag) - np.cos(phase)
    return np.asarray(0.5 * np.sin(2.0 * motion.shaft_rad) * 0.01 * p["amplitude_percent"] * difference)


def _clipping(motion: Motion, p: Params) -> Array:
    level = 0.01 * p["level_percent"]
    lost = [
        -np.sign(c) * np.maximum(np.abs(c) - level, 0.0) for c in (np.cos(motion.shaft_rad), np.sin(motion.shaft_rad))
    ]
    return shift(motion, lost[0], lost[1])


def _stuck(motion: Motion, p: Params) -> Array:
    """A converter's integer codes with one bit held, as offset binary; the mean of what that adds is in the offset.

    The chain's channels hold that mean already, so the voltage at the converter is less by it.
    """
    below = 20  # bits under the stuck one: the converter's own rounding is a millionth of the step
    step, mean = 0.01 * p["step_percent"], 0.01 * p["step_percent"] * (p["level"] - 0.5)
    lsb, middle = step / 2**below, 1 << (below + 12)
    moved = []
    for volts in (np.cos(motion.shaft_rad) - mean, np.sin(motion.shaft_rad) - mean):
        codes = np.floor(volts / lsb).astype(np.int64) + middle
        held = codes | (1 << below) if p["level"] else codes & ~np.int64(1 << below)
        moved.append((held - middle + 0.5) * lsb - (volts + mean))
    return shift(motion, *moved)


def _creep(motion: Motion, p: Params) -> Array:
    """An offset, seen from the angle, that settles from the first reading on."""
    grown = (1.0 - np.exp(-(motion.time_s - motion.time_s[0]) / 3.0)) / (1.0 - np.exp(-8.0 / 3.0))
    return np.asarray(_rad(p["amplitude_deg"]) * grown * np.sin(_rad(p["phase_deg"]) - motion.shaft_rad))


def _stepper(motion: Motion, p: Params) -> Array:
    """A two-phase stepper with p electrical periods a turn and a constant current too much in each phase.

    The rotor stands along the vector of both currents; p times the amplitude is what they are off, over their own.
    """
    commanded, off = p["order"] * motion.shaft_rad, p["order"] * _rad(p["amplitude_deg"])
    one = np.cos(commanded) - off * np.cos(_rad(p["phase_deg"]))
    other = np.sin(commanded) + off * np.sin(_rad(p["phase_deg"]))
    return np.asarray(np.angle((one + 1j * other) * np.exp(-1j * commanded)) / p["order"])


def _lag(motion: Motion, p: Params) -> Array:
    """Steady lag, relaxing exponentially from the last reading before each reversal."""
    out = -_rad(p["lag_deg"]) * motion.direction
    path = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(motion.shaft_rad)))])
    for row in np.flatnonzero(np.diff(motion.direction)):
        after = slice(row + 1, None)
        out[after] += (out[row] - out[row + 1]) * np.exp(-(path[after] - path[row]) / _rad(p["memory_deg"]))
    return out


def _play(motion: Motion, p: Params) -> Array:
    """Half the dead zone against the direction; right after a reversal at the same angle still on the other side."""
    half = _rad(p["half_width_deg"])
    out = -half * motion.direction
    turned = np.flatnonzero(np.diff(motion.direction)) + 1
    resting = turned[np.isclose(motion.shaft_rad[turned], motion.shaft_rad[turned - 1])]
    out[resting] *= -1.0
    return out


def _inl(motion: Motion, p: Params) -> Array:
    """What the transfer curve adds to both channels, in steps of 14 bit, turned into an angle."""
    full_scale = 0.01 * p["full_scale_percent"]

    def added(channel: Array) -> Array:
        u = channel / full_scale
        # The largest of u - u^3 is 2 / sqrt 27; a bit steps by the error of its weight, the ends stay.
        curve = p["bow_lsb"] * (1.0 - u**2) + p["s_lsb"] * (u - u**3) / (2.0 / np.sqrt(27.0))
        for bit in range(1, 7):
            held = np.floor((u + 1.0) / 2.0 * 2.0**bit) % 2.0
            curve = curve + p[f"bit{bit}_lsb"] * (held - 0.5 - 0.5 * u)
        return np.asarray(full_scale / 2**13 * curve)

    c, s = np.cos(motion.shaft_rad), np.sin(motion.shaft_rad)
    return added(s) * c - added(c) * s


def _misaligned(motion: Motion, p: Params) -> Array:
    """Second order of the cylinder's field about its axis, with r = d / R and S(u) = u / sqrt(1 + u^2):

    f, g = t1 + 9 t2, t1 + 3 t2 up to a common factor; t1 = S(u+) - S(u-), t2 = r^2/8 (S(u+)/(1+u+^2)^2 - ...).
    """
    radius, height, gap = 3.0, 2.5, 1.5
    u = np.array([gap + height, gap]) / radius
    s = u / np.sqrt(1.0 + u**2)
    t1, t2 = s[0] - s[1], (s[0] / (1 + u[0] ** 2) ** 2 - s[1] / (1 + u[1] ** 2) ** 2) / 8.0
    curvature = 3.0 * t2 / t1 * (p["off_axis_mm"] / radius) ** 2
    twice = 2.0 * (motion.shaft_rad - _rad(p["direction_deg"]))
    return np.asarray(-curvature * np.sin(twice))


def _drift(motion: Motion, p: Params) -> Array:
    elapsed, tau = motion.time_s - motion.time_s[0], p["time_constant_s"]
    return np.asarray(_rad(p["amplitude_deg"]) * (1 - np.exp(-elapsed / tau)) / (1 - np.exp(-elapsed[-1] / tau)))


def _warm(motion: Motion) -> Array:
    return motion.temperature_c - 25.0


def _tone(motion: Motion, p: Params) -> Array:
    """A vector that turns f times a second, carried on from reading to reading; mid-record it stands at the phase."""
    on = np.exp(1j * TAU * p["frequency_Hz"] * np.diff(motion.time_s))
    vector = np.concatenate([[1.0], np.cumprod(on)])
    halfway = np.exp(1j * np.pi * p["frequency_Hz"] * np.ptp(motion.time_s))
    return np.asarray(_rad(p["amplitude_deg"]) * (vector / halfway * np.exp(1j * _rad(p["phase_deg"]))).real)


def _modes(motion: Motion, p: Params) -> Array:
    share = (motion.time_s - motion.time_s[0]) / np.ptp(motion.time_s)
    return np.asarray(sum(_rad(p[f"mode{k}_deg"]) * np.cos(np.pi * k * share) for k in range(1, 5)))


def _over_flanks(motion: Motion, p: Params) -> Array:
    lever = np.sin(motion.shaft_rad - _rad(p["centre_deg"])) / np.sin(_rad(p["width_deg"]))
    return _rad(p["height_deg"]) * (1.0 - 2.0 / (np.exp(2.0 * lever) + 1.0))


def _bump(motion: Motion, p: Params) -> Array:
    away = (np.degrees(motion.shaft_rad) - p["centre_deg"] + 180.0) % 360.0 - 180.0
    return np.asarray(_rad(p["height_deg"]) * np.exp(-0.5 * (away / p["width_deg"]) ** 2))


_LINE = {"amplitude_deg": 0.2}
_PHASE = {"phase_deg": 35.0}

EXAMPLES: dict[str, Example] = {
    # mechanics
    "zero": Example(
        strengths={"zero_deg": 3.0}, shapes={}, signature=lambda m, p: np.full(len(m), _rad(p["zero_deg"]))
    ),
    "backlash": Example(strengths={"half_width_deg": 0.1}, shapes={}, signature=_play, memory=True),
    "cardan_coupling": Example(strengths=_LINE, shapes=_PHASE, signature=lambda m, p: line(m, p, 2.0)),
    "bearing_wobble": Example(
        strengths=_LINE, shapes={**_PHASE, "order": 0.41}, signature=lambda m, p: line(m, p, p["order"])
    ),
    "load_torsion": Example(
        strengths={"deg_per_krpm_per_s": 0.2},
        shapes={},
        memory=True,
        signature=lambda m, p: -_rad(p["deg_per_krpm_per_s"]) * m.acceleration_rad_s2 * 30.0 / (1000.0 * np.pi),
    ),
    "thermal_zero_shift": Example(
        strengths={"deg_per_K": 0.004}, shapes={}, signature=lambda m, p: _rad(p["deg_per_K"]) * _warm(m)
    ),
    "zero_drift": Example(strengths={"amplitude_deg": 0.5}, shapes={"time_constant_s": 5.0}, signature=_drift),
    # magnet
    "magnet_harmonic": Example(
        strengths=_LINE, shapes={**_PHASE, "order": 5.0}, signature=lambda m, p: line(m, p, p["order"])
    ),
    "magnet_misalignment": Example(
        strengths={"off_axis_mm": 0.4}, shapes={"direction_deg": 20.0}, signature=_misaligned, power=2
    ),
    "stray_field": Example(
        strengths={"bx_mT": 0.3, "by_mT": -0.2},
        shapes={"field_mT": 60.0},
        signature=lambda m, p: shift(m, p["bx_mT"] / p["field_mT"], p["by_mT"] / p["field_mT"]),
    ),
    # concentrator
    "hysteresis": Example(strengths={"lag_deg": 0.1}, shapes={"memory_deg": 12.0}, signature=_lag, memory=True),
    "saturation": Example(
        strengths={"k_percent": 0.5},
        shapes={},
        signature=lambda m, p: 0.01 * p["k_percent"] * np.sin(4.0 * m.shaft_rad) / 4.0,
    ),
    # hall
    "phase": Example(
        strengths={"beta_deg": 0.2}, shapes={}, signature=lambda m, p: _rad(p["beta_deg"]) * np.cos(m.shaft_rad) ** 2
    ),
    "phase_drift": Example(
        strengths={"deg_per_K": 0.004},
        shapes={},
        signature=lambda m, p: _rad(p["deg_per_K"]) * _warm(m) * np.cos(m.shaft_rad) ** 2,
    ),
    "quadratic_nonlinearity": Example(
        strengths={"q_percent": 0.3},
        shapes={},
        signature=lambda m, p: shift(
            m, 0.01 * p["q_percent"] * np.cos(m.shaft_rad) ** 2, 0.01 * p["q_percent"] * np.sin(m.shaft_rad) ** 2
        ),
    ),
    "offset": Example(
        strengths={"x_percent": 0.3, "y_percent": -0.2},
        shapes={},
        signature=lambda m, p: shift(m, 0.01 * p["x_percent"], 0.01 * p["y_percent"]),
    ),
    "offset_drift": Example(
        strengths={"x_percent_per_K": 0.01, "y_percent_per_K": 0.005},
        shapes={},
        signature=lambda m, p: shift(m, 0.01 * p["x_percent_per_K"] * _warm(m), 0.01 * p["y_percent_per_K"] * _warm(m)),
    ),
    "gain_mismatch": Example(
        strengths={"ratio": 1.004},
        shapes={},
        signature=lambda m, p: shift(m, 0.0, (p["ratio"] - 1) * np.sin(m.shaft_rad)),
    ),
    "gain_drift": Example(
        strengths={"percent_per_K": 0.01},
        shapes={},
        signature=lambda m, p: shift(m, 0.0, 0.01 * p["percent_per_K"] * _warm(m) * np.sin(m.shaft_rad)),
    ),
    "mains_pickup": Example(
        strengths={"x_percent": 0.4, "y_percent": 0.3}, shapes={**_PHASE, "frequency_Hz": 50.2}, signature=_mains
    ),
    "noise": Example(
        strengths={"rms_deg": 0.1},
        shapes={
            "correlation": 0.5,
            "correlated_share": 0.5,
            "flicker_exponent": 1.0,
            "inverse_dof": 0.2,
            "rotating_frame": 1.0,
            "backward_percent": 50.0,
            "percent_per_K": 1.0,
            "percent_per_rpm": 0.1,
            "angle_percent": 50.0,
            "angle_phase_deg": 35.0,
        },
        signature=None,
    ),
    # adc
    "xy_skew": Example(
        strengths={"delay_us": 60.0},
        shapes={},
        signature=lambda m, p: 1e-6 * p["delay_us"] * m.speed_rad_s * np.cos(m.shaft_rad) ** 2,
    ),
    "clipping": Example(
        strengths={"level_percent": 99.0}, shapes={}, signature=_clipping, origin={"level_percent": 100.0}, power=1.5
    ),
    "reference_ripple": Example(
        strengths={"amplitude_percent": 0.4},
        shapes={**_PHASE, "frequency_Hz": 33.0, "delay_us": 4000.0},
        signature=_ripple,
    ),
    "reference_jitter": Example(strengths={"percent_rms": 0.3}, shapes={}, signature=None),
    "adc_stuck_bit": Example(strengths={"step_percent": 0.4}, shapes={"level": 1.0}, signature=_stuck, kinks=0.02),
    "adc_inl": Example(
        strengths={
            **{"bow_lsb": 10.0, "s_lsb": -8.0, "bit1_lsb": 6.0, "bit2_lsb": 5.0},
            **{"bit3_lsb": 7.0, "bit4_lsb": -4.0, "bit5_lsb": 6.0, "bit6_lsb": -5.0},
        },
        shapes={"full_scale_percent": 140.0},
        signature=_inl,
        kinks=0.3,
    ),
    "adc_quantisation": Example(strengths={"bits": 10.0}, shapes={}, signature=None),
    # cordic
    "cordic_truncation": Example(strengths={"iterations": 9.0}, shapes={}, signature=None),
    # link
    "latency": Example(
        strengths={"delay_us": 60.0}, shapes={}, signature=lambda m, p: -1e-6 * p["delay_us"] * m.speed_rad_s
    ),
    "output_quantisation": Example(strengths={"bits": 11.0}, shapes={}, signature=None),
    "stale_frames": Example(strengths={"fraction_percent": 5.0}, shapes={}, signature=None, memory=True),
    "bus_glitch": Example(strengths={"count": 7.0}, shapes={}, signature=None),
    # reference
    "drive_ripple": Example(strengths=_LINE, shapes={**_PHASE, "order": 24.0}, signature=_stepper),
    "reference_eccentricity": Example(strengths=_LINE, shapes=_PHASE, signature=lambda m, p: line(m, p, 1.0, -1.0)),
    "reference_rezero": Example(strengths={"spread_deg": 0.3}, shapes={}, signature=None),
    "index_slip": Example(
        strengths={"step_deg": 0.4},
        shapes={"time_s": 4.0},
        signature=lambda m, p: _rad(p["step_deg"]) * (m.time_s >= p["time_s"]),
    ),
    # empirical
    "unnamed_order": Example(
        strengths=_LINE, shapes={**_PHASE, "order": 11.0}, signature=lambda m, p: line(m, p, p["order"])
    ),
    "unnamed_direction": Example(
        strengths={"sin2_deg": 0.1, "cos3_deg": -0.05},
        shapes={},
        signature=lambda m, p: (
            m.direction
            * (_rad(p["sin2_deg"]) * np.sin(2 * m.shaft_rad) + _rad(p["cos3_deg"]) * np.cos(3 * m.shaft_rad))
        ),
    ),
    "unnamed_direction_order": Example(
        strengths=_LINE,
        shapes={**_PHASE, "order": 7.0},
        signature=lambda m, p: line(m, p, p["order"], weight=m.direction),
    ),
    "unnamed_temperature_order": Example(
        strengths=_LINE,
        shapes={**_PHASE, "order": 9.0, "at_K": 60.0},
        signature=lambda m, p: line(m, p, p["order"], weight=_warm(m) / 60.0),
    ),
    "unnamed_temperature": Example(
        strengths={"cos0_deg": 0.1, "sin4_deg": 0.05},
        shapes={"at_K": 60.0},
        signature=lambda m, p: _warm(m) / 60.0 * (_rad(p["cos0_deg"]) + _rad(p["sin4_deg"]) * np.sin(4 * m.shaft_rad)),
    ),
    "unnamed_speed": Example(
        strengths=_LINE,
        shapes={**_PHASE, "order": 2.0, "power": 1.0, "at_rpm": 600.0},
        signature=lambda m, p: line(m, p, p["order"], weight=m.speed_rad_s / (20.0 * np.pi)),
    ),
    "unnamed_speed_zero": Example(
        strengths={"amplitude_deg": 0.1},
        shapes={"power": 2.0, "at_rpm": 600.0},
        signature=lambda m, p: _rad(p["amplitude_deg"]) * m.speed_rad_s * np.abs(m.speed_rad_s) / (20.0 * np.pi) ** 2,
    ),
    "unnamed_tone": Example(strengths=_LINE, shapes={**_PHASE, "frequency_Hz": 3.0}, signature=_tone),
    "unnamed_drift": Example(
        strengths={"mode1_deg": 0.2, "mode2_deg": -0.1, "mode3_deg": 0.05, "mode4_deg": 0.05},
        shapes={},
        signature=_modes,
    ),
    "unnamed_creep": Example(
        strengths=_LINE,
        shapes={**_PHASE, "time_constant_s": 3.0, "at_s": 8.0},
        signature=_creep,
    ),
    "unnamed_bump": Example(
        strengths={"height_deg": 0.3}, shapes={"centre_deg": 77.0, "width_deg": 12.0}, signature=_bump
    ),
    "unnamed_flanks": Example(
        strengths={"height_deg": 0.1}, shapes={"centre_deg": 77.0, "width_deg": 12.0}, signature=_over_flanks
    ),
    "unnamed_burst": Example(
        strengths={"rms_deg": 0.3}, shapes={"first_row": 40.0, "last_row": 90.0}, signature=None, memory=True
    ),
}
