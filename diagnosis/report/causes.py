"""One picture for each cause: its own share of the error, isolated, over what shows it best."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.result import Discovery
from diagnosis.report.data import Readings, binned, share_deg, unexplained_by
from diagnosis.report.pictures import ANGLE, angle_bins, by_way, ways
from diagnosis.report.svg import Axis, Layer, Plot
from diagnosis.report.wording import minus
from twin.angles import TAU, Array
from twin.catalogue import find, unnamed
from twin.effect import BoolArray, Effect
from twin.found_by import OverSpeed, added_variance
from twin.motion import RPM

_PERIODS = 8.0
"""Periods of a fast ripple that are shown: more cannot be told from each other."""
_ENOUGH = 0.15
"""A view over the angle is good where less than this share of the effect's variance is left unordered."""
_SHARE = "share of the error / deg"

Group = tuple[str, str, BoolArray]


class Across(NamedTuple):
    """A coordinate of the readings (n,), what it is called, and the part of it that is shown."""

    values: Array
    label: str
    window: tuple[float, float]


def pictures(found: Discovery, read: Readings, cause: Finding) -> Iterator[tuple[str, Plot]]:
    """Caption and picture of each instance of a cause; instances with a name of their own share one picture."""
    effect = find(cause.keys[0], found.fit.chain.effects)
    if cause.rows:
        yield _single_readings(read, cause)
    elif unnamed(effect.name):
        for key in cause.keys:
            yield _one(found, read, (key,))
    else:
        yield _one(found, read, cause.keys)


def _one(found: Discovery, read: Readings, keys: tuple[str, ...]) -> tuple[str, Plot]:
    effect = find(keys[0], found.fit.chain.effects)
    values = found.fit.chain.values.get(keys[0], {})
    if effect.footprint == "spread":
        return _spread(found, read, effect, values)
    share = share_deg(found, keys)
    if effect.footprint == "values":
        return _stairs(found, read, share, values)
    if "frequency_Hz" in values:
        clock, name = read.clock
        first = _window(clock, _PERIODS / max(float(values["frequency_Hz"]), 1e-9))
        return _over(read, share, Across(clock, name, first), "A piece of the record, as long as a few periods.")
    order = float(values.get("order", 0.0))
    if order and order != round(order) and order < _PERIODS:
        turns = (read.motion.shaft_rad - read.motion.shaft_rad.min()) / TAU
        everything = (float(turns.min()), float(turns.max()))
        return _over(
            read, share, Across(turns, "shaft turns, counted through", everything), "It does not repeat each turn."
        )
    if order > 2.0 * _PERIODS:
        width = max(_PERIODS * 360.0 / order, 60.0 * 360.0 / read.motion.points_per_turn)
        if width < 360.0:
            window = _window(read.angle_deg, width)
            return _over(read, share, Across(read.angle_deg, "shaft angle / deg", window), "A piece of the turn.")
    return _smooth(read, share)


def _smooth(read: Readings, share: Array) -> tuple[str, Plot]:
    """Over the angle where that orders the share, alone or by direction, temperature or speed; else over time."""
    for name, groups in _views(read):
        left = sum(
            unexplained_by(read.angle_deg[m], share[m]) * float(np.var(share[m])) * np.mean(m) for _, _, m in groups
        )
        if left < _ENOUGH * float(np.var(share)):
            return f"Over the angle{name}.", _over_angle(read, share, groups)
    clock, name = read.clock
    everything = (float(clock.min()), float(clock.max()))
    return _over(read, share, Across(clock, name, everything), "In the order in which the readings were taken.")


def _views(read: Readings) -> Iterator[tuple[str, list[Group]]]:
    """Ways to group the readings, the simplest first: what to call it, and the groups."""
    motion = read.motion
    everything = np.ones(len(motion), dtype=bool)
    yield "", [("", "c-cause", everything)]
    by_direction = list(ways(read))
    if len(by_direction) == 2:
        yield ", by direction", by_direction
    if "two temperatures" in motion.provides:
        yield ", by temperature", list(_levels(motion.temperature_c, "°C"))
    if "two speeds" in motion.provides:
        yield ", by speed", list(_levels(motion.speed_rad_s / RPM, "rpm"))


def _levels(values: Array, unit: str) -> Iterator[Group]:
    """Groups of a condition (n,): its values where they are few, else quarters of its range."""
    colours = ("c-first", "c-second", "c-third", "c-fourth")
    levels, place = np.unique(np.round(values), return_inverse=True)
    if levels.size > len(colours):
        low, high = float(values.min()), float(values.max())
        place = np.clip(((values - low) / (high - low) * len(colours)).astype(int), 0, len(colours) - 1)
    for k, colour in enumerate(colours):
        mask = place == k
        if mask.any():
            yield minus(f"{np.mean(values[mask]):.0f} {unit}"), colour, mask


