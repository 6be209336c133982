"""The leading signatures of the effects: the angle error [rad] (n,) to leading order in the strengths.

From first principles and not from the code under test: with x += dx and y += dy the angle turns by cos a dy - sin a dx.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from twin.angles import TAU, Array
from twin.motion import Motion

Params = Mapping[str, float]


def rad(value: float) -> float:
    return float(np.radians(value))


def shift(motion: Motion, dx: Array | float, dy: Array | float) -> Array:
    """Angle error of small additions to the channels."""
    a = motion.shaft_rad
    return np.asarray(np.cos(a) * dy - np.sin(a) * dx)


def line(motion: Motion, p: Params, order: float, sign: float = 1.0, weight: Array | float = 1.0) -> Array:
    wave = np.sin(order * motion.shaft_rad + rad(p["phase_deg"]))
    return np.asarray(sign * rad(p["amplitude_deg"]) * weight * wave)


def middle(motion: Motion) -> Array:
    """Time from the middle of the record [s]."""
    return np.asarray(motion.time_s - 0.5 * (motion.time_s[0] + motion.time_s[-1]))


def mains(motion: Motion, p: Params) -> Array:
    wave = 0.01 * np.cos(TAU * p["frequency_Hz"] * middle(motion) + rad(p["phase_deg"]))
    return shift(motion, p["x_percent"] * wave, p["y_percent"] * wave)


def ripple(motion: Motion, p: Params) -> Array:
    phase = TAU * p["frequency_Hz"] * middle(motion) + rad(p["phase_deg"])
    lag = TAU * p["frequency_Hz"] * 1e-6 * p["delay_us"]
    difference = np.cos(phase + lag) - np.cos(phase)
    return np.asarray(0.5 * np.sin(2.0 * motion.shaft_rad) * 0.01 * p["amplitude_percent"] * difference)


def clipping(motion: Motion, p: Params) -> Array:
    level = 0.01 * p["level_percent"]
    lost = [
        -np.sign(c) * np.maximum(np.abs(c) - level, 0.0) for c in (np.cos(motion.shaft_rad), np.sin(motion.shaft_rad))
    ]
    return shift(motion, lost[0], lost[1])


def stuck(motion: Motion, p: Params) -> Array:
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


def creep(motion: Motion, p: Params) -> Array:
    """An offset, seen from the angle, that settles from the first reading on."""
    grown = (1.0 - np.exp(-(motion.time_s - motion.time_s[0]) / 3.0)) / (1.0 - np.exp(-8.0 / 3.0))
    return np.asarray(rad(p["amplitude_deg"]) * grown * np.sin(rad(p["phase_deg"]) - motion.shaft_rad))


def stepper(motion: Motion, p: Params) -> Array:
    """A two-phase stepper with p electrical periods a turn and a constant current too much in each phase.

    The rotor stands along the vector of both currents; p times the amplitude is what they are off, over their own.
    """
    commanded, off = p["order"] * motion.shaft_rad, p["order"] * rad(p["amplitude_deg"])
    one = np.cos(commanded) - off * np.cos(rad(p["phase_deg"]))
    other = np.sin(commanded) + off * np.sin(rad(p["phase_deg"]))
    return np.asarray(np.angle((one + 1j * other) * np.exp(-1j * commanded)) / p["order"])


def motor(motion: Motion, p: Params) -> Array:
    """A field fixed in the stator: of the current, and of what drag draws at so many thousand rpm."""
    krpm = motion.speed_rad_s * 60.0 / (2.0 * np.pi) / 1000.0

    def along(axis: str) -> Array:
        mT = p[f"{axis}_mT_per_A"] * motion.current_a + p[f"{axis}_mT_per_krpm"] * krpm
        return np.asarray(mT / p["field_mT"])

    return shift(motion, along("bx"), along("by"))


def of_counts(motion: Motion, p: Params) -> Array:
    """A reference that reads whole counts: what it has dropped or added, the sensor reads more or less."""
    counted = motion.shaft_rad * p["counts_per_turn"] / (2.0 * np.pi)
    return -rad(p["step_deg"]) * (np.floor(counted + 0.5) - counted)


def of_periods(motion: Motion, p: Params) -> Array:
    """Offset, gain and phase as in a sensor of one period, at p times the angle and over p."""
    a = p["periods"] * motion.shaft_rad
    turned = 0.01 * (np.cos(a) * p["y_percent"] - np.sin(a) * p["x_percent"])
    turned = turned + 0.5 * (p["ratio"] - 1.0) * np.sin(2.0 * a) + rad(p["beta_deg"]) * np.cos(a) ** 2
    return np.asarray(turned / p["periods"])


def lag(motion: Motion, p: Params) -> Array:
    """Steady lag, relaxing exponentially from the last reading before each reversal."""
    out = -rad(p["lag_deg"]) * motion.direction
    path = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(motion.shaft_rad)))])
    for row in np.flatnonzero(np.diff(motion.direction)):
        after = slice(row + 1, None)
        out[after] += (out[row] - out[row + 1]) * np.exp(-(path[after] - path[row]) / rad(p["memory_deg"]))
    return out


def play(motion: Motion, p: Params) -> Array:
    """Half the dead zone against the direction; right after a reversal at the same angle still on the other side."""
    half = rad(p["half_width_deg"])
    out = -half * motion.direction
    turned = np.flatnonzero(np.diff(motion.direction)) + 1
    resting = turned[np.isclose(motion.shaft_rad[turned], motion.shaft_rad[turned - 1])]
    out[resting] *= -1.0
    return out


def inl(motion: Motion, p: Params) -> Array:
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


def misaligned(motion: Motion, p: Params) -> Array:
    """Second order of the cylinder's field about its axis, with r = d / R and S(u) = u / sqrt(1 + u^2):

    f, g = t1 + 9 t2, t1 + 3 t2 up to a common factor; t1 = S(u+) - S(u-), t2 = r^2/8 (S(u+)/(1+u+^2)^2 - ...).
    """
    radius, height, gap = 3.0, 2.5, 1.5
    u = np.array([gap + height, gap]) / radius
    s = u / np.sqrt(1.0 + u**2)
    t1, t2 = s[0] - s[1], (s[0] / (1 + u[0] ** 2) ** 2 - s[1] / (1 + u[1] ** 2) ** 2) / 8.0
    curvature = 3.0 * t2 / t1 * (p["off_axis_mm"] / radius) ** 2
    twice = 2.0 * (motion.shaft_rad - rad(p["direction_deg"]))
    return np.asarray(-curvature * np.sin(twice))


def drift(motion: Motion, p: Params) -> Array:
    elapsed, tau = motion.time_s - motion.time_s[0], p["time_constant_s"]
    return np.asarray(rad(p["amplitude_deg"]) * (1 - np.exp(-elapsed / tau)) / (1 - np.exp(-elapsed[-1] / tau)))


def warm(motion: Motion) -> Array:
    return motion.temperature_c - 25.0


def tone(motion: Motion, p: Params) -> Array:
    """A vector that turns f times a second, carried on from reading to reading; mid-record it stands at the phase."""
    on = np.exp(1j * TAU * p["frequency_Hz"] * np.diff(motion.time_s))
    vector = np.concatenate([[1.0], np.cumprod(on)])
    halfway = np.exp(1j * np.pi * p["frequency_Hz"] * np.ptp(motion.time_s))
    return np.asarray(rad(p["amplitude_deg"]) * (vector / halfway * np.exp(1j * rad(p["phase_deg"]))).real)


def modes(motion: Motion, p: Params) -> Array:
    share = (motion.time_s - motion.time_s[0]) / np.ptp(motion.time_s)
    return np.asarray(sum(rad(p[f"mode{k}_deg"]) * np.cos(np.pi * k * share) for k in range(1, 5)))


def over_flanks(motion: Motion, p: Params) -> Array:
    lever = np.sin(motion.shaft_rad - rad(p["centre_deg"])) / np.sin(rad(p["width_deg"]))
    return rad(p["height_deg"]) * (1.0 - 2.0 / (np.exp(2.0 * lever) + 1.0))


def bump(motion: Motion, p: Params) -> Array:
    away = (np.degrees(motion.shaft_rad) - p["centre_deg"] + 180.0) % 360.0 - 180.0
    return np.asarray(rad(p["height_deg"]) * np.exp(-0.5 * (away / p["width_deg"]) ** 2))


def turned(motion: Motion) -> Array:
    """Shaft angle within the turn [rad]."""
    return np.asarray(np.mod(motion.shaft_rad, TAU))


def zone(motion: Motion, p: Params) -> Array:
    """The way to the lower edge of a dead zone, from where it jumps on to the upper one."""
    width, inside = rad(p["width_deg"]), np.mod(motion.shaft_rad - rad(p["start_deg"]), TAU)
    to_edge = np.where(inside < 0.01 * p["jump_percent"] * width, -inside, width - inside)
    return np.where(inside < width, to_edge, 0.0)


def seam(motion: Motion, p: Params) -> Array:
    """A vector that turns from half a turn before the place to half a turn behind it, as an angle."""
    opposite = np.angle(np.exp(1j * (motion.shaft_rad - rad(p["centre_deg"]) - np.pi)))
    return np.asarray(-rad(p["step_deg"]) * opposite / TAU)


def twist(motion: Motion, p: Params) -> Array:
    """Of a shaft behind a motor: against what it accelerates, and with the torque of its current."""
    krpm_s = motion.acceleration_rad_s2 * 30.0 / (1000.0 * np.pi)
    return np.asarray(rad(p["deg_per_A"]) * motion.current_a - rad(p["deg_per_krpm_per_s"]) * krpm_s)
