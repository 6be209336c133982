"""From a twin to a correction: reading in, shaft angle out, continuous over the whole turn.

The twin's expected reading m(theta) over one turn at standstill is inverted and written as

    theta = slope m - zero + sum over k of (cosine_k cos k m + sine_k sin k m),

a few numbers that firmware evaluates without a table and without steps between table entries. What cannot be
corrected from one angle reading (randomness, staircases, effects of time, speed or of several turns) is left out and
said so; an effect of the direction (hysteresis, backlash) is corrected to the middle between both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from twin.angles import TAU, Array, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.motion import Motion

SCHEMA = "halltwin.correction/1"
MOST_ORDERS = 64
_GRID = 8192
_BEYOND_ONE_READING = frozenset({"time_s", "moving shaft", "several turns", "two turns", "two speeds", "turn"})
_BEYOND_MEAN = frozenset({"spread", "values", "sequence"})


@dataclass(frozen=True, eq=False)
class Correction:
    """theta = slope m - zero + series(m); the series (2, orders) [rad] holds cosines and sines of orders 1, 2, ...

    ``slope`` is -1 where the sensor counts against the shaft. ``left_out`` names effects that one reading cannot
    correct; ``tolerance_rad`` bounds what the dropped orders held together.
    """

    slope: int
    zero_rad: float
    series: Array
    left_out: tuple[str, ...]
    tolerance_rad: float

    def shaft(self, measured_rad: Array) -> Array:
        """Corrected shaft angle [rad], any shape, in [-pi, pi)."""
        measured = np.asarray(measured_rad, dtype=np.float64)
        return wrap(self.slope * measured - self.zero_rad + self.correction(measured))

    def correction(self, measured_rad: Array) -> Array:
        """The periodic part [rad] at readings of any shape."""
        measured = np.asarray(measured_rad, dtype=np.float64)
        once = np.exp(1j * measured)
        total = np.zeros(measured.shape, dtype=np.complex128)
        # Horner's rule: Re sum (c_k - i s_k) z^k = sum c_k cos k m + s_k sin k m.
        for cosine, sine in self.series.T[::-1]:
            total = (total + (cosine - 1j * sine)) * once
        return np.asarray(total.real)

    def table(self, points: int) -> Array:
        """The shaft angle [rad] (points,) at equally spaced readings from 0: slope m is not taken out."""
        return self.shaft(TAU * np.arange(points) / points)


def correction_of(chain: Chain, *, temperature_c: float = 25.0, tolerance_deg: float = 1e-3) -> Correction:
    """The correction of a twin at one temperature, with as few orders as the tolerance allows."""
    left_out = tuple(key for key in chain.values if _uncorrectable(chain, key))
    shaft = TAU * np.arange(_GRID) / _GRID
    slope = chain.sensor_sense * chain.output_sense
    kept = chain.without(*left_out)
    ways = [wrap(_settled_turn(kept, shaft, way, temperature_c) - slope * shaft) for way in (1.0, -1.0)]
    error = ways[0] + 0.5 * wrap(ways[1] - ways[0])
    # An error near half a turn would tear: take its mean out on the circle first.
    mean = float(np.angle(np.mean(np.exp(1j * error))))
    shape = wrap(error - mean)
    mean, shape = mean + float(shape.mean()), shape - shape.mean()
    measured = np.remainder(slope * shaft + mean + shape, TAU)
    order = np.argsort(measured, kind="stable")
    grid = TAU * np.arange(_GRID) / _GRID
    # theta = slope (m - mean - shape), with the shape looked up where the reading is m.
    wanted = -slope * np.interp(grid, measured[order], shape[order], period=TAU)
    spectrum = np.fft.rfft(wanted) / _GRID
    series = np.stack([2.0 * spectrum.real[1 : MOST_ORDERS + 1], -2.0 * spectrum.imag[1 : MOST_ORDERS + 1]])
    keep = _orders_needed(series, np.radians(tolerance_deg))
    dropped = float(np.sum(np.hypot(*series[:, keep:])))
    zero = slope * mean - float(spectrum.real[0])
    return Correction(slope, float(wrap(zero)), np.ascontiguousarray(series[:, :keep]), left_out, dropped)


def _uncorrectable(chain: Chain, key: str) -> bool:
    effect = find(key, chain.effects)
    return bool(effect.needs & _BEYOND_ONE_READING) or effect.footprint in _BEYOND_MEAN


def _settled_turn(chain: Chain, shaft: Array, way: float, temperature_c: float) -> Array:
    """Readings [rad] of one turn at standstill at the ascending angles (n,), each approached from one side.

    A turn runs before it, after which effects with a memory have settled.
    """
    path = np.concatenate([shaft - TAU, shaft]) if way > 0 else np.concatenate([shaft, shaft + TAU])[::-1]
    motion = Motion.from_angle(path, direction=np.full(path.size, way), temperature_c=np.full(path.size, temperature_c))
    last = chain.readings(motion)[shaft.size :]
    return last if way > 0 else last[::-1]


def _orders_needed(series: Array, tolerance_rad: float) -> int:
    """The lowest number of orders whose omitted rest stays below the tolerance."""
    size = np.hypot(series[0], series[1])
    rest = np.concatenate([np.cumsum(size[::-1])[::-1], [0.0]])
    return int(np.argmax(rest <= tolerance_rad))


def to_dict(correction: Correction) -> dict[str, Any]:
    """The content of a correction TOML, angles in degrees."""
    return {
        "schema": SCHEMA,
        "formula": "shaft = slope * m - zero_deg + sum(cosine_deg[k-1] cos(k m) + sine_deg[k-1] sin(k m))",
        "slope": correction.slope,
        "zero_deg": float(np.degrees(correction.zero_rad)),
        "cosine_deg": [float(v) for v in np.degrees(correction.series[0])],
        "sine_deg": [float(v) for v in np.degrees(correction.series[1])],
        "left_out": list(correction.left_out),
        "dropped_orders_at_most_deg": float(np.degrees(correction.tolerance_rad)),
    }


def from_dict(content: Mapping[str, Any]) -> Correction:
    """The correction of a TOML's content."""
    return Correction(
        slope=int(content["slope"]),
        zero_rad=float(np.radians(content["zero_deg"])),
        series=np.radians(np.array([content["cosine_deg"], content["sine_deg"]], dtype=np.float64).reshape(2, -1)),
        left_out=tuple(content.get("left_out", ())),
        tolerance_rad=float(np.radians(content.get("dropped_orders_at_most_deg", 0.0))),
    )
