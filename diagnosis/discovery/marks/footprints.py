"""Footprints beside the mean: spikes, the grid of values, the finite set of a CORDIC, repeats, the spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.discovery.fitting.joint_fit import Fit, root_weights
from diagnosis.discovery.fitting.noise_model import to_rows
from diagnosis.discovery.fitting.observations import Evidence
from twin.angles import TAU, Array
from twin.effect import BoolArray, Effect
from twin.motion import Motion

SPIKE_SIGMA = 7.0
LONGEST_SPIKE = 4
FEWEST_WORDS = 40
_T95 = 1.959964


def robust_rms(values: Array) -> float:
    """RMS of Gaussian values from their median deviation, blind to outliers."""
    return float(1.4826 * np.median(np.abs(values - np.median(values)))) if values.size else 0.0


def local_residual(residual: Array) -> Array:
    """Residual (n,) against the median of its neighbours: what single readings do on their own."""
    if residual.size < 12:
        return np.asarray(residual - np.median(residual))
    padded = np.pad(residual, 4, mode="reflect")
    return np.asarray(residual - np.median(np.lib.stride_tricks.sliding_window_view(padded, 9), axis=-1))


def spikes(residual: Array, motion: Motion, step: float) -> tuple[BoolArray, float]:
    """Rows (n,) that stand far out of their neighbours, and the noise they stand out of.

    Readings on a grid of ``step`` [rad] jump by a whole step where noise moves them by much less.
    Five or more neighbours off together are structure, not spikes; so is what comes again at the same angle.
    """
    away = local_residual(residual)
    sigma = robust_rms(away)
    few = residual.size < 60
    mask = np.abs(away) > (14.0 if few else SPIKE_SIGMA) * max(sigma, 1e-9) + step
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first > LONGEST_SPIKE:
            mask[first:last] = False
    if mask.any():
        # The same place of the turn in the same direction, off the same way in other turns too: a narrow shape (or
        # what follows a reversal), no spike.
        place = np.round(np.degrees(motion.shaft_rad % TAU) / 2.0).astype(int) % 180
        for way in (1.0, -1.0):
            same_way = motion.direction == way
            for spot in np.unique(place[mask & same_way]):
                here = same_way & np.isin(place, [(spot - 1) % 180, spot, (spot + 1) % 180])
                off = here & mask
                if off.sum() >= 3 and 2 * off.sum() >= here.sum() and abs(np.sum(np.sign(away[off]))) == off.sum():
                    mask[off] = False
    return mask, sigma


def grid_bits(measured: Array) -> int | None:
    """The smallest word length (6 to 20 bits) on whose grid all readings (n,) [rad] lie; None: no such grid."""
    words = np.unique(np.round(measured % TAU, 9)).size
    if words < FEWEST_WORDS:
        # A few angles lie on a coarse grid by the bench's choice, not by the word's length.
        return None
    for bits in range(6, 21):
        step = TAU / 2.0**bits
        off = float(np.max(np.abs(measured / step - np.round(measured / step)))) * step
        # As many digits as files have: six decimals of a degree, or three.
        if any(off < digits < step / 12.0 for digits in (np.radians(1.2e-6), np.radians(6e-4))):
            return bits
    return None


def finite_set(measured: Array, effect: Effect, step: float, shapes: Sequence[float], name: str) -> tuple[float, float]:
    """Which parameter's set of attainable angles holds the readings: (value, log of the chance of that); (0, 0): none.

    ``step`` is the output grid [rad] that the set is rounded to; chance is the share of grid cells in the set, to the
    power of the readings.
    """
    resolution = step if step > 0.0 else np.radians(2e-4)
    cells = round(TAU / resolution)
    words = np.round(measured / resolution).astype(np.int64) % cells
    best = (0.0, 0.0)
    for value in shapes:
        assert effect.attainable is not None
        allowed = np.unique(np.round(effect.attainable({name: value}) / resolution).astype(np.int64) % cells)
        share = allowed.size / cells
        if share > 0.9:
            continue
        inside = np.isin(words, allowed)
        missed = int(np.count_nonzero(~inside))
        if missed > 0.04 * words.size:
            continue
        distinct = np.unique(words).size
        log_p = (distinct - missed) * np.log(share) + missed * 4.0
        if log_p < best[1]:
            best = (float(value), float(log_p))
    return best


def blur_behind(rms: float, step: float) -> float:
    """RMS of the noise ahead of a quantiser, from the RMS of readings about their blurred expectation [rad]."""
    if step <= 0.0 or rms <= 0.0:
        return rms
    ratio = np.geomspace(0.02, 3.0, 60)
    phases = (np.arange(64) + 0.5) / 64
    nodes = np.sort(np.random.default_rng(0).standard_normal(400))
    words = np.round(phases[None, :, None] + ratio[:, None, None] * nodes)
    spread = np.sqrt(np.mean(np.var(words, axis=-1), axis=-1))
    if rms / step > spread[-1]:
        return float(np.sqrt(max(rms**2 - step**2 / 12.0, 0.0)))
    return float(np.interp(rms / step, spread, ratio) * step)


@dataclass(frozen=True, eq=False)
class SpreadFinding:
    """A shape of the noise's variance over the rows: effect, parameters, twice the gain in log likelihood."""

    name: str
    values: dict[str, float]
    gain: float
    log_p: float
    variance: Array
    intervals: dict[str, tuple[float, float]]


