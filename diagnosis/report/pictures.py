"""The report's pictures of a sweep: the error and what the baseline and the extended twin leave of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from diagnosis.report.data import Readings, binned, highest_order, noise_level, spectrum, two_ways
from diagnosis.report.svg import Axis, Kind, Layer, Plot
from twin.angles import Array
from twin.effect import BoolArray
from twin.motion import RPM

ANGLE = Axis("shaft angle / deg", (0.0, 360.0), (0, 45, 90, 135, 180, 225, 270, 315, 360))
_ERROR = "error / deg"
_RESIDUAL = "residual / deg"


def angle_bins(count: int, *, each: int) -> int:
    """As many bins around the turn as hold so many of the readings each."""
    return int(np.clip(count / each, 12, 180))


def ways(read: Readings) -> Iterator[tuple[str, str, BoolArray]]:
    """The directions of a sweep: name, class of their colour, and the readings taken in each."""
    for sign, name, colour in ((1.0, "forward", "c-forward"), (-1.0, "backward", "c-backward")):
        mask = read.motion.direction == sign
        if mask.any():
            yield name, colour, mask


def by_way(
    read: Readings, x: Array, y: Array, label: str, *, colour: str = "", among: BoolArray | None = None
) -> list[Layer]:
    """Readings (n,) as dots where the shaft turned forward and crosses where backward, each with its label.

    Without a colour of their own they take that of their direction; ``among`` (n,) are those that are drawn.
    """
    symbols: dict[str, Kind] = {"forward": "points", "backward": "crosses"}
    layers = []
    for way, own, mask in ways(read):
        drawn = mask if among is None else mask & among
        if drawn.any():
            named = label if label.endswith(way) else ", ".join(filter(None, (label, way)))
            layers.append(Layer(symbols[way], x[drawn], y[drawn], named, colour or own))
    return layers


def protocol(read: Readings) -> Plot:
    """Where the shaft stood at each reading."""
    clock, name = read.clock
    layers = by_way(read, clock, read.angle_deg, "")
    y = Axis("shaft angle / deg", (0.0, 360.0), (0, 90, 180, 270, 360))
    return Plot(Axis(name), y, layers, "the order in which the angles were taken")


def error(read: Readings) -> Plot:
    """The measured error and the baseline's prediction of it."""
    layers = by_way(read, read.angle_deg, read.error_deg, "measured")
    # Half a turn off, a reading's error and what is left of it may lie a turn apart.
    angle, predicted = read.angle_deg[read.plain], read.predicted_deg[read.plain]
    middles, means = binned(angle, predicted, angle_bins(len(angle), each=2))
    layers.append(Layer("line", *_without_gaps(middles, means), "baseline", "c-model"))
    limits = _limits(read.error_deg[read.plain])
    return Plot(
        ANGLE, Axis(_ERROR, limits), layers, "error of the angle over the shaft angle, and the baseline's prediction"
    )


def residual(read: Readings, values: Array, *, limits: tuple[float, float] | None = None) -> Plot:
    """A residual over the angle by direction, with its mean."""
    layers = by_way(read, read.angle_deg, values, "readings")
    for way, colour, mask in ways(read):
        use = mask & read.plain
        if use.any():
            middles, means = binned(read.angle_deg[use], values[use], angle_bins(int(np.count_nonzero(use)), each=5))
            layers.append(Layer("line", *_without_gaps(middles, means), f"mean, {way}", f"{colour} deep"))
    return Plot(ANGLE, Axis(_RESIDUAL, limits), layers, "residual over the shaft angle, by direction")


def residual_limits(read: Readings) -> tuple[float, float]:
    """One range for the residual before and after, so that they can be compared by eye."""
    return _limits(read.before_deg[read.plain])


def _limits(values: Array) -> tuple[float, float]:
    """The range of an axis that shows all of these values (n,)."""
    low, high = float(values.min()), float(values.max())
    margin = max(0.06 * (high - low), 1e-6)
    return low - margin, high + margin


