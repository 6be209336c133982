"""Long recordings: what all readings show beyond the part that is searched in full.

The readings of a long record are counted as what they are beside the twin that the searched part has made. What is
left is averaged over turns, by angle, direction and twelfth of the record: some thousand means in place of millions of
readings, each of which is as much less noisy. They are searched as a recording of the twin is, for what it lacks.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.discovery.fitting.subsample import STRETCHES
from diagnosis.discovery.pipeline import discover
from diagnosis.discovery.result import Discovery
from diagnosis.discovery.state import State
from twin.angles import TAU, Array, IntArray, wrap
from twin.catalogue import base_name, find
from twin.chain import Chain
from twin.confidence import OF_MAD
from twin.effect import Effect
from twin.motion import RPM, Motion
from twin.sweep import Sweep

ANGLES = 360
"""Means a turn: of orders up to 60 they keep 95 %."""
FEWEST_TURNS = 2.0
"""Readings a mean below which nothing is gained."""
_BLOCK = 1 << 17
"""Readings that run through the chain at once."""
_FAR = 6.0
"""Robust standard deviations beyond which a reading stands alone and is no part of a mean."""


@dataclass(frozen=True, eq=False)
class Averaged:
    """Means over the turns of a long record, as a recording (n,) of a twin.

    ``readings`` is how many the means are made of, and ``each`` how many a mean is made of, typically. ``twin`` is what
    the readings were held against.
    """

    sweep: Sweep
    readings: int
    each: float
    twin: Chain


@dataclass(frozen=True, eq=False)
class WholeRecord:
    """The means of a long record, and what they show that its searched part does not."""

    means: Averaged
    found: Discovery


def searched(means: Averaged, handed_in: State) -> WholeRecord:
    """Search the means for what the twin of the searched part lacks; settings, generator and watch are handed in."""
    twin = means.twin
    state = State.of(means.sweep, twin, given=twin, settings=handed_in.settings, rng=handed_in.rng)
    return WholeRecord(means, discover(state.with_(watch=handed_in.watch)))


def averaged(sweep: Sweep, found: Discovery) -> Averaged | None:
    """The means of a long record about what the twin of its searched part expects.

    Parameters
    ----------
    sweep : Sweep
        The whole record.
    found : Discovery
        What its searched part has shown.

    Returns
    -------
    Averaged or None
        None where there is nothing to be gained: half of it was searched, the search was ended early, its motion is
        estimated, words of its link were told back, a cause is known for the stretches alone, there are too few turns,
        or the output's stairs would stay in the means.
    """
    little = 2 * found.sweep.set_aside < len(sweep)
    if little or found.cut_short or found.words or sweep.estimated or sweep.recordings:
        return None
    twin = of_the_mean(found.device)
    if not all(_by_the_reading(find(key, twin.effects)) for key in twin.values):
        return None
    sums, sigma = _Sums.empty(), 0.0
    for motion, rows, left in left_beside(sweep, twin):
        sigma = sigma or OF_MAD * float(np.median(np.abs(left)))
        near = np.flatnonzero(np.abs(left) <= _FAR * sigma)
        sums.add(motion.part(near), rows[near] * STRETCHES // len(sweep), left[near])
    typical = float(np.median(sums.count[sums.count > 0])) if sums.count.any() else 0.0
    if typical < FEWEST_TURNS or stairs_left(found.bits, sigma) > sigma / np.sqrt(typical):
        return None
    return sums.as_recording(sweep, twin, np.flatnonzero(sums.count > 0.25 * typical))


def stairs_left(bits: float | None, sigma_rad: float) -> float:
    """Amplitude [rad] of the stairs of a word that many readings of this scatter, noise and rounding, leave on average.

    The first harmonic of the saw-tooth between angle and word, behind the Gaussian noise that is rounded with it.
    """
    if bits is None:
        return 0.0
    step = TAU / 2.0**bits
    noise2 = max(sigma_rad**2 - step**2 / 12.0, 0.0)
    return float(step / np.pi * np.exp(-2.0 * np.pi**2 * noise2 / step**2))


def of_the_mean(twin: Chain) -> Chain:
    """A twin with what acts on the mean of many readings alone: without rounding, noise and rare events."""
    keys = [key for key in twin.values if find(base_name(key), twin.effects).footprint != "mean"]
    return twin.without(*keys)


def _by_the_reading(effect: Effect) -> bool:
    """Whether what an effect does is known beyond the stretches it was fitted to: no turn's own zero, no spline."""
    of_parts = any(param.role == "per turn" or param.unit == "row" for param in effect.params.values())
    return not of_parts and not effect.record_wide