def white_rows(fit: Fit) -> Array:
    """Residual (n,) over the rows, whitened, in units of its own RMS; masked rows are zero.

    What the rows' scale has taken out of them is put back: this is what the spread is judged on.
    """
    root = root_weights(fit.setting, fit.evidence.observables)[0]
    rows = to_rows(fit.cosine_residual[0] * root) * fit.evidence.scale
    sigma = float(np.sqrt(np.mean(rows[fit.evidence.usable] ** 2)))
    return np.where(fit.evidence.usable, rows / max(sigma, 1e-300), 0.0)


def spread_shapes(fit: Fit, effects: Sequence[Effect]) -> list[SpreadFinding]:
    """Which declared shapes of the variance gain over constant variance, each at its best strength."""
    if stairs_rule(fit) or float(np.mean(fit.residual[0] ** 2)) < 1e-12:
        return []
    white = white_rows(fit)
    use = fit.evidence.usable
    square = np.clip(white[use] ** 2, 0.0, 36.0)
    angle = fit.linear.sensor_angle
    sigma2 = float(np.mean(fit.residual[0][use] ** 2))
    found: list[SpreadFinding] = []
    expected = _expected_variance(fit, square)
    for effect in effects:
        if effect.spread is None:
            continue
        name = effect.roles("random")[0]
        shape = effect.spread(angle, {name: effect.params[name].typical})[use]
        if np.ptp(shape) < 1e-3 * np.mean(shape):
            continue
        gain, ratio = _variance_gain(square, shape / np.mean(shape), expected)
        if ratio <= 0.0:
            continue
        (base, added), deviation = _variances(square, expected, shape / np.mean(shape), ratio)
        # The fit has taken its share out of the mean square.
        unit = sigma2 * fit.rows / max(fit.rows - len(fit.free), 1) / float(np.mean(shape))
        typical = effect.params[name].typical
        low, value, high = (
            typical * float(np.sqrt(max(v, 0.0) * unit))
            for v in (added - _T95 * deviation, added, added + _T95 * deviation)
        )
        full = effect.spread(angle, {name: value}) + sigma2 * base
        log_p = _half_chi_square(gain)
        found.append(SpreadFinding(effect.name, {name: value}, gain, log_p, full, {name: (low, high)}))
    return found


def stairs_rule(fit: Fit) -> bool:
    """Whether stairs make most of the spread: how much a reading scatters then depends on its place between two steps.

    The variance is no evidence of anything else there.
    """
    stairs = fit.linear.stair_variance
    if stairs is not None and float(np.mean(stairs)) > 2.0 * fit.setting.blur**2:
        return True
    return any(effect.line and effect.line.clock == "channels" for _, effect, _ in fit.chain.active("channels"))


def _expected_variance(fit: Fit, square: Array) -> Array:
    """Relative variance of the rows in use that the output's stairs alone lead one to expect, mean 1.

    Between two steps of a coarse grid readings scatter more than on a step; how much of that is seen depends on how
    fast the noise ahead of the grid is, so the data choose.
    """
    if fit.linear.stair_variance is None:
        return np.ones(square.size)
    stairs = fit.linear.stair_variance[fit.evidence.usable]
    if not np.mean(stairs) > 0.0:
        return np.ones(square.size)
    stairs = stairs / np.mean(stairs)
    profiles = [1.0 - share + share * stairs for share in np.linspace(0.0, 0.95, 12)]
    return min(profiles, key=lambda v: square.size * np.log(np.mean(square / v)) + np.sum(np.log(v)))


