"""Sweeps whose angle words or reference err as links, counters and tables do, made of their definitions alone.

    fault = draw("word_bit", seed=3)
    fault.columns["measured_deg"], fault.truth

Independent of the simulator under test: numpy and the standard library only.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .streams import stream

Array = npt.NDArray[np.float64]
Words = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Setting:
    """What the bench and the sensor are like: readings (n,), turns, bits of the word, noise [deg]."""

    shaft_deg: Array
    turns: float
    bits: int
    noise_deg: float
    clean_deg: Array
    """Angle before the noise, in the sensor's own count, unwrapped."""
    noisy_deg: Array
    sense: int

    @property
    def step_deg(self) -> float:
        """Of the word."""
        return float(360.0 / 2**self.bits)

    def words(self) -> Words:
        """As a sensor without fault sends them."""
        return np.mod(np.round(self.noisy_deg / self.step_deg), 2**self.bits).astype(np.int64)

    def of_words(self, words: Words) -> Array:
        """Degrees, with six decimals as files have them."""
        return np.round(words * self.step_deg, 6)


@dataclass(frozen=True)
class Drawn:
    """Columns of a sweep, the cause in it, and its parameters."""

    columns: dict[str, Array]
    cause: str | None
    truth: dict[str, Any]


def setting(rng: np.random.Generator, *, points: tuple[int, int] = (50, 5000), least_turns: int = 1) -> Setting:
    """One turn or many, an error of orders 1 and 2, and any zero, word length, noise and sense."""
    turns = max(int(rng.choice((1, 1, 2, 3, 5))), least_turns)
    count = round(float(np.exp(rng.uniform(*np.log(points)))))
    count = max(count, 40 * turns)
    shaft = np.arange(count) * (360.0 * turns / count)
    bits = int(rng.integers(10, 17))
    noise = float(np.exp(rng.uniform(np.log(0.01), np.log(0.2))))
    first, second = rng.uniform(0.3, 1.2), rng.uniform(0.05, 0.5)
    at, other = rng.uniform(0.0, 2.0 * np.pi, 2)
    turn = np.radians(shaft)
    sense = int(rng.choice((1, 1, -1)))
    clean = sense * shaft + first * np.sin(turn + at) + second * np.sin(2.0 * turn + other)
    clean = clean + float(rng.choice((0.0, rng.uniform(0.0, 360.0))))
    return Setting(shaft, turns, bits, noise, clean, clean + noise * rng.standard_normal(count), sense)


def error_code(rng: np.random.Generator) -> Drawn:
    """Zero, all ones or a status word in the place of some readings, alone or in runs."""
    own = setting(rng)
    words, rows = own.words(), own.words().size
    last = 2**own.bits - 1
    code = int(rng.choice((0, last, int(rng.integers(0, last)))))
    hit = np.zeros(rows, dtype=bool)
    if rng.random() < 0.6:
        share = float(rng.uniform(0.01, 0.15))
        count = max(3, round(share * rows))
        hit[rng.choice(rows, count, replace=False)] = True
    else:
        for _ in range(int(rng.integers(1, 4))):
            length = max(3, round(float(rng.uniform(0.01, 0.06)) * rows))
            start = int(rng.integers(0, rows - length))
            hit[start : start + length] = True
    sent = np.where(hit, code, words)
    truth = {"hit_rows": np.flatnonzero(sent != words) + 1, "reading_deg": code * own.step_deg}
    return _drawn(own, own.of_words(sent), "error_code", truth)


