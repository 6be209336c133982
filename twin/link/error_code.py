"""error_code: a fixed word stands in the place of readings."""

from __future__ import annotations

from collections.abc import Mapping
from math import lgamma

import numpy as np

from twin.angles import TAU, Array, IntArray
from twin.confidence import Z95
from twin.drawing import span
from twin.effect import BoolArray, Effect, Param, Parameters
from twin.motion import Motion
from twin.words import InWords, WordFault, Words

_ODDS = 20.0
"""So many times as likely as that the angle itself reads the code must it be that the code stands in its place."""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    if rng is None:
        return signal
    share = np.clip(0.01 * np.asarray(values["fraction_percent"]), 0.0, 0.999)
    length = np.maximum(np.asarray(values["run_rows"]), 1.0)
    shape = np.broadcast_shapes(signal.shape, share.shape, length.shape)
    # A two-state chain: runs of this mean length, begun so often that they take up this share.
    begins = np.minimum(share / np.maximum(length * (1.0 - share), 1e-9), 1.0)
    drawn = rng.random(shape)
    hit = np.zeros(shape, dtype=bool)
    on = drawn[..., 0] < share[..., 0] if share.ndim else drawn[..., 0] < share
    begins, ends = (np.broadcast_to(one, shape)[..., 0] for one in (begins, 1.0 / length))
    for row in range(shape[-1]):
        if row:
            on = np.where(on, drawn[..., row] >= ends, drawn[..., row] < begins)
        hit[..., row] = on
    return np.where(hit, np.radians(np.asarray(values["reading_deg"])), signal)


def find(words: Words) -> WordFault | None:
    """The one word that stands at angles where it is not expected, and not because the reading before is held.

    Chance: words that are far off for any other reason agree with one another by one in all words there are.
    """
    off = words.expected.residual
    far = words.usable & (np.abs(off) > words.apart)
    coded = far & ~_held(words, far)
    if np.count_nonzero(coded) < 2:
        return None
    numbers, place, count = np.unique(words.numbers[coded], return_inverse=True, return_counts=True)
    rows, cells = np.flatnonzero(coded), float(TAU / words.step)
    best: tuple[float, BoolArray] | None = None
    for which in np.flatnonzero(count > 1):
        apart = _different(words.expected.angle[rows[place == which]], words.apart)
        log_p = _log_choices(rows.size, apart) - (apart - 1) * float(np.log(cells))
        if best is None or log_p < best[0]:
            best = log_p, _all_of(words, far, int(numbers[which]))
    return None if best is None else _fault(words, *best)


def _all_of(words: Words, far: BoolArray, code: int) -> BoolArray:
    """Which readings (n,) hold the code in the place of the angle: those that are far off, and those of the others
    that by their share and the noise are more likely the code than an angle that reads it.
    """
    holds = words.usable & (words.numbers == code)
    share = np.count_nonzero(holds & far) / np.count_nonzero(words.usable)
    off, sigma = words.expected.residual, words.expected.sigma
    by_angle = np.minimum(words.step / (np.sqrt(TAU) * sigma), 1.0) * np.exp(-0.5 * (off / sigma) ** 2)
    return np.asarray(holds & (far | (share > _ODDS * (1.0 - share) * by_angle)))


def _held(words: Words, far: BoolArray) -> BoolArray:
    """Which readings (n,) repeat, over any number of rows, one that was as expected: a frame sent again is no code."""
    same = np.concatenate([[False], np.diff(words.numbers) == 0])
    run = np.cumsum(~same) - 1
    first = np.flatnonzero(~same)
    return np.asarray(same & ~far[first][run])


def _different(angle: Array, apart: float) -> int:
    """How many of these angles (m,) [rad] lie at least so far apart, one after the other round the circle."""
    ordered = np.sort(np.mod(angle, TAU))
    count, place = 0, 0
    while place < ordered.size and ordered[place] <= ordered[0] + TAU - apart:
        count, place = count + 1, int(np.searchsorted(ordered, ordered[place] + apart))
    return max(count, 1)