def _variance_gain(square: Array, shape: Array, expected: Array) -> tuple[float, float]:
    """Twice the gain of variance ``expected + ratio shape`` over ``expected`` for squares (n,), and the best ratio."""
    n = square.size
    flat = n * np.log(np.mean(square / expected)) + np.sum(np.log(expected))
    ratios = np.concatenate([[0.0], np.geomspace(0.02, 200.0, 160)])
    gains = np.empty(ratios.size)
    for place, ratio in enumerate(ratios):
        profile = expected + ratio * shape
        gains[place] = flat - (n * np.log(np.mean(square / profile)) + np.sum(np.log(profile)))
    best = int(np.argmax(gains))
    return float(gains[best]), float(ratios[best])


def _variances(square: Array, expected: Array, shape: Array, ratio: float) -> tuple[tuple[float, float], float]:
    """Maximum likelihood of variance ``base expected + added shape`` from a first ratio: (base, added), sd of added.

    Both are free: where the shape is all there is, what it adds is known as well as the variance itself, no better.
    """
    parts = np.stack([expected, shape])
    found: Array = np.array([1.0, ratio]) * float(np.mean(square / (expected + ratio * shape)))
    inverse: Array = np.eye(2)
    for _ in range(4):
        variance = found @ parts
        relative = parts / variance
        # Fisher scoring: the information of a square about its variance is half of one over the variance squared.
        inverse = np.asarray(np.linalg.inv(0.5 * relative @ relative.T), dtype=np.float64)
        step = inverse @ (0.5 * relative @ (square / variance - 1.0))
        found = np.asarray(np.maximum(found + step, 0.1 * found), dtype=np.float64)
    return (float(found[0]), float(found[1])), float(np.sqrt(inverse[1, 1]))


def _half_chi_square(gain: float) -> float:
    """Log probability of the gain at the edge of the parameter's range: half a chi-square of one degree."""
    from scipy.special import log_ndtr

    return float(log_ndtr(-np.sqrt(max(gain, 0.0))))


def bursts(fit: Fit) -> SpreadFinding | None:
    """The stretch of rows with the most outstanding variance, if its noise is at least half as large again."""
    if stairs_rule(fit) or float(np.mean(fit.residual[0] ** 2)) < 1e-12:
        return None
    white = white_rows(fit)
    use = fit.evidence.usable
    square = np.where(use, np.clip(white**2, 0.0, 36.0), 0.0)
    n = square.size
    total, count = float(np.sum(square)), int(use.sum())
    sums = np.concatenate([[0.0], np.cumsum(square)])
    counts = np.concatenate([[0], np.cumsum(use)])
    best: tuple[float, int, int, float] | None = None
    looks = 0
    length = 10
    while length <= n // 2:
        starts = np.arange(0, n - length + 1, max(length // 6, 1))
        looks += max(n // length, 1) * 2
        inside = sums[starts + length] - sums[starts]
        k = np.maximum(counts[starts + length] - counts[starts], 1)
        outside = np.maximum(total - inside, 1e-12)
        rest = np.maximum(count - k, 1)
        gain = count * np.log(total / count) - k * np.log(np.maximum(inside, 1e-12) / k) - rest * np.log(outside / rest)
        gain = np.where(inside / k > outside / rest, gain, 0.0)
        place = int(np.argmax(gain))
        if best is None or gain[place] > best[0]:
            best = (
                float(gain[place]),
                int(starts[place]),
                int(starts[place] + length - 1),
                float((inside / k)[place] / (outside / rest)[place]),
            )
        length = int(length * 1.3) + 1
    if best is None or best[3] < 2.25:
        return None
    sigma = float(np.sqrt(np.mean(fit.residual[0][use] ** 2)))
    row = np.arange(n)
    inside_rows = (row >= best[1]) & (row <= best[2])
    share = np.where(inside_rows, best[3], 1.0)
    base = sigma / np.sqrt(np.mean(share[use]))
    return SpreadFinding(
        "unnamed_burst",
        {
            "first_row": float(best[1]),
            "last_row": float(best[2]),
            "rms_deg": float(np.degrees(base * np.sqrt(best[3] - 1.0))),
        },
        best[0],
        _half_chi_square(best[0]) + float(np.log(max(looks, 1))),
        base**2 * share,
        {},
    )


def row_scale(evidence: Evidence, variance: Array) -> Array:
    """Noise of each row against the usual one, from a variance (n,)."""
    return np.sqrt(variance / np.median(variance)) if variance.size == len(evidence) else np.ones(len(evidence))