def _over_angle(read: Readings, share: Array, groups: list[Group]) -> Plot:
    shown = share + read.after_deg
    layers = [
        layer
        for name, colour, m in groups
        for layer in by_way(read, read.angle_deg, shown, f"readings{_behind(name)}", colour=colour, among=m)
    ]
    for name, colour, m in groups:
        middles, means = binned(read.angle_deg[m], share[m], angle_bins(int(np.count_nonzero(m)), each=3))
        kept = np.isfinite(means)
        layers.append(Layer("line", middles[kept], means[kept], f"the effect{_behind(name)}", f"{colour} deep"))
    return Plot(ANGLE, Axis(_SHARE), layers, "the effect's share of the error over the shaft angle")


def _over(read: Readings, share: Array, across: Across, note: str) -> tuple[str, Plot]:
    """Note and picture of share and readings over a coordinate, in a window of it."""
    within = (across.values >= across.window[0]) & (across.values <= across.window[1])
    use = np.flatnonzero(within)
    use = use[np.argsort(across.values[use], kind="stable")]
    layers = by_way(read, across.values, share + read.after_deg, "readings", colour="c-cause", among=within)
    layers.append(Layer("line", across.values[use], share[use], "the effect", "c-cause deep"))
    words = f"the effect's share of the error over {across.label}"
    return note, Plot(Axis(across.label, across.window), Axis(_SHARE), layers, words)


def _stairs(found: Discovery, read: Readings, share: Array, values: Any) -> tuple[str, Plot]:
    """What rounding does to the angle: all readings folded into one step of a grid, or a dozen uneven steps."""
    smooth = np.mod(found.sweep.measured_deg - share - read.after_deg, 360.0)
    if "bits" in values:
        place = np.mod(smooth * 2.0 ** float(values["bits"]) / 360.0, 1.0)
        return _over(
            read, share, Across(place, "place within a step / 1", (0.0, 1.0)), "All readings, folded into one step."
        )
    width = max(12.0 * float(np.ptp(share)), 60.0 * 360.0 / read.motion.points_per_turn)
    window = _window(smooth, width)
    return _over(read, share, Across(smooth, "angle before rounding / deg", window), "A few of the uneven steps.")


def _spread(found: Discovery, read: Readings, effect: Effect, values: Any) -> tuple[str, Plot]:
    """The scatter of the readings and what the effect makes of it, over the angle or in order."""
    fit = found.fit
    if effect.spread is None:
        clock, name = read.clock
        layers = by_way(read, clock, read.after_deg, "residual", colour="c-cause")
        note = "The stretch that scatters more than the rest."
        return note, Plot(Axis(name), Axis("residual / deg"), layers, "residual in the order of the readings")
    motion = fit.observations.motion
    sigma = np.degrees(np.sqrt(added_variance(effect.spread, fit.linear.sensor_angle, motion, values)))
    added = sigma if len(sigma) == len(read.after_deg) else sigma[fit.observations.group]
    over, axis, words, limits = read.angle_deg, ANGLE, "angle", (0.0, 360.0)
    if isinstance(effect.spread, OverSpeed):
        over, axis, words = np.abs(read.motion.speed_rad_s) / RPM, Axis("speed / rpm"), "speed"
        limits = (0.0, float(np.max(over)))
    rest = np.sqrt(max(float(np.mean(read.after_deg[read.plain] ** 2) - np.mean(added**2)), 0.0))
    middles, means = binned(over, np.hypot(added, rest), angle_bins(len(added), each=3), limits)
    kept = np.isfinite(means)
    layers = [
        *by_way(read, over, read.after_deg, "residual", colour="c-cause"),
        Layer("line", middles[kept], 2.0 * means[kept], "two standard deviations, with the effect", "c-cause deep"),
        Layer("line", middles[kept], -2.0 * means[kept], "", "c-cause deep"),
    ]
    return f"The scatter over the {words}.", Plot(axis, Axis("residual / deg"), layers, f"scatter over the {words}")


def _single_readings(read: Readings, cause: Finding) -> tuple[str, Plot]:
    """The touched readings among the others."""
    clock, name = read.clock
    touched = np.array(cause.rows)
    left = read.after_deg
    reach = float(np.max(np.abs(left)))
    layers = [
        *by_way(read, clock, left, "residual", colour="c-after"),
        Layer("marks", clock[touched], left[touched], "touched readings", "c-before"),
    ]
    y = Axis("residual / deg", (-1.1 * reach, 1.1 * reach))
    return "The touched readings among the others.", Plot(Axis(name), y, layers, "touched readings in their order")


def _window(values: Array, width: float) -> tuple[float, float]:
    """A stretch of this width around the middle reading, within what was recorded."""
    low, high = float(values.min()), float(values.max())
    if width >= high - low:
        return low, high
    start = float(np.clip(np.median(values) - 0.5 * width, low, high - width))
    return start, start + width


def _behind(name: str) -> str:
    return f", {name}" if name else ""
