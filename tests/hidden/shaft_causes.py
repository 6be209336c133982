"""Causes that turn an angle into an angle: the bench, the mechanics, the magnet, the concentrator, the reference.

`plan_*` settles the parameters for a strength; the other functions apply them to angles in degrees,
shape (n,). Signs: e = m - r, so what the sensor's side gains, e gains.
"""

from __future__ import annotations

import numpy as np

from .baseline import Injected, Setting
from .motion import Array, Motion


def _line(angle_deg: Array, order: float, injected: Injected) -> Array:
    """amplitude sin(order angle + phase)."""
    phase = np.radians(injected.parameters["phase_deg"])
    wave: Array = np.sin(order * np.radians(angle_deg) + phase)
    return injected.parameters["amplitude_deg"] * wave


def _any_phase(rng: np.random.Generator) -> float:
    return float(rng.uniform(-180.0, 180.0))


# --- the time at which the angle is taken -------------------------------------------------------


def plan_latency(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: lag at the highest speed."""
    fastest = float(np.max(np.abs(setting.motion.speed_deg_s)))
    return Injected("latency", strength, {"delay_us": 1e6 * strength / fastest})


def latency(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """The reading shows where the shaft was."""
    return shaft - motion.speed_deg_s * injected.parameters["delay_us"] * 1e-6


def plan_time_jitter(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: sqrt(2) times the RMS over all readings."""
    speed = setting.motion.speed_deg_s
    size = strength / np.sqrt(2.0) / float(np.sqrt(np.mean(speed**2)))
    return Injected("time_jitter", strength, {"rms_us": 1e6 * size}, {"late": rng.standard_normal(len(speed))})


def time_jitter(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """The reading shows where the shaft was a moment before or after."""
    return shaft + motion.speed_deg_s * 1e-6 * injected.parameters["rms_us"] * injected.hidden["late"]


# --- mechanics ----------------------------------------------------------------------------------


def plan_drive_ripple(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """A line at a motor order, and its double where the points can show it."""
    points = setting.motion.points_per_turn
    motors = [24, 30, 36, 42, 48, 50, 54, 60, 66, 72, 100]
    order = float(rng.choice([one for one in motors if 2.3 * one < points]))
    double = 0.0 if 4.3 * order > points else float(rng.uniform(0.2, 0.4))
    return Injected(
        "drive_ripple",
        strength,
        {"order": order, "amplitude_deg": strength, "phase_deg": _any_phase(rng)},
        {"double": np.array([double]), "double_phase_deg": np.array([_any_phase(rng)])},
    )


def drive_ripple(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """The sensor's shaft runs ahead and behind of where the drive put it."""
    order = injected.parameters["order"]
    second = np.sin(2 * order * np.radians(shaft) + np.radians(injected.hidden["double_phase_deg"]))
    ripple = injected.parameters["amplitude_deg"] * injected.hidden["double"] * second
    return shaft + _line(shaft, order, injected) + ripple


def plan_cardan_coupling(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the amplitude."""
    return Injected("cardan_coupling", strength, {"amplitude_deg": strength, "phase_deg": _any_phase(rng)})


def cardan_coupling(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """An angled joint: twice a turn."""
    return shaft + _line(shaft, 2.0, injected)


def plan_backlash(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: half the play."""
    return Injected("backlash", strength, {"half_width_deg": strength})


def backlash(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """Play of total width 2b: the driven side moves only when pushed."""
    half = injected.parameters["half_width_deg"]
    driven = np.empty_like(shaft)
    at = float(shaft[0] - half * motion.direction[0])
    for row, pusher in enumerate(shaft.tolist()):
        at = min(max(at, pusher - half), pusher + half)
        driven[row] = at
    return driven


def plan_bearing_wobble(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """A cage order."""
    order = float(rng.uniform(0.32, 0.48))
    return Injected(
        "bearing_wobble",
        strength,
        {"order": order, "amplitude_deg": strength, "phase_deg": _any_phase(rng)},
    )


def bearing_wobble(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """Motion at less than half an order; the phase is that at the first reading."""
    return shaft + _line(shaft - shaft[0], injected.parameters["order"], injected)


def plan_zero_drift(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Covers one to two strengths during the sweep, for the zero takes the mean.

    A linear drift has no time_constant_s; its amplitude_deg is what it has covered at the end.
    """
    duration = float(np.ptp(setting.motion.time_s))
    covered = strength * float(rng.choice((-1.0, 1.0)) * rng.uniform(1.0, 2.0))
    if rng.random() < 0.35:
        return Injected("zero_drift", strength, {"amplitude_deg": covered})
    constant = duration * float(rng.uniform(0.12, 0.6))
    final = covered / (1 - np.exp(-duration / constant))
    return Injected("zero_drift", strength, {"amplitude_deg": float(final), "time_constant_s": constant})


def zero_drift(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """First order in time towards amplitude_deg, or linear and there at the end."""
    since = motion.time_s - motion.time_s[0]
    constant = injected.parameters.get("time_constant_s")
    share: Array = since / since[-1] if constant is None else -np.expm1(-since / constant)
    return shaft + injected.parameters["amplitude_deg"] * share


# --- magnet and concentrator --------------------------------------------------------------------


def plan_magnet_harmonic(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """One integer order of 3 to 8."""
    order = float(rng.integers(3, 9))
    return Injected(
        "magnet_harmonic",
        strength,
        {"order": order, "amplitude_deg": strength, "phase_deg": _any_phase(rng)},
    )


def magnet_harmonic(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """A higher azimuthal order of the magnetisation."""
    return shaft + _line(shaft, injected.parameters["order"], injected)


def plan_hysteresis(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the steady lag."""
    memory = float(np.exp(rng.uniform(np.log(3.0), np.log(20.0))))
    return Injected("hysteresis", strength, {"lag_deg": strength, "memory_deg": memory})


def hysteresis(shaft: Array, motion: Motion, injected: Injected) -> Array:
    """The lag moves towards -d h exponentially in the travel of the shaft; steady at the first row."""
    wanted = -motion.direction * injected.parameters["lag_deg"]
    keep = np.exp(-np.abs(motion.travel_deg) / injected.parameters["memory_deg"])
    lag = np.empty_like(shaft)
    at = float(wanted[0])
    for row, (towards, share) in enumerate(zip(wanted.tolist(), keep.tolist(), strict=True)):
        at = towards + (at - towards) * share
        lag[row] = at
    return shaft + lag


# --- the reference, apart from the chain: these return what is added to its reading -------------


def plan_reference_eccentricity(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: the amplitude."""
    return Injected("reference_eccentricity", strength, {"amplitude_deg": strength, "phase_deg": _any_phase(rng)})


def reference_eccentricity(motion: Motion, injected: Injected) -> Array:
    """The reference's disc off its centre."""
    return _line(motion.shaft_deg, 1.0, injected)


def plan_reference_rezero(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """Strength: standard deviation of the zeros of the turns, made exactly so."""
    zeros = rng.standard_normal(setting.motion.turns)
    zeros -= zeros.mean()
    zeros *= strength / zeros.std()
    return Injected("reference_rezero", strength, {"spread_deg": strength}, {"zero_deg": zeros})


def reference_rezero(motion: Motion, injected: Injected) -> Array:
    """An incremental reference whose zero is made anew each turn."""
    return injected.hidden["zero_deg"][motion.turn]


def plan_index_slip(rng: np.random.Generator, strength: float, setting: Setting) -> Injected:
    """A step in e of one to one and a half strengths, in the middle seven tenths of the rows."""
    rows = len(setting.motion.time_s)
    row = int(rng.integers(int(0.15 * rows), int(0.85 * rows)))
    step = strength * float(rng.choice((-1.0, 1.0)) * rng.uniform(1.0, 1.5))
    time = setting.motion.time_s
    return Injected(
        "index_slip",
        strength,
        {"step_deg": step, "time_s": float(0.5 * (time[row - 1] + time[row]))},
    )


def index_slip(motion: Motion, injected: Injected) -> Array:
    """The reference's zero jumps once; step_deg is the step in e, so the reference goes the other way."""
    after = motion.time_s > injected.parameters["time_s"]
    return np.where(after, -injected.parameters["step_deg"], 0.0)
