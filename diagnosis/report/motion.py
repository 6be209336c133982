"""A motion that was estimated from the readings: what an answer says of it, and what it leaves open."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.discovery.result import Discovery
from diagnosis.report.sweep_words import speeds_shown
from diagnosis.report.wording import plain
from diagnosis.spin.columns import HIGHEST_ORDER, ORDERS
from twin.angles import TAU, Array
from twin.catalogue import find
from twin.confidence import Z95
from twin.estimated_motion import EstimatedMotion, Torque
from twin.pace import STOP_AND_MEASURE_S, two_speeds_alone
from twin.second_inertia import Tied

TORQUE = "torque_ripple"
"""What a torque locked to the angle is called where a cause may as well be one."""
_FALLS = "what a torque does falls as 1/speed^2"
SECOND_SPEED = f"a log at a second speed, or coasting down: {_FALLS}"
FURTHER_SPEED = f"a log at speeds further apart, or coasting down: {_FALLS}"
IN_TIME = "a log at another speed: a wave that the motor's supply or its drive makes in the torque keeps its frequency"
STAMPS = "time_stamps"
"""What the times of the readings are called where these, told wrong, would make a wave in time."""
USB_FRAMES_HZ = 1000.0
"""At which a full-speed USB asks a device."""
WITHOUT_CURRENT = "a log in which the shaft coasts, the motor's current off: the current makes a torque as well"
THIRD_SPEED = (
    "a log at a third speed, or coasting down: a rotor of one piece answers to a torque by 1/speed^2 at every speed"
)
_OF_SECOND = ("resonance_Hz", "damping_percent", "share_of_the_rotor")
_LONG_MS = 1000.0 * STOP_AND_MEASURE_S
"""Seconds between two readings from which on they are too far apart for milliseconds as well."""
_BEYOND_CHANCE = 4.0
"""Standard deviations from which on a torque is listed: one of sixteen orders, of two components each, passes it by
chance in one log of 200 (16 exp(-8))."""


def motion_answer(found: Discovery) -> dict[str, Any]:
    """What the JSON says of an estimated motion; nothing where a reference was recorded."""
    estimated = found.sweep.estimated
    if estimated is None:
        return {}
    speed = np.abs(found.sweep.motion().speed_rad_s) / TAU
    return {
        "motion": {
            "estimated_from": "readings",
            "turns_per_s": [float(speed.min()), float(speed.max())],
            "reading_every_s": _every_s(found),
            "stretches": len(estimated.lengths),
            "rows_aside": estimated.rows_aside,
            "even_clock": estimated.even_clock,
            "slowest_turns_per_s": _knee_turns_per_s(found),
            "torque_ripple": [_torque(one) for one in _listed(estimated)],
            "not_separable": not_separable(estimated),
            "of_one_piece": _of_one_piece(estimated, speed),
            "second_inertia": None if estimated.second is None else _second_inertia(estimated.second),
            "times_off": [
                one for cause in found.causes if cause.name == "unnamed" for one in _times_off(found.fit, cause.keys)
            ],
        }
    }


def _every_s(found: Discovery) -> float:
    """Usual time from one reading to the next [s]."""
    time = found.sweep.time_s
    assert time is not None
    return float(np.median(np.diff(time)))


def _knee_turns_per_s(found: Discovery) -> float:
    """Frequency below which the motion is freer than the readings are noisy [1/s]."""
    observations = found.fit.observations
    estimated = observations.motion.estimated
    assert estimated is not None
    every_row_s = _every_s(found) * len(found.sweep) / len(observations)
    return float(np.median(estimated.knee_rad)) / every_row_s / TAU


def not_separable(estimated: EstimatedMotion) -> list[int]:
    """Orders whose error is the sensor's or a torque's: the log's speeds do not tell."""
    told = {one.order for one in estimated.torques if one.separable}
    return sorted({one.order for one in estimated.torques} - told)