def _log_choices(count: int, some: int) -> float:
    """Log of the number of ways to choose some of so many."""
    return lgamma(count + 1) - lgamma(some + 1) - lgamma(count - some + 1)


def _fault(words: Words, log_p: float, touched: BoolArray) -> WordFault:
    count, readings = int(np.count_nonzero(touched)), int(np.count_nonzero(words.usable))
    share = count / readings
    half = Z95 * float(np.sqrt(share * (1.0 - share) / readings))
    runs: IntArray = np.diff(np.concatenate([[0], touched.astype(np.int64)]))
    values = {
        "fraction_percent": 100.0 * share,
        "reading_deg": round(float(np.degrees(words.measured[touched][0])), 6) % 360.0,
        "run_rows": round(count / int(np.count_nonzero(runs > 0)), 2),
        "word_bits": float(words.bits or 0),
    }
    within = {"fraction_percent": (100.0 * max(share - half, 0.0), 100.0 * min(share + half, 1.0))}
    return WordFault(values, log_p, touched, touched, words.measured, within)


def said(values: Mapping[str, float]) -> str:
    """What stands in the place of the readings."""
    word, reading = derived(values).get("word"), f"{values['reading_deg']:.6g} deg"
    fixed = f"the word {word[0]:.0f} ({reading})" if word is not None else reading
    return f"{fixed} stands in the place of the angle"


def line(values: Mapping[str, float], shown: Mapping[str, str]) -> str:
    """What stands in the place of the readings, of how many, and in how long runs."""
    runs = f", in runs of {shown['run_rows']} readings on average" if "run_rows" in shown else ""
    length = f"; the word has {values['word_bits']:.0f} bits" if "word_bits" in values else ""
    share = f" in {shown['fraction_percent']} of the readings" if "fraction_percent" in shown else ""
    return f"{said(values)}{share}{runs}{length}"


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """The word as a number, where its length is known."""
    bits = int(np.ravel(values.get("word_bits", 0))[0])
    if bits == 0:
        return {}
    word = float(round(float(np.ravel(values["reading_deg"])[0]) / 360.0 * 2**bits) % 2**bits)
    return {"word": (word, word, word, "1")}


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """From some words to one in ten, zero or all ones: their error is any angle, whatever the strength."""
    last = 360.0 * (1.0 - 2.0**-14)
    return {"fraction_percent": span(uniform[:, 0], 1.0, 10.0), "reading_deg": np.where(uniform[:, 1] < 0.5, 0.0, last)}


ERROR_CODE = Effect(
    name="error_code",
    stage="link",
    acts_on="word",
    params={
        "fraction_percent": Param(
            unit="%", null=0.0, lower=0.0, upper=99.0, doc="of the words", role="random", owner="recording"
        ),
        "reading_deg": Param(
            unit="deg", null=0.0, lower=0.0, upper=360.0, doc="what the fixed word reads", role="shape", mirror=1
        ),
        "run_rows": Param(
            unit="row",
            null=1.0,
            lower=1.0,
            upper=1e6,
            doc="readings in a run, on average",
            role="shape",
            owner="recording",
            aside=True,
        ),
        "word_bits": Param(
            unit="bit", null=0, lower=0, upper=40, doc="of the word", role="shape", counts=True, aside=True
        ),
    },
    forward=forward,
    footprint="sequence",
    in_words=InWords(find=find, said=said, line=line, rows_listed=True, several=True),
    repeatable=True,
    drawing=drawing,
    derived=derived,
    source="error flag in the place of data: e.g. AMS AS5047P data sheet, section SPI (an erroneous read returns 0); "
    "a line that floats reads all ones, one that is held low reads 0",
    signature="readings of one value at any angle, alone or in runs",
)
