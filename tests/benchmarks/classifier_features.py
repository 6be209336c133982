"""What a small classifier looks at: figures of what the paper's error model leaves of a sweep's angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model.model import ZERO
from diagnosis.error_model.result import BaselineFit
from twin.angles import Array

ORDERS = (*range(1, 9), 12, 16)
_SMALL = 1e-5


@dataclass(frozen=True, eq=False)
class Record:
    """A sweep as the classifier sees it, each (n,): angles [rad], direction, row times."""

    reference_rad: Array
    measured_rad: Array
    direction: Array
    time_s: Array


def features(record: Record, fit: BaselineFit) -> Array:
    """A row of figures; sizes are logarithms of degrees or of multiples of the noise."""
    left = np.degrees(fit.residual_rad)
    angle = fit.senses.sensor * record.reference_rad + fit.point[ZERO]
    calm = np.clip(left, *np.quantile(left, [0.005, 0.995]))
    sigma = 1.4826 * float(np.median(np.abs(np.diff(calm, 2)))) / np.sqrt(6.0) + _SMALL
    way = record.direction - record.direction.mean()
    out = [np.log10(sigma), np.log10(np.std(calm) + _SMALL), np.log10(np.std(calm) / sigma)]
    for order in ORDERS:
        c, s = (2.0 * float(np.mean(calm * wave(order * angle))) for wave in (np.cos, np.sin))
        out += [np.log10(np.hypot(c, s) + _SMALL)]
        # Locked to the axes: saturation and clipping are sines of 4a, a magnet's order is of any phase.
        out += [s / (np.hypot(c, s) + _SMALL)] if order % 4 == 0 else []
    out += _direction(calm, way, record)
    out += _time(calm, record.time_s, sigma)
    out += _lines(calm, angle, sigma)
    out += _spread(left, angle, sigma)
    out += _words(record, left, sigma)
    return np.array(out)


def _direction(calm: Array, way: Array, record: Record) -> list[float]:
    """Half the difference of the directions, and how it differs right after a reversal."""
    if not np.any(way):
        return [0.0, 0.0, 0.0]
    half = float(np.mean(calm * way) / np.mean(way**2))
    turned = np.flatnonzero(np.diff(record.direction)) + 1
    path = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(record.reference_rad)))])
    early, middle = [], []
    for row in turned:
        since = np.degrees(path - path[row])
        near = (since >= 0.0) & (since < 3.0)
        later = (since >= 3.0) & (since < 15.0)
        early += [float(np.mean((calm * record.direction)[near]))] if near.any() else []
        middle += [float(np.mean((calm * record.direction)[later]))] if later.any() else []
    first, second = (np.mean(part) / (abs(half) + _SMALL) if part else 0.0 for part in (early, middle))
    return [np.log10(abs(half) + _SMALL), float(np.clip(first, -5, 5)), float(np.clip(second, -5, 5))]


def _time(calm: Array, time_s: Array, sigma: float) -> list[float]:
    """Slope over the record, the largest step, and how much better a step is than a slope."""
    share = (time_s - time_s[0]) / max(float(time_s[-1] - time_s[0]), 1e-9) - 0.5
    slope = float(np.mean(calm * share) / np.mean(share**2))
    total = np.cumsum(calm - calm.mean())
    rows = np.arange(1, calm.size + 1)
    gain = total[:-1] ** 2 * calm.size / (rows[:-1] * (calm.size - rows[:-1]))
    ramp = slope**2 * float(np.sum(share**2))
    return [
        np.log10(abs(slope) + _SMALL),
        float(np.log10(gain.max() / sigma**2 + 1.0)),
        float(np.log10((gain.max() + _SMALL) / (ramp + _SMALL))),
    ]


def _lines(calm: Array, angle: Array, sigma: float) -> list[float]:
    """The largest line from order 9 to 150, its order, and how far it stands above the median of the others."""
    orders = np.arange(9, 150)
    power = np.abs(np.exp(-1j * np.outer(orders, angle)) @ calm) * 2.0 / calm.size
    best = int(np.argmax(power))
    return [
        float(np.log10(power[best] + _SMALL)),
        float(orders[best]),
        float(np.log10((power[best] + _SMALL) / (np.median(power) + _SMALL))),
    ]


def _spread(left: Array, angle: Array, sigma: float) -> list[float]:
    """Tails, and whether the noise goes with sin^2 2a."""
    rough = np.diff(left, 2)
    size = np.minimum(rough**2, np.quantile(rough**2, 0.99))
    shape = np.sin(2.0 * angle[1:-1]) ** 2
    high, low = size[shape > 0.75].mean() + _SMALL**2, size[shape < 0.25].mean() + _SMALL**2
    flat = np.abs(left) / sigma
    return [
        float(np.log10(high / low)),
        float(np.log10(flat.max())),
        float(np.log10(np.count_nonzero(flat > 8.0) + 1.0)),
        float(np.mean(rough**4) / (np.mean(rough**2) ** 2 + _SMALL**4)),
    ]


def _words(record: Record, left: Array, sigma: float) -> list[float]:
    """Repeated words, bits of the finest grid that holds all readings, its step over the noise, and reproducibility."""
    word = np.degrees(record.measured_rad) % 360.0
    moved = np.abs(np.diff(record.reference_rad)) > 1e-6
    repeated = float(np.mean((np.abs(np.diff(word)) < 2e-5)[moved])) if moved.any() else 0.0
    bits = 17
    for guess in range(16, 4, -1):
        step = 360.0 / 2**guess
        if np.max(np.abs(word - step * np.round(word / step))) > 2e-4:
            break
        bits = guess
    distinct = len(np.unique(np.round(word, 3))) / word.size
    up, down = record.direction > 0, record.direction < 0
    alike = 0.0
    if up.any() and down.any():
        at = record.reference_rad % (2.0 * np.pi)
        first = np.argsort(at[up])
        there = np.interp(at[down], at[up][first], left[up][first], period=2.0 * np.pi)
        alike = float(np.corrcoef(there, left[down])[0, 1])
    return [repeated, float(bits), float(np.log10(360.0 / 2**bits / sigma)), distinct, alike]