def _to_part(open_orders: Sequence[int]) -> str:
    """The log that tells torques of these orders from the sensor: of a log at one speed, all orders are open."""
    return FURTHER_SPEED if set(ORDERS) - set(open_orders) else SECOND_SPEED


def _of_one_piece(estimated: EstimatedMotion, speed: Array) -> list[int]:
    """Orders whose torque two speeds tell from the sensor, and no third one checks that it falls as 1/speed^2.

    Where a belt or a coupling resonates at the order's frequency, the rotor answers by more, by less, or the other way.
    """
    open_to_it = estimated.second is None and two_speeds_alone(speed)
    return [one.order for one in _listed(estimated)] if open_to_it else []


def _second_inertia(tied: Tied) -> dict[str, Any]:
    """What a belt or a coupling ties to the rotor, each figure with its interval."""
    away = Z95 * np.sqrt(np.diag(tied.covariance))
    figures = {}
    for name, at, far, scale in zip(_OF_SECOND, tied.logarithms, away, (1.0 / TAU, 100.0, 1.0), strict=True):
        low, value, high = scale * np.exp([at - far, at, at + far])
        figures[name] = {"value": float(value), "low": float(low), "high": float(high)}
    return figures


def _listed(estimated: EstimatedMotion) -> list[Torque]:
    found = {one.order: one for one in estimated.torques if one.separable}
    return [one for one in found.values() if _amplitude(one) > _BEYOND_CHANCE * one.sd_rad_s2]


def _amplitude(torque: Torque) -> float:
    return float(np.hypot(torque.cos_rad_s2, torque.sin_rad_s2))


def _torque(torque: Torque) -> dict[str, Any]:
    amplitude, away = _amplitude(torque), Z95 * torque.sd_rad_s2
    return {
        "order": torque.order,
        "acceleration_rad_s2": amplitude,
        "low": max(amplitude - away, 0.0),
        "high": amplitude + away,
    }


def may_be_torque(found: Discovery, cause: Finding) -> list[tuple[str, str]]:
    """The torque that does what a cause does, where the log's speeds do not tell them apart; else nothing.

    What grows with the motor's current may be the torque that the current makes, at any speed.
    """
    fit, estimated = found.fit, found.sweep.estimated
    if estimated is None:
        return []
    keys = [key for key in cause.keys if key in fit.chain.values]
    effects = {key: find(key, fit.chain.effects) for key in keys}
    if any(need.startswith("two currents") for effect in effects.values() for need in effect.needs):
        return [(TORQUE, WITHOUT_CURRENT)]
    if _in_time(fit, cause):
        return [(TORQUE, IN_TIME), *_may_be_stamps(fit, cause)]
    open_orders = not_separable(estimated)
    if HIGHEST_ORDER in open_orders:
        open_orders += _orders_beyond(fit, keys)
    # What touches single readings, or makes them louder, is no movement of the shaft.
    if not open_orders or not any(effect.footprint in ("mean", "values") for effect in effects.values()):
        return []
    beyond = _beyond(fit, keys, open_orders)
    rows = fit.rows
    # What no torque can do stands out of the noise as any cause has to.
    told = float(np.sum(beyond[fit.observations.usable] ** 2)) / max(fit.variance, 1e-300)
    return [] if told > -2.0 * fit.settings.effect_log_p(rows) else [(TORQUE, _to_part(open_orders))]


def _orders_beyond(fit: Fit, keys: Sequence[str]) -> list[int]:
    """Whole orders of a cause's own waves above those that torques are looked for at.

    Of periods within a turn, as of teeth, also what comes of two of their orders together.
    """
    own: set[int] = set()
    for key in keys:
        effect, values = find(key, fit.chain.effects), fit.chain.values[key]
        if effect.line is not None and effect.line.clock == "shaft":
            own.add(round(float(values[effect.line.param])))
        if effect.comb is not None:
            orders = [round(order) for order in effect.comb.orders(values)]
            own.update(orders, (one + other for one in orders for other in orders))
    return sorted(order for order in own if order > HIGHEST_ORDER)