def left_beside(sweep: Sweep, twin: Chain) -> Iterator[tuple[Motion, IntArray, Array]]:
    """Block by block: motion, rows, and what is left of their readings [rad] beside a twin.

    The chain begins each block a turn ahead of it, so that its memories are filled, and at the first reading, from
    which times count. The shaft's angle goes on from block to block.
    """
    count, shaft_rad = len(sweep), np.zeros(0)
    lead = int(np.ceil(sweep.part(np.arange(min(count, _BLOCK))).motion().points_per_turn))
    for start in range(0, count, _BLOCK):
        ahead = np.arange(max(start - lead, 0), start)
        first = np.zeros(1 if ahead.size and ahead[0] else 0, dtype=np.int64)
        rows = np.arange(start, min(start + _BLOCK, count))
        motion = sweep.part(np.concatenate([first, ahead, rows])).motion()
        moved = np.array(motion.shaft_rad)
        if ahead.size:
            moved[first.size :] += shaft_rad[-ahead.size] - moved[first.size]
        shaft_rad, own = moved, np.arange(first.size + ahead.size, moved.size)
        expected = twin.readings(motion.at(moved))[own]
        yield motion.at(moved).part(own), rows, wrap(np.radians(sweep.measured_deg[rows]) - expected)


@dataclass(frozen=True, eq=False)
class _Sums:
    """Sums over the readings of each cell: of twelfth, direction (forth, back) and angle."""

    count: Array
    left: Array
    off: Array
    """Of the angle [rad] beyond the middle of its cell."""
    time: Array
    speed: Array
    temperature: Array
    current: Array

    @classmethod
    def empty(cls) -> _Sums:
        return cls(*(np.zeros(STRETCHES * 2 * ANGLES) for _ in range(7)))

    def add(self, motion: Motion, part: IntArray, left: Array) -> None:
        """Add readings (n,): their motion, twelfth of the record, and what is left of them [rad] beside."""
        place = np.mod(motion.shaft_rad, TAU) * (ANGLES / TAU)
        angle = np.minimum(place.astype(np.int64), ANGLES - 1)
        cell = (2 * part + (motion.direction < 0.0)) * ANGLES + angle
        self.count[:] += np.bincount(cell, minlength=self.count.size)
        told = (
            (self.left, left),
            (self.off, (place - angle - 0.5) * (TAU / ANGLES)),
            (self.time, motion.time_s),
            (self.speed, motion.speed_rad_s),
            (self.temperature, motion.temperature_c),
            (self.current, motion.current_a),
        )
        for total, values in told:
            total += np.bincount(cell, values, minlength=total.size)

    def as_recording(self, sweep: Sweep, twin: Chain, cells: IntArray) -> Averaged:
        """The means of these cells, one turn after the other as a bench would go: forth, back, the next twelfth."""
        group, angle = cells // ANGLES, cells % ANGLES
        order = np.lexsort((np.where(group % 2 == 1, -angle, angle), group))
        cells, group, angle = cells[order], group[order], angle[order]
        way = np.where(group % 2 == 1, -1.0, 1.0)

        def mean(total: Array) -> Array:
            return np.asarray(total[cells] / self.count[cells])

        shaft = (angle + 0.5) * (TAU / ANGLES) + mean(self.off)
        has = sweep.columns
        bare = Sweep(
            reference_deg=np.degrees(shaft),
            measured_deg=np.zeros(cells.size),
            time_s=_paced(mean(self.time), group, len(sweep)) if "time_s" in has else None,
            direction=way,
            speed_rpm=mean(self.speed) / RPM if "speed_rpm" in has else None,
            turn=np.unique(group, return_inverse=True)[1].astype(np.float64),
            temperature_c=mean(self.temperature) if "temperature_c" in has else None,
            current_a=mean(self.current) if "current_a" in has else None,
            name=sweep.name,
            senses=(twin.sensor_sense, twin.output_sense),
        )
        expected = twin.readings(bare.motion())
        told = replace(bare, measured_deg=np.degrees(wrap(expected + mean(self.left))))
        count = self.count[cells]
        return Averaged(told, int(count.sum()), float(np.median(count)), twin)


def _paced(time: Array, group: IntArray, readings: int) -> Array:
    """Times [s] of means (n,) that follow one another as readings do, each turn about its mean time."""
    step = float(np.ptp(time)) / max(readings, 1)
    out = np.empty_like(time)
    last = -np.inf
    for number in np.unique(group):
        rows = np.flatnonzero(group == number)
        begun = max(float(np.mean(time[rows])) - 0.5 * step * rows.size, last + step)
        out[rows] = begun + step * np.arange(rows.size)
        last = float(out[rows[-1]])
    return out
