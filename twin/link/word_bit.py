"""word_bit: one bit of the angle word is stuck, or counts as its neighbour."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from twin.angles import TAU, Array, IntArray, wrap
from twin.drawing import whole
from twin.effect import BoolArray, Effect, Param, Parameters
from twin.motion import Motion
from twin.words import MISSED, Alike, Expected, InWords, WordFault, Words

LENGTH = 14
"""Word length where none is known."""
_TOLD_SIGMA = 6.0
"""Standard deviations that a bit must be worth for a reading to say what it would be without the fault."""
_PHASES = 64
_SPREAD = np.linspace(-2.0, 2.0, 9)
_SAMPLE = 500
_GAIN = 8.0
"""Nats by which the readings must be likelier with the fault, whatever words never occur: angles of a bench may keep
clear of some (e^-8: 3 in 10,000)."""
_ALIKE = 1.0
"""Nats between likelihoods that are as good as the same."""


@dataclass(frozen=True)
class Fault:
    """One way in which a bit errs.

    ``sent`` makes words of words and a bit; ``moved`` are the differences, in halves of the bit's weight, that it
    makes: by these the words that may have been there before are found.
    """

    level: float
    into: float
    joined: float
    sent: Callable[[IntArray, IntArray], IntArray]
    moved: tuple[int, ...]

    @property
    def values(self) -> dict[str, float]:
        """Its parameters."""
        return {"level": self.level, "into": self.into, "joined": self.joined}


def _one(words: IntArray, bit: IntArray) -> IntArray:
    """The bit of each word."""
    return np.asarray((words >> bit) & 1)


def _worth(bit: IntArray) -> IntArray:
    return np.asarray(np.left_shift(1, bit))


def _cleared(words: IntArray, bit: IntArray) -> IntArray:
    return np.asarray(words - _one(words, bit) * _worth(bit))


FAULTS: tuple[Fault, ...] = (
    Fault(0.0, 0.0, 0.0, _cleared, (0, -2)),
    Fault(1.0, 0.0, 0.0, lambda words, bit: np.asarray(words | _worth(bit)), (0, 2)),
    Fault(0.0, 1.0, 0.0, lambda words, bit: words + _one(words, bit) * _worth(bit), (0, 2)),
    Fault(0.0, 1.0, 1.0, lambda words, bit: _cleared(words, bit) | (_one(words, bit) * _worth(bit + 1)), (0, 2, -2)),
    Fault(0.0, -1.0, 0.0, lambda words, bit: words - _one(words, bit) * (_worth(bit) >> 1), (0, -1)),
    Fault(0.0, -1.0, 1.0, lambda words, bit: _cleared(words, bit) | (_one(words, bit) * _worth(bit) >> 1), (0, -1, -2)),
)
"""Stuck at 0, stuck at 1, and counted as the next higher or lower bit: its weight added to that bit's, or joined by or.
"""


def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
    bit, length, level, into, joined = (
        np.round(np.asarray(values[name], dtype=np.float64)).astype(np.int64)
        for name in ("bit", "word_bits", "level", "into", "joined")
    )
    count = np.left_shift(1, length)
    step = TAU / count
    words = np.round(signal / step).astype(np.int64) % count
    safe = np.maximum(bit, 0)
    moved: IntArray = np.zeros(np.broadcast_shapes(words.shape, safe.shape), dtype=np.int64)
    for fault in FAULTS:
        own = (level == fault.level) & (into == fault.into) & (joined == fault.joined)
        moved = np.where(own, fault.sent(words, safe) - words, moved)
    return np.where(bit >= 0, signal + moved * step, signal)


# ---- telling it -----------------------------------------------------------------------------------------------------


def find(words: Words) -> WordFault | None:
    """The bit and its fault that make the readings likeliest, of those whose words that never occur do not occur.

    Chance: without the fault, words would have stood where the smooth error leads one to expect some that never occur;
    angles that are alike but for whole periods of the bit count once. A bit that counts twice sends the same words as
    one that is held at 0, but for its weight in the zero: of faults that are as likely a bit that is held is told, in
    which one thing alone is wrong, and the others beside it.
    """
    if words.bits is None or not words.usable.any():
        return None
    told: list[_Told] = []
    plain = words.expected.log_likelihood(words.usable)
    tries = words.bits * len(FAULTS)
    for fault, bit, before in _possible(words, words.bits):
        expected = words.of_candidates(before)
        log_p = _log_p(words, fault, bit, expected) + float(np.log(tries))
        choices = np.count_nonzero(~np.isnan(before), axis=0)[words.usable]
        likely = expected.log_likelihood(words.usable) - float(np.sum(np.log(choices)))
        if log_p < 0.0 and likely > plain + _GAIN:
            told.append(_Told(likely, log_p, fault, bit, _smaller_zero(fault, bit, words.bits, expected)))
    most = max((one.likely for one in told), default=0.0)
    alike = [one for one in told if one.likely >= most - _ALIKE]
    if not alike:
        return None
    first = min(alike, key=lambda one: (one.fault.into != 0.0, abs(float(wrap(one.expected.zero)))))
    return _fault(words, first, [one for one in alike if one is not first])


@dataclass(frozen=True, eq=False)
class _Told:
    """A bit and its fault: how likely the readings are with it, and what is expected of them then."""

    likely: float
    log_p: float
    fault: Fault
    bit: int
    expected: Expected


def _half_open(fault: Fault, bit: int, length: int) -> bool:
    """Whether the words are the same half a turn further: the highest bit is held."""
    return bit == length - 1 and fault.into == 0.0


def _smaller_zero(fault: Fault, bit: int, length: int, expected: Expected) -> Expected:
    """What is expected, with the smaller of two zeros where the words leave half a turn open."""
    if not _half_open(fault, bit, length) or abs(float(wrap(expected.zero))) <= TAU / 4.0:
        return expected
    half = TAU / 2.0
    angle, chosen = wrap(expected.angle + half), np.mod(expected.chosen + half, TAU)
    return replace(expected, angle=angle, chosen=chosen, zero=float(wrap(expected.zero + half)))


def _possible(words: Words, length: int) -> Iterator[tuple[Fault, int, Array]]:
    """Faults and bits that hardly any word contradicts, with the angles (c, n) [rad] that may have been before them.

    A bit below which none changes is no fault: such a word is shorter than it looks.
    """
    numbers = words.numbers[words.usable]
    sample = numbers[:: max(numbers.size // _SAMPLE, 1)]
    changing = False
    for bit in range(length):
        # Beyond the highest bit is none as which it could count.
        for fault in [one for one in FAULTS if bit + one.into < length] if changing else ():
            if np.mean(_before(fault, sample, bit, length)[1]) > 2.0 * MISSED:
                continue
            before, never = _before(fault, words.numbers, bit, length)
            if np.mean(never[words.usable]) <= MISSED:
                yield fault, bit, np.where(before < 0, np.nan, before * words.step)
        changing |= bool(MISSED < np.mean(_one(sample, np.asarray(bit))) < 1.0 - MISSED)


def _before(fault: Fault, numbers: IntArray, bit: int, length: int) -> tuple[IntArray, BoolArray]:
    """The words (c, n) that may have been sent as these, -1 for none; and which (n,) never occur: they stay."""
    count, at = 1 << length, np.asarray(bit)
    moved = np.array(fault.moved)[:, None] * ((1 << bit) / 2.0)
    before = (numbers - np.round(moved).astype(np.int64)) % count
    before = np.where(fault.sent(before, at) % count == numbers, before, -1)
    never = np.asarray(np.all(before < 0, axis=0))
    before[0] = np.where(never, numbers, before[0])
    return before, never


def _log_p(words: Words, fault: Fault, bit: int, expected: Expected) -> float:
    """Log probability that words without the fault would so rarely be those that never occur with it."""
    assert words.bits is not None
    angle = expected.angle[words.usable]
    around = np.round((angle + expected.sigma * _SPREAD[:, None]) / words.step).astype(np.int64) % (1 << words.bits)
    chance = np.mean([_before(fault, row, bit, words.bits)[1] for row in around], axis=0)
    period = words.step * (1 << (bit + 2))
    phase = (np.mod(angle, period) * (_PHASES / period)).astype(np.int64) % _PHASES
    rows = np.bincount(phase, minlength=_PHASES)
    mean = np.bincount(phase, chance, minlength=_PHASES)[rows > 0] / rows[rows > 0]
    missed = float(np.count_nonzero(_before(fault, words.numbers[words.usable], bit, words.bits)[1]))
    return float(np.sum(np.log(np.maximum(1.0 - mean, MISSED)))) - missed * float(np.log(MISSED))


def _fault(words: Words, first: _Told, others: Sequence[_Told]) -> WordFault:
    """What the fault did: readings that a bit worth more than the noise has changed are told back."""
    expected, length = first.expected, words.bits or LENGTH
    told = words.step * (1 << first.bit) > _TOLD_SIGMA * expected.sigma
    chosen = np.where(words.usable, expected.chosen, words.measured)
    touched = np.abs(wrap(chosen - words.measured)) > 0.5 * words.step
    decoded = chosen if told else words.measured
    values = _values(first, length)
    alike = [
        Alike(said(_values(one, length)), float(np.median(wrap(one.expected.chosen - chosen)[words.usable])))
        for one in others
    ]
    if _half_open(first.fault, first.bit, length):
        alike.append(Alike(f"{said(values)}, with the shaft half a turn further on", TAU / 2.0))
    lost = np.zeros(len(words), dtype=bool)
    return WordFault(values, first.log_p, touched & words.usable, lost, decoded, alike=tuple(alike) if told else ())


def _values(told: _Told, length: int) -> dict[str, float]:
    return {"bit": float(told.bit), "word_bits": float(length), **told.fault.values}


def said(values: Mapping[str, float]) -> str:
    """What the bit does."""
    bit, into = int(values["bit"]), int(values.get("into", 0.0))
    how = "joined to it by or" if values.get("joined") else "added to it"
    does = f"is read into bit {bit + into} ({how})" if into else f"is stuck at {values['level']:.0f}"
    return f"bit {bit} of the {values['word_bits']:.0f}-bit word {does}"


def line(values: Mapping[str, float], shown: Mapping[str, str]) -> str:
    """What the bit does, and what it is worth."""
    return f"{said(values)}; the bit is worth {shown['worth_deg']}"


def derived(values: Parameters) -> Mapping[str, tuple[float, float, float, str]]:
    """What the bit is worth."""
    bit, length = (float(np.ravel(values[name])[0]) for name in ("bit", "word_bits"))
    worth = 360.0 * 2.0 ** (bit - length) if bit >= 0.0 else 0.0
    return {"worth_deg": (worth, worth, worth, "deg")}


def drawing(strength_deg: Array, uniform: Array, motion: Motion) -> Mapping[str, Array]:
    """Any but the lowest two bits, stuck at either level: its error is that of the bit, whatever the strength."""
    return {"bit": whole(uniform[:, 0], 2, LENGTH - 1), "level": np.where(uniform[:, 1] < 0.5, 0.0, 1.0)}


def _shape(null: float, doc: str, *, lower: float, upper: float, unit: str = "1", aside: bool = False) -> Param:
    return Param(unit=unit, null=null, lower=lower, upper=upper, doc=doc, role="shape", counts=True, aside=aside)


WORD_BIT = Effect(
    name="word_bit",
    stage="link",
    acts_on="word",
    params={
        "bit": Param(
            unit="bit", null=-1, lower=-1, upper=30, doc="number, the lowest is 0; -1: none", role="level", counts=True
        ),
        "word_bits": _shape(LENGTH, "of the word", lower=5, upper=31, unit="bit"),
        "level": _shape(0.0, "stuck at", lower=0.0, upper=1.0),
        "into": _shape(
            0.0, "1: counts as the next higher bit, -1: as the next lower one", lower=-1.0, upper=1.0, aside=True
        ),
        "joined": _shape(0.0, "1: joined to that by or, 0: added", lower=0.0, upper=1.0, aside=True),
    },
    forward=forward,
    footprint="sequence",
    in_words=InWords(find=find, said=said, line=line),
    drawing=drawing,
    derived=derived,
    source="stuck-at fault of a line or register bit: M. Abramovici, M. Breuer, A. Friedman, Digital Systems Testing "
    "and Testable Design (1990), chapter 4; a neighbour's by a wrong mask or shift in the driver",
    signature="words that never occur; an error of 0 or 360/2^k deg",
)