def word_bit(rng: np.random.Generator) -> Drawn:
    """A bit held at 0 or 1, or counted as its neighbour."""
    own = setting(rng, points=(100, 5000))
    words = own.words()
    # Worth more than the noise: below, it makes no more than noise does.
    least = max(2, int(np.ceil(np.log2(6.0 * own.noise_deg / own.step_deg))))
    bit = int(rng.integers(least, own.bits))
    kind = str(rng.choice(("low", "high", "up", "up_or", "down", "down_or")))
    if kind.startswith("up") and bit == own.bits - 1:
        kind = "low"
    weight, is_set = 1 << bit, (words >> bit) & 1
    cleared = words - is_set * weight
    sent = {
        "low": cleared,
        "high": words | weight,
        "up": cleared + 2 * is_set * weight,
        "up_or": cleared | (2 * is_set * weight),
        "down": cleared + is_set * weight // 2,
        "down_or": cleared | (is_set * weight // 2),
    }[kind]
    measured = own.of_words(np.mod(sent, 2**own.bits))
    return _drawn(own, measured, "word_bit", {"bit": bit, "bits": own.bits, "kind": kind})


def dead_zone(rng: np.random.Generator) -> Drawn:
    """A range that is never output: the word holds at either edge, or changes over anywhere in it."""
    own = setting(rng, points=(150, 5000))
    spacing = 360.0 * own.turns / own.shaft_deg.size
    width = float(rng.uniform(1.0, 15.0)) + 3.0 * spacing + 8.0 * own.noise_deg
    count = max(2, round(width / own.step_deg))
    first = int(rng.integers(0, 2**own.bits))
    jump = float(rng.choice((0.0, 0.5, 1.0)))
    # Words first + 1 .. first + count - 1 are never sent.
    inside = np.mod(own.words() - first, 2**own.bits)
    within = (inside > 0) & (inside < count)
    sent = np.where(within, first + np.where(inside >= jump * count, count, 0), own.words())
    truth = {"start_deg": first * own.step_deg, "width_deg": count * own.step_deg, "jump": jump}
    return _drawn(own, own.of_words(np.mod(sent, 2**own.bits)), "dead_zone", truth)


def scale_error(rng: np.random.Generator) -> Drawn:
    """Counts times a factor that is not that of a turn."""
    own = setting(rng, points=(50, 5000))
    away = float(np.exp(rng.uniform(np.log(0.004), np.log(0.08)))) * float(rng.choice((-1.0, 1.0)))
    factor = float(np.round(360.0 * (1.0 + away) / 2**own.bits, 6)) if rng.random() < 0.5 else None
    k = 1.0 + away if factor is None else factor * 2**own.bits / 360.0
    return _drawn(own, np.round(own.words() * own.step_deg * k, 6), "scale_error", {"factor": k})


def index_slips(rng: np.random.Generator) -> Drawn:
    """The reference slips twice, within turns."""
    own = setting(rng, points=(120, 3000), least_turns=2)
    rows = own.shaft_deg.size
    places = np.sort(rng.choice(np.arange(rows // 8, 7 * rows // 8), 2, replace=False))
    while np.diff(places)[0] < rows // 8:
        places = np.sort(rng.choice(np.arange(rows // 8, 7 * rows // 8), 2, replace=False))
    sizes = rng.uniform(0.5, 5.0, 2) * rng.choice((-1.0, 1.0), 2)
    slipped = own.shaft_deg + sum(size * (np.arange(rows) >= place) for size, place in zip(sizes, places, strict=True))
    time = 0.1 * np.arange(rows)
    drawn = _drawn(own, own.of_words(own.words()), "index_slip", {"steps_deg": sizes, "time_s": time[places]})
    return Drawn({"time_s": time, **drawn.columns, "reference_deg": np.round(slipped, 6)}, drawn.cause, drawn.truth)


def table(rng: np.random.Generator) -> Drawn:
    """A table of corrections at even readings; in half of them the entries stand in another order or in part."""
    entries = int(rng.choice((50, 64, 100, 128, 200, 256, 360, 512)))
    reading = np.arange(entries) * (360.0 / entries)
    first, second = rng.uniform(0.3, 1.2), rng.uniform(0.05, 0.5)
    at, other = rng.uniform(0.0, 2.0 * np.pi, 2)
    turn = np.radians(reading)
    noise = float(np.exp(rng.uniform(np.log(0.005), np.log(0.1))))
    error = first * np.sin(turn + at) + second * np.sin(2.0 * turn + other) + noise * rng.standard_normal(entries)
    reference = np.round(reading - error, 6)
    rows = np.arange(entries)
    if rng.random() < 0.5:
        rows = np.roll(rows, int(rng.integers(1, entries))) if rng.random() < 0.5 else rows[rng.random(entries) > 0.1]
    columns = {"reference_deg": reference[rows], "measured_deg": np.round(reading, 6)[rows]}
    return Drawn(columns, None, {"entries": entries, "noise_deg": noise})


def typing_error(rng: np.random.Generator) -> Drawn:
    """A small table, in which one cell is off by degrees."""
    count = int(rng.integers(18, 61))
    if rng.random() < 0.5:
        shaft = np.sort(rng.uniform(0.0, 360.0, count))
    else:
        shaft = np.repeat(np.arange((count + 1) // 2) * (720.0 / count), 2)[:count] + np.tile([0.0, 5.0], count)[:count]
    first, second = rng.uniform(0.3, 2.0), rng.uniform(0.05, 0.8)
    at, other = rng.uniform(0.0, 2.0 * np.pi, 2)
    turn = np.radians(shaft)
    noise = float(rng.uniform(0.02, 0.3))
    measured = shaft + first * np.sin(turn + at) + second * np.sin(2.0 * turn + other)
    measured = measured + noise * rng.standard_normal(count)
    row = int(rng.integers(0, count))
    off = float(rng.uniform(max(4.0, 20.0 * noise), 30.0)) * float(rng.choice((-1.0, 1.0)))
    measured[row] += off
    columns = {"reference_deg": np.round(shaft, 6), "measured_deg": np.round(np.mod(measured, 360.0), 6)}
    return Drawn(columns, None, {"row": row + 1, "off_deg": off, "noise_deg": noise})


def clean(rng: np.random.Generator) -> Drawn:
    """Nothing but what any sensor does."""
    own = setting(rng)
    return _drawn(own, own.of_words(own.words()), None, {})


KINDS: dict[str, Callable[[np.random.Generator], Drawn]] = {
    "error_code": error_code,
    "word_bit": word_bit,
    "dead_zone": dead_zone,
    "scale_error": scale_error,
    "index_slip": index_slips,
    "table": table,
    "typing_error": typing_error,
    "clean": clean,
}


def draw(kind: str, *, seed: int) -> Drawn:
    """A sweep of a kind; the same seed gives the same one on every machine."""
    return KINDS[kind](stream(seed, "link_faults", kind))


def _drawn(own: Setting, measured: Array, cause: str | None, truth: dict[str, Any]) -> Drawn:
    columns = {"reference_deg": np.round(own.shaft_deg, 6), "measured_deg": measured}
    common = {
        "bits": own.bits,
        "noise_deg": own.noise_deg,
        "rows": own.shaft_deg.size,
        "turns": own.turns,
        "sense": own.sense,
    }
    return Drawn(columns, cause, {**common, **truth})