def _in_time(fit: Fit, cause: Finding) -> bool:
    """Whether a cause is a wave in time that is added to the angle, as a torque of that frequency adds it."""
    return cause.name == "unnamed" and any(_frequency_hz(fit, key) is not None for key in cause.keys)


def _frequency_hz(fit: Fit, key: str) -> float | None:
    """Of a wave in time; at one speed also of an order that is no whole one, which nothing on the shaft has."""
    line, values = find(key, fit.chain.effects).line, fit.chain.values.get(key)
    if line is None or values is None:
        return None
    if line.clock == "time":
        return float(values[line.param])
    order, motion = float(values[line.param]), fit.linear.motion
    if "two speeds" in motion.provides or abs(order - round(order)) * motion.turns < 1.0:
        return None
    return order * float(np.mean(np.abs(motion.speed_rad_s))) / TAU


def _may_be_stamps(fit: Fit, cause: Finding) -> list[tuple[str, str]]:
    """The times of the readings, which told wrong make the strongest wave in time of a cause."""
    waves = _times_off(fit, cause.keys)
    if not waves:
        return []
    off = max(waves, key=lambda one: float(one["off_us"]))
    words = (
        f"times by the clock of what reads the sensor: a wave of {plain(off['off_us'], 2)} us in those told makes this "
        f"one of {plain(1e3 / off['frequency_Hz'], 3)} ms; or a log at another speed, which it then follows"
    )
    return [(STAMPS, words)]


def _times_off(fit: Fit, keys: Sequence[str]) -> list[dict[str, Any]]:
    """Of each wave in time by how much the readings' times would be told wrong at the usual speed, were it theirs.

    And whether it is as frequent as a USB asks for readings, as far as the log resolves frequencies.
    """
    motion, found = fit.linear.motion, []
    usual, resolved = float(np.median(np.abs(motion.speed_rad_s))), 1.0 / float(np.ptp(motion.time_s))
    for key in keys:
        frequency = _frequency_hz(fit, key)
        if frequency is not None:
            amplitude = np.radians(abs(float(fit.chain.values[key]["amplitude_deg"])))
            usb = abs(frequency - USB_FRAMES_HZ) < resolved
            found.append({"frequency_Hz": frequency, "off_us": 1e6 * float(amplitude) / usual, "usb_frames": usb})
    return found


def _beyond(fit: Fit, keys: Sequence[str], orders: Sequence[int]) -> Array:
    """What causes do to the reading (n,) [rad] that waves of these orders cannot."""
    motion = fit.linear.motion
    # Behind the output's rounding a wave is one no longer.
    rounding = (key for key in fit.chain.values if find(key, fit.chain.effects).output_grid and key not in keys)
    smooth = fit.chain.without(*rounding)
    does = smooth.readings(motion) - smooth.without(*keys).readings(motion)
    angle = motion.shaft_rad
    waves = [np.ones_like(angle), *(wave(order * angle) for order in orders for wave in (np.cos, np.sin))]
    basis = np.linalg.qr(np.stack(waves).T)[0]
    does = np.angle(np.exp(1j * does))
    return np.asarray(does - basis @ (basis.T @ does))


