"""From a twin to a correction: reading in, shaft angle out, continuous over the whole turn.

The twin's expected reading m(theta) over one turn at standstill is inverted and written as

    theta = slope m - zero + sum over k of (cosine_k cos k m + sine_k sin k m),

a few numbers that firmware evaluates without a table and without steps between table entries. What cannot be
corrected from one angle reading (randomness, staircases, effects of time, speed or of several turns) is left out and
said so; an effect of the direction (hysteresis, backlash) is corrected to the middle between both.

Where the twin follows the temperature, zero and coefficients are polynomials of T - 25 C: those of the low orders that
need it, the others stay constant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from diagnosis.thermal.laws import FROM_C, from_25
from diagnosis.thermal.levels import Span
from twin.angles import TAU, Array, wrap
from twin.catalogue import find
from twin.chain import Chain
from twin.motion import Motion

SCHEMA = "halltwin.correction/1"
MOST_ORDERS = 64
_GRID = 8192
_HIGHEST_POWER = 4
"""Products of laws, each of up to the second power, that a correction holds."""
_BEYOND_ONE_READING = frozenset(
    {
        "time_s",
        "moving shaft",
        "several turns",
        "two turns",
        "two speeds",
        "varying speed|two currents",
        "two currents",
        "turn",
    }
)
_BEYOND_MEAN = frozenset({"spread", "values", "sequence"})


@dataclass(frozen=True, eq=False)
class Drift:
    """What is added to a correction at T: terms (powers, ...) in T - 25 C, its square, ..., in rad per kelvin^power.

    Beyond ``low_c`` and ``high_c``, between which it was measured, T counts as the nearer of them. ``series`` (powers,
    2, orders) holds the first orders alone.
    """

    low_c: float
    high_c: float
    zero_rad: Array
    series: Array

    def powers(self, temperature_c: Array | float) -> Array:
        """The powers (powers, ...) of T - 25 C at temperatures (...) [C]."""
        away = np.clip(np.asarray(temperature_c, dtype=np.float64), self.low_c, self.high_c) - FROM_C
        return np.stack([away ** (j + 1) for j in range(self.zero_rad.size)])

    @property
    def farthest_K(self) -> float:
        """Largest distance from 25 C."""
        return max(abs(self.low_c - FROM_C), abs(self.high_c - FROM_C))


@dataclass(frozen=True, eq=False)
class Correction:
    """theta = slope m - zero + series(m); the series (2, orders) [rad] holds cosines and sines of orders 1, 2, ...

    ``slope`` is -1 where the sensor counts against the shaft. ``left_out`` names effects that one reading cannot
    correct; ``tolerance_rad`` bounds what the dropped orders held together. With a ``drift``, zero and series are
    those at 25 C. ``to_middle`` names effects of the direction, which are corrected to the middle between both.
    """

    slope: int
    zero_rad: float
    series: Array
    left_out: tuple[str, ...]
    tolerance_rad: float
    drift: Drift | None = None
    to_middle: tuple[str, ...] = ()

    def shaft(self, measured_rad: Array, temperature_c: Array | float = FROM_C) -> Array:
        """Corrected shaft angle [rad], any shape, in [-pi, pi); a temperature for all readings or for each."""
        measured = np.asarray(measured_rad, dtype=np.float64)
        return wrap(self.slope * measured - self.zero_rad + self.correction(measured, temperature_c))

    def correction(self, measured_rad: Array, temperature_c: Array | float = FROM_C) -> Array:
        """The periodic part [rad] at readings of any shape, and by how much the zero has moved since 25 C."""
        measured = np.asarray(measured_rad, dtype=np.float64)
        total = _sum_of_orders(self.series, measured)
        if self.drift is None:
            return total
        for power, zero, series in zip(
            self.drift.powers(temperature_c), self.drift.zero_rad, self.drift.series, strict=True
        ):
            total = total + power * (_sum_of_orders(series, measured) - zero)
        return total

    def table(self, points: int, temperature_c: float = FROM_C) -> Array:
        """The shaft angle [rad] (points,) at equally spaced readings from 0: slope m is not taken out."""
        return self.shaft(TAU * np.arange(points) / points, temperature_c)


def _sum_of_orders(series: Array, measured: Array) -> Array:
    """Cosines and sines (2, orders) summed at readings [rad] of any shape."""
    once = np.exp(1j * measured)
    total = np.zeros(measured.shape, dtype=np.complex128)
    # Horner's rule: Re sum (c_k - i s_k) z^k = sum c_k cos k m + s_k sin k m.
    for cosine, sine in series.T[::-1]:
        total = (total + (cosine - 1j * sine)) * once
    return np.asarray(total.real)


def correction_of(chain: Chain, *, temperature_c: float = FROM_C, tolerance_deg: float = 1e-3) -> Correction:
    """The correction of a twin at one temperature, with as few orders as the tolerance allows."""
    slope, zero, series, left_out = _inverse(chain, temperature_c)
    keep = _orders_needed(np.hypot(*series), np.radians(tolerance_deg))
    dropped = float(np.sum(np.hypot(*series[:, keep:])))
    kept = np.ascontiguousarray(series[:, :keep])
    return Correction(slope, zero, kept, left_out, dropped, to_middle=_to_middle(chain))


def correction_over(
    chain_at: Callable[[float], Chain], low_c: float, high_c: float, *, tolerance_deg: float = 1e-3
) -> Correction:
    """The correction of a twin from one temperature [C] to another, with as few terms as the tolerance allows.

    ``chain_at`` gives the twin at a temperature.
    """
    span, tolerance = Span(low_c, high_c), np.radians(tolerance_deg)
    # At these temperatures a polynomial is known best (Chebyshev, Gauss and Lobatto).
    t = np.cos(np.pi * np.arange(_HIGHEST_POWER + 1) / _HIGHEST_POWER)
    found = [_inverse(chain_at(c), c) for c in span.middle_c + span.half_K * t]
    zeros = np.unwrap([one[1] for one in found])
    flat = np.stack([np.concatenate([[zero], one[2].ravel()]) for zero, one in zip(zeros, found, strict=True)])
    power, terms = _polynomial(t, flat, tolerance)
    terms = from_25(span, power + 1) @ terms
    series = terms[:, 1:].reshape(power + 1, 2, MOST_ORDERS)
    away = np.abs(np.stack([np.asarray((c - FROM_C) ** np.arange(power + 1)) for c in (low_c, FROM_C, high_c)])).max(0)
    moves = np.tensordot(away[1:], np.hypot(series[1:, 0], series[1:, 1]), 1)
    keep = _orders_needed(np.hypot(*series[0]) + moves, 0.5 * tolerance)
    follow = min(_orders_needed(moves, 0.5 * tolerance), keep)
    dropped = float(np.sum(np.hypot(*series[0, :, keep:])) + np.sum(moves[follow:]))
    drift = Drift(low_c, high_c, terms[1:, 0], np.ascontiguousarray(series[1:, :, :follow])) if power else None
    constant = np.ascontiguousarray(series[0, :, :keep])
    middle = _to_middle(chain_at(low_c))
    return Correction(found[0][0], float(wrap(terms[0, 0])), constant, found[0][3], dropped, drift, middle)


def _polynomial(t: Array, values: Array, tolerance: float) -> tuple[int, Array]:
    """The lowest power at which polynomials of t (n,) through values (n, m) stay within the tolerance.

    Beside it their coefficients (power + 1, m). What an angle is off by is at most the sum over all columns.
    """
    for power in range(t.size):
        basis = np.vander(t, power + 1, increasing=True)
        terms = np.linalg.lstsq(basis, values, rcond=None)[0]
        if np.max(np.sum(np.abs(values - basis @ terms), axis=1)) <= tolerance:
            break
    return power, np.asarray(terms)


def _inverse(chain: Chain, temperature_c: float) -> tuple[int, float, Array, tuple[str, ...]]:
    """Slope, zero [rad] and series (2, MOST_ORDERS) [rad] of the inverse, and the effects that are left out."""
    left_out = tuple(key for key in chain.values if _uncorrectable(chain, key))
    shaft = TAU * np.arange(_GRID) / _GRID
    slope = chain.sensor_sense * chain.output_sense
    kept = chain.without(*left_out)
    ways = [wrap(settled_turn(kept, shaft, way, temperature_c) - slope * shaft) for way in (1.0, -1.0)]
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
    return slope, float(wrap(slope * mean - float(spectrum.real[0]))), series, left_out


def _uncorrectable(chain: Chain, key: str) -> bool:
    effect = find(key, chain.effects)
    return bool(effect.needs & _BEYOND_ONE_READING) or effect.footprint in _BEYOND_MEAN


def _to_middle(chain: Chain) -> tuple[str, ...]:
    """Effects of the direction, of which a correction takes the mean of both."""
    directed = (key for key, values in chain.values.items() if not find(key, chain.effects).is_null(values))
    return tuple(key for key in directed if "both directions" in find(key, chain.effects).needs)


def settled_turn(chain: Chain, shaft: Array, way: float, temperature_c: float) -> Array:
    """Readings [rad] of one turn at standstill at the ascending angles (n,), each approached from one side.

    A turn runs before it, after which effects with a memory have settled.
    """
    path = np.concatenate([shaft - TAU, shaft]) if way > 0 else np.concatenate([shaft, shaft + TAU])[::-1]
    motion = Motion.from_angle(path, direction=np.full(path.size, way), temperature_c=np.full(path.size, temperature_c))
    last = chain.readings(motion)[shaft.size :]
    return last if way > 0 else last[::-1]


def _orders_needed(size: Array, tolerance_rad: float) -> int:
    """The lowest number of orders, of these sizes (orders,), whose omitted rest stays below the tolerance."""
    rest = np.concatenate([np.cumsum(size[::-1])[::-1], [0.0]])
    return int(np.argmax(rest <= tolerance_rad))
