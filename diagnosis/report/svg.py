"""Small plots as inline SVG: axes with ticks and units, legend, points, lines and bands, thinned to what can be seen.

Colours come from the page's style sheet by class, so that one picture serves the light and the dark scheme and print.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import Literal

import numpy as np

from twin.angles import Array

WIDTH, HEIGHT = 520.0, 290.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 70.0, 16.0, 10.0, 46.0
MOST_POINTS = 1500
_FEW = 400

Kind = Literal["points", "crosses", "line", "marks"]


@dataclass(frozen=True, eq=False)
class Layer:
    """One series: x and y of shape (n,), its label in the legend ("" for none) and the class of its colour.

    A ``line`` is broken where y is not finite; ``crosses`` are points of another symbol; ``marks`` are few and large.
    """

    kind: Kind
    x: Array
    y: Array
    label: str
    colour: str


@dataclass(frozen=True)
class Axis:
    """An axis: its label with the unit, its range (None: from the data), its ticks (None: round numbers)."""

    label: str
    limits: tuple[float, float] | None = None
    ticks: Sequence[float] | None = None
    log: bool = False


@dataclass(frozen=True, eq=False)
class Plot:
    """A picture of layers over two axes; ``alt`` says in words what it shows."""

    x: Axis
    y: Axis
    layers: Sequence[Layer]
    alt: str

    def legend(self) -> str:
        """The legend as text that wraps as the page does, each label behind a sample of its layer."""
        samples = {"line": "M1 6h24", "points": "M13 6h0", "crosses": "M10 3l6 6m0-6l-6 6", "marks": "M13 6h0"}
        items = "".join(
            f'<span><svg viewBox="0 0 26 12" aria-hidden="true"><path class="sample {layer.kind} {layer.colour}" '
            f'd="{samples[layer.kind]}"/></svg>{escape(layer.label)}</span>'
            for layer in self.layers
            if layer.label
        )
        return f'<div class="legend">{items}</div>' if items else ""

    def svg(self) -> str:
        """The picture without its legend."""
        frame = _Frame(self)
        parts = [frame.axes(), '<g class="data">']
        parts += [frame.draw(layer) for layer in self.layers]
        parts += ["</g>", frame.beyond()]
        return (
            f'<svg viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" role="img" aria-label="{escape(self.alt, quote=True)}">'
            f"{''.join(parts)}</svg>"
        )


class _Frame:
    """Where data lands on the picture: linear or logarithmic axes, points outside drawn at the edge."""

    def __init__(self, plot: Plot) -> None:
        self.plot = plot
        self.left, self.right = _LEFT, WIDTH - _RIGHT
        self.top, self.bottom = _TOP, HEIGHT - _BOTTOM
        self.x_limits = plot.x.limits or _limits([layer.x for layer in plot.layers], margin=0.0)
        self.y_limits = plot.y.limits or _limits([layer.y for layer in plot.layers], margin=0.06, log=plot.y.log)

    def column(self, x: Array) -> Array:
        low, high = self.x_limits
        return np.asarray(self.left + (x - low) / (high - low) * (self.right - self.left))

    def row(self, y: Array) -> Array:
        low, high = self.y_limits
        if self.plot.y.log:
            y, low, high = np.log10(np.maximum(y, 1e-300)), math.log10(low), math.log10(high)
        return np.asarray(self.bottom - (y - low) / (high - low) * (self.bottom - self.top))

    def axes(self) -> str:
        """Frame, ticks with their grid lines, and labels."""
        x, y = self.plot.x, self.plot.y
        parts = []
        for value, text in _ticks(x, self.x_limits):
            at = float(self.column(np.array(value)))
            parts.append(f'<path class="grid" d="M{at:.1f} {self.top:.1f}V{self.bottom:.1f}"/>')
            parts.append(f'<text x="{at:.1f}" y="{self.bottom + 17:.1f}" text-anchor="middle">{text}</text>')
        for value, text in _ticks(y, self.y_limits):
            at = float(self.row(np.array(value)))
            parts.append(f'<path class="grid" d="M{self.left:.1f} {at:.1f}H{self.right:.1f}"/>')
            parts.append(f'<text x="{self.left - 7:.1f}" y="{at + 4:.1f}" text-anchor="end">{text}</text>')
        middle = 0.5 * (self.top + self.bottom)
        parts += [
            f'<path class="frame" d="M{self.left:.1f} {self.top:.1f}V{self.bottom:.1f}H{self.right:.1f}"/>',
            f'<text class="label" x="{0.5 * (self.left + self.right):.1f}" y="{HEIGHT - 8:.1f}" '
            f'text-anchor="middle">{escape(x.label)}</text>',
            f'<text class="label" transform="translate(13 {middle:.1f}) rotate(-90)" '
            f'text-anchor="middle">{escape(y.label)}</text>',
        ]
        return "".join(parts)

    def draw(self, layer: Layer) -> str:
        """One layer's path; what lies outside of the axes is not drawn here."""
        x, y = self.column(layer.x), self.row(layer.y)
        if layer.kind == "line":
            inside = (x >= self.left - 1.0) & (x <= self.right + 1.0)
            path = _line(x[inside], np.clip(y[inside], self.top, self.bottom))
            return f'<path class="line {layer.colour}" d="{path}"/>'
        inside = self._inside(x, y)
        # Few points are drawn larger: nothing hides behind them.
        few = layer.kind in ("points", "crosses") and int(np.count_nonzero(inside)) < _FEW
        places = thinned(x[inside], y[inside])
        if layer.kind == "crosses":
            arm = 2.4 if few else 1.6
            path = "".join(
                f"M{a - arm:.1f} {b - arm:.1f}l{2 * arm:.1f} {2 * arm:.1f}m0-{2 * arm:.1f}l-{2 * arm:.1f} {2 * arm:.1f}"
                for a, b in places
            )
        else:
            path = "".join(f"M{a:g} {b:g}h0" for a, b in places)
        return f'<path class="{layer.kind}{" few" * few} {layer.colour}" d="{path}"/>'

    def _inside(self, x: Array, y: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        return np.asarray(
            (x >= self.left - 0.5) & (x <= self.right + 0.5) & (y >= self.top - 0.5) & (y <= self.bottom + 0.5)
        )

    def beyond(self) -> str:
        """Triangles at the edge for points above and below the axis, and how many they are."""
        parts, count = [], 0
        for layer in self.plot.layers:
            if layer.kind == "line":
                continue
            x, y = self.column(layer.x), self.row(layer.y)
            across = (x >= self.left) & (x <= self.right)
            for out, edge, up in ((y < self.top - 0.5, self.top, -1.0), (y > self.bottom + 0.5, self.bottom, 1.0)):
                there = np.unique(np.round(x[out & across]))
                count += int(np.count_nonzero(out & across))
                path = "".join(f"M{a - 4:g} {edge - 7 * up:g}h8l-4 {7 * up:g}z" for a in there)
                if path:
                    parts.append(f'<path class="beyond {layer.colour}" d="{path}"/>')
        if count:
            said = f"{count} beyond the axis"
            parts.append(f'<text x="{self.right:.1f}" y="{self.top + 18:.1f}" text-anchor="end">{said}</text>')
        return "".join(parts)


# ---- thinning ---------------------------------------------------------------------------------------------------


def thinned(x: Array, y: Array) -> list[tuple[float, float]]:
    """Points (picture units) rounded to half a unit, each once; of too many, every k-th and every column's extremes."""
    places = _once(x, y, 0.5)
    if len(places) > MOST_POINTS:
        places = _once(places[:, 0], places[:, 1], 1.0)
        # They are sorted by column, then by height: a column begins and ends with its extremes.
        edges = np.flatnonzero(np.diff(places[:, 0]))
        some = np.linspace(0, len(places) - 1, MOST_POINTS).astype(int)
        places = places[np.unique(np.concatenate([edges, edges + 1, some]))]
    return [(float(a), float(b)) for a, b in places]


def _once(x: Array, y: Array, unit: float) -> Array:
    """Points rounded to this unit, each once, sorted by x and then by y."""
    columns, rows = np.round(x / unit).astype(np.int64), np.round(y / unit).astype(np.int64)
    # One number a point: sorting these is many times faster than sorting pairs.
    packed = np.unique((columns << 32) + rows)
    rows = ((packed + (1 << 31)) & 0xFFFFFFFF) - (1 << 31)
    return np.column_stack([(packed - rows) >> 32, rows]) * unit


def _line(x: Array, y: Array) -> str:
    """A path through the points in their order; of many in one column, the extremes."""
    if x.size > 2 * WIDTH:
        column = np.round(x).astype(int)
        starts = np.flatnonzero(np.concatenate([[True], np.diff(column) != 0]))
        if starts.size < x.size / 2:
            finite = np.where(np.isfinite(y), y, np.nan)
            low, high = np.fmin.reduceat(finite, starts), np.fmax.reduceat(finite, starts)
            x, y = np.repeat(x[starts], 2), np.column_stack([low, high]).ravel()
    parts, pen = [], "M"
    for a, b in zip(x, y, strict=True):
        if not math.isfinite(b):
            pen = "M"
            continue
        parts.append(f"{pen}{a:.1f} {b:.1f}")
        pen = "L"
    return "".join(parts)


# ---- ticks and ranges -------------------------------------------------------------------------------------------


def _limits(series: Sequence[Array], *, margin: float, log: bool = False) -> tuple[float, float]:
    """Range of the data; a few points far off the rest do not set it."""
    values = np.concatenate([np.ravel(s) for s in series]) if series else np.zeros(0)
    values = values[np.isfinite(values) & ((values > 0.0) if log else True)]
    if not values.size:
        return (0.1, 1.0) if log else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    if log:
        return max(low, high * 1e-6) / 1.3, high * 1.5
    if margin:
        near, far = (float(q) for q in np.quantile(values, (0.01, 0.99)))
        reach = 1.0 * (far - near)
        if reach > 0.0 and high - low > 4.0 * reach:
            low, high = max(low, near - reach), min(high, far + reach)
    width = high - low
    if width <= 0.0:
        return low - 0.5, high + 0.5
    return low - margin * width, high + margin * width


def _ticks(axis: Axis, limits: tuple[float, float]) -> list[tuple[float, str]]:
    """Positions and texts of an axis's ticks."""
    low, high = limits
    if axis.log:
        decades = range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)
        factors = (1,) if len(decades) > 2 else (1, 2, 5)
        values = [f * 10.0**d for d in range(decades.start - 1, decades.stop + 1) for f in factors]
        return [(v, f"{v:g}") for v in values if low <= v <= high]
    if axis.ticks is not None:
        return [(v, f"{v:g}") for v in axis.ticks if low <= v <= high]
    step = round_step((high - low) / 5.0)
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [(k * step, f"{k * step:.{decimals}f}".replace("-", "−")) for k in range(first, last + 1)]


def round_step(rough: float) -> float:
    """The round number 1, 2 or 5 times a power of ten nearest above three quarters of a rough step."""
    least = 0.75 * rough
    power = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= least)