def over_clock(read: Readings) -> Plot:
    """The residual before and after in the order in which the readings were taken."""
    clock, name = read.clock
    layers = _before_and_after(read, clock, clock)
    return Plot(Axis(name), Axis(_RESIDUAL), layers, f"residual before and after over {name}")


def _before_and_after(read: Readings, before_at: Array, after_at: Array) -> list[Layer]:
    """The residual of the baseline, and that of the extended twin where it is another one."""
    layers = [*by_way(read, before_at, read.before_deg, "baseline", colour="c-before")]
    if read.extended:
        layers += by_way(read, after_at, read.after_deg, "extended twin", colour="c-after")
    return layers


def over_condition(read: Readings, values: Array, label: str) -> Plot:
    """The residual before and after over a condition of the bench (n,).

    Where the bench stopped at a few values only, the points are drawn beside each other, before to the left.
    """
    low, high = float(values.min()), float(values.max())
    margin = 0.06 * (high - low)
    limits = (low - margin, high + margin)
    left = right = np.zeros(values.size)
    if np.unique(np.round(values, 1)).size <= 12:
        spread = np.mod(np.arange(values.size) * 0.618034, 1.0)
        left, right = -0.5 * margin * spread, 0.5 * margin * spread
    layers = _before_and_after(read, values + left, values + right)
    return Plot(Axis(label, limits), Axis(_RESIDUAL), layers, f"residual before and after over {label}")


def conditions(read: Readings) -> Iterator[tuple[str, Plot]]:
    """Pictures over temperature and speed where the sweep has more than one: heading, picture."""
    motion = read.motion
    if "temperature_c" in motion.columns and np.ptp(motion.temperature_c) > 1.0:
        yield "Over temperature", over_condition(read, motion.temperature_c, "temperature / °C")
    if "two speeds" in motion.provides:
        rpm = motion.speed_rad_s / RPM
        yield "Over speed", over_condition(read, rpm, "speed / rpm, backward negative")


def spectra(read: Readings, orders: list[float]) -> Plot:
    """Amplitudes of the residual over the order before and after, and the level of the noise."""
    highest = highest_order(read.motion, orders)
    at, before = spectrum(read.motion, read.before_deg, read.plain, highest)
    _, after = spectrum(read.motion, read.after_deg, read.plain, highest)
    level = noise_level(at, after, both=two_ways(read.motion))
    layers = [
        Layer("line", *_peaks(at, before), "baseline", "c-before"),
        *([Layer("line", *_peaks(at, after), "extended twin", "c-after")] if read.extended else []),
        Layer("line", at, level, "noise passes this at 1 order in 20", "c-model dashed"),
    ]
    floor = 0.1 * float(np.median(level))
    y = Axis("amplitude / deg", (max(floor, 1e-9), 1.6 * float(max(before.max(), after.max(), level.max()))), log=True)
    x = Axis("order / cycles per turn", (0.0, highest))
    return Plot(x, y, layers, "spectrum of the residual over the order before and after")


def _peaks(orders: Array, amplitudes: Array, most: int = 300) -> tuple[Array, Array]:
    """A spectrum of few enough points to be drawn as a line: of more orders, the largest of each few neighbours."""
    few = -(-orders.size // most)
    starts = np.arange(0, orders.size, few)
    return orders[starts], np.maximum.reduceat(amplitudes, starts)


def _without_gaps(x: Array, y: Array) -> tuple[Array, Array]:
    """A curve through the bins that hold readings, broken where several in a row hold none."""
    filled = np.flatnonzero(np.isfinite(y))
    x, y = x[filled], y[filled]
    wide = np.flatnonzero(np.diff(filled) > max(4, 3 * np.median(np.diff(filled), keepdims=False) if x.size > 1 else 4))
    return np.insert(x, wide + 1, x[wide] if wide.size else []), np.insert(y, wide + 1, np.nan)
