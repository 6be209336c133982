"""A table in C of one's own firmware: 16-bit words in and out, whole numbers only, entries of 16 bit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.correction.compensation_c import check_prefix
from diagnosis.correction.straight_lines import Least, Nodes, best_values
from diagnosis.correction.targets.target import Target, c_comment, constant_of, numbers_of, rows
from diagnosis.correction.wanted import Wanted
from twin.angles import TAU, Array, IntArray

TURN = 65536
LARGEST = 32767
FINEST = 8
"""Most bits by which an entry counts in less than the word."""

_TEMPLATE = """\
{comment}#ifndef {upper}_TABLE_H
#define {upper}_TABLE_H

#include <stdint.h>

#define {upper}_ENTRIES {entries}u
/* An entry counts in 2^-(16 + SHIFT) turn. */
#define {upper}_SHIFT {shift}u
#define {upper}_ZERO {zero}u
#define {upper}_SENSE {sense}

static const int16_t {name}_entry[{entries}] = {{
    {listed}
}};

/* Shaft angle of a reading; a turn is 2^16. */
static inline uint16_t {name}_shaft(uint16_t reading)
{{
    const uint32_t place = (uint32_t)reading * {upper}_ENTRIES;
    const uint32_t left = place >> 16;
    const uint32_t right = left + 1u == {upper}_ENTRIES ? 0u : left + 1u;
    const int64_t share = (int64_t)(place & 0xffffu);
    /* A turn and half a word are added: what is shifted is positive, and rounded. */
    const int64_t sum = {name}_entry[left] * (65536 - share) + {name}_entry[right] * share
                        + ((int64_t)131073 << (15u + {upper}_SHIFT));
    const uint32_t added = (uint32_t)((uint64_t)sum >> (16u + {upper}_SHIFT));
    return (uint16_t)({counted} - {upper}_ZERO + added);
}}

#endif
"""


@dataclass(frozen=True, eq=False)
class Words:
    """A correction in whole numbers: finest unit, zero word and sense, and what a table is to add in shaft's sense."""

    shift: int
    zero: int
    sense: int
    unit_rad: float

    @classmethod
    def of(cls, wanted: Wanted) -> tuple[Words, float]:
        """The finest unit in which a correction fits, and the rest of the zero [rad] that the table adds."""
        largest = float(np.max(np.abs(wanted.added(TAU * np.arange(1024) / 1024)))) / TAU * TURN
        shift = int(np.clip(np.floor(np.log2(0.9 * LARGEST / (largest + 2.0))), 0, FINEST))
        zero = wanted.zero_rad / TAU * TURN
        words = cls(shift, round(zero) % TURN, wanted.slope, TAU / TURN / 2**shift)
        return words, (round(zero) - zero) * TAU / TURN

    @classmethod
    def read(cls, text: str) -> Words:
        """Those that a header names."""
        shift, zero, sense = (constant_of(text, name) for name in ("SHIFT", "ZERO", "SENSE"))
        return cls(shift, zero, sense, TAU / TURN / 2**shift)

    def header(self, about: Sequence[str], name: str) -> dict[str, str]:
        """What a C file says of them and of itself. Raises UserError for a name that no C name begins with."""
        check_prefix(name)
        return {
            "comment": c_comment(about),
            "name": name,
            "upper": name.upper(),
            "shift": str(self.shift),
            "zero": str(self.zero),
            "sense": f"({self.sense})",
            "counted": "(uint32_t)reading" if self.sense > 0 else "0u - reading",
        }

    def shaft(self, word: IntArray, scaled: IntArray, bits: int) -> IntArray:
        """Shaft words of reading words, and of what is added in units of ``bits`` below the word; rounded."""
        added = ((scaled + (TURN << bits) + (1 << bits >> 1)) >> bits) % TURN
        return (self.sense * word - self.zero + added) % TURN


def word_of(reading_rad: Array) -> IntArray:
    """The nearest word of readings [rad]."""
    return np.round(np.asarray(reading_rad) / TAU * TURN).astype(np.int64) % TURN


@dataclass(frozen=True, eq=False)
class CTable:
    """Entries (n,) that are added to the shaft angle, at even steps of the reading."""

    entry: IntArray
    words: Words

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> CTable:
        """The best table of so many entries."""
        words, rest = Words.of(wanted)
        values = best_values(Nodes.even(entries), lambda at: wanted.slope * wanted.added(at) + rest, least)
        return cls(np.round(values / words.unit_rad).astype(np.int64), words)

    @classmethod
    def read(cls, text: str) -> CTable:
        """The table of a file."""
        entry = numbers_of(text, "entry").astype(np.int64)
        return cls(entry, Words.read(text))

    def __len__(self) -> int:
        return int(self.entry.size)

    def of_words(self, word: IntArray) -> IntArray:
        """What the C makes of words."""
        place = word * len(self)
        left, share = place >> 16, place & 0xFFFF
        sum_of = self.entry[left] * (TURN - share) + self.entry[(left + 1) % len(self)] * share
        return self.words.shaft(word, sum_of, 16 + self.words.shift)

    def corrected(self, reading_rad: Array) -> Array:
        """What the C makes of the nearest words."""
        return np.asarray(TAU / TURN * self.of_words(word_of(reading_rad)), dtype=np.float64)

    def text(self, about: Sequence[str], name: str) -> str:
        """The header. Raises UserError for a name that no C name begins with."""
        listed = rows([str(value) for value in self.entry], 12)
        return _TEMPLATE.format(**self.words.header(about, name), entries=len(self), listed=listed)


TARGET = Target(
    name="c",
    what="C of one's own: a header of whole numbers, 16-bit words in and out",
    ending=".h",
    axis="entry k at k/n of a turn of the sensor's own reading",
    sign="added to SENSE x reading - ZERO, linear in between",
    unit="2^-(16 + SHIFT) turn",
    entries=64,
    absolute=True,
    fitted=CTable.fitted,
    read=CTable.read,
    load="include it and call NAME_shaft(reading); a turn is 2^16 on both sides",
)