def motion_words(answer: Mapping[str, Any]) -> list[str]:
    """The same for a reader, sentence by sentence; none where a reference was recorded."""
    motion = answer.get("motion")
    if motion is None:
        return []
    said = [
        "No reference: the shaft's motion is estimated from the readings together with their errors, at "
        + speeds_shown([60.0 * one for one in motion["turns_per_s"]])
        + (f" in {motion['stretches']} stretches" if motion["stretches"] > 1 else "")
        + (f"; {motion['rows_aside']} rows without an even turning are left out" if motion["rows_aside"] else "")
    ]
    if motion["reading_every_s"] > STOP_AND_MEASURE_S:
        said.append(_far_apart(motion["reading_every_s"]))
    if motion["even_clock"]:
        said.append("The readings are taken to be evenly spaced in time: their stamps are coarser than their spacing")
    if motion["torque_ripple"]:
        listed = ", ".join(
            f"order {one['order']}: {plain(one['acceleration_rad_s2'], 3)} rad/s^2" for one in motion["torque_ripple"]
        )
        said.append(f"Torques locked to the angle, told from the sensor by the speeds: {listed}")
    if motion["second_inertia"] is not None:
        said.append(_not_of_one_piece(motion["second_inertia"]))
    if motion["not_separable"]:
        said.append(
            f"Not told from a torque locked to the angle: orders {_ranges(motion['not_separable'])}. Here all of that "
            f"counts as the sensor's; to part them: {_to_part(motion['not_separable'])}"
        )
    if motion["of_one_piece"]:
        said.append(
            f"Two speeds tell torques of orders {_ranges(motion['of_one_piece'])} from the sensor if the rotor turns "
            "as one piece: where a belt or a coupling resonates with one of them, what it does is taken for an error "
            f"of the sensor; to see it: {THIRD_SPEED}"
        )
    said += [
        f"The wave of {plain(one['frequency_Hz'], 4)} Hz comes as often as the frames of a USB, every 1 ms: it is "
        f"likely made by times of the readings that are told wrong, by up to {plain(one['off_us'], 2)} us, and not by "
        "the sensor"
        for one in motion["times_off"]
        if one["usb_frames"]
    ]
    said.append("Not seen without a reference: the zero, what drifts slower than a turn, and what a reversal leaves")
    return said


def _far_apart(every_s: float) -> str:
    """That readings are far apart for a shaft that spins, and in which unit their times may be instead."""
    unit, column, times = ("milli", "ms", "thousand") if every_s < _LONG_MS else ("micro", "us", "million")
    return (
        f"By their stamps readings are {plain(every_s, 3)} s apart, which is long for a shaft that spins: if these are "
        f"{unit}seconds, its speeds and frequencies are a {times} times as high; "
        f'--columns "time_s=time_s:{column},measured_deg=measured_deg", with the names of the file, reads them so'
    )


def _not_of_one_piece(second: Mapping[str, Any]) -> str:
    resonance, damping, share = (_with_range(second[name]) for name in _OF_SECOND)
    return (
        f"The rotor is not of one piece: a belt or a coupling ties an inertia to it, {share} times the rotor's, which "
        f"resonates at {resonance} Hz, damped by {damping} % of the critical damping; what torques do to the shaft is "
        "worked out with it"
    )


def _with_range(figure: Mapping[str, float]) -> str:
    return f"{plain(figure['value'], 3)} ({plain(figure['low'], 3)} to {plain(figure['high'], 3)})"


def correction_words(estimated: EstimatedMotion | None) -> list[str]:
    """What has to be kept in mind of a correction whose readings had no reference; nothing where they had one."""
    if estimated is None:
        return []
    said = [
        "made without a reference: the error is told against the shaft's own even turning; the zero is free",
    ]
    orders = not_separable(estimated)
    if orders:
        said.append(
            f"caution: orders {_ranges(orders)} of it may be a torque's (cogging, an unbalance, a bearing) in place of "
            f"the sensor's, and would then put a movement of the shaft into the table; to part them: {_to_part(orders)}"
        )
    return said


def judged_words(estimated: EstimatedMotion) -> str:
    """What has to be kept in mind of errors that are told without a reference."""
    orders = not_separable(estimated)
    said = "no reference: the errors are told against the shaft's own even turning"
    return f"{said}, and in orders {_ranges(orders)} with what torques turn it by" if orders else said


def _ranges(orders: Sequence[int]) -> str:
    """Whole numbers, runs of them by their ends."""
    runs: list[list[int]] = []
    for order in orders:
        if runs and order == runs[-1][1] + 1:
            runs[-1][1] = order
        else:
            runs.append([order, order])
    return ", ".join(f"{a} to {b}" if b > a + 1 else f"{a}, {b}" if b > a else f"{a}" for a, b in runs)
