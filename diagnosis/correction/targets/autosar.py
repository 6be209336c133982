"""A curve as AUTOSAR's fixed-point interpolation takes it: two arrays of signed 16 bit, the points where one likes.

Between the points about x lies y0 + (y1 - y0) (x - x0) / (x1 - x0) in whole numbers, cut towards zero; beyond the first
and the last point their values (specification of fixed point interpolation routines, integrated curve s16 of s16). As
the points are free, they stand closer where the curve bends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.correction.straight_lines import Least, Nodes, best_values, spread_nodes
from diagnosis.correction.targets.c_table import TURN, Words, word_of
from diagnosis.correction.targets.target import Target, numbers_of, rows
from diagnosis.correction.wanted import Wanted
from twin.angles import TAU, Array, IntArray

_HALF = TURN // 2

_TEMPLATE = """\
{comment}#ifndef {upper}_CURVE_H
#define {upper}_CURVE_H

#include <stdint.h>

#define {upper}_POINTS {points}u
/* A value counts in 2^-(16 + SHIFT) turn. */
#define {upper}_SHIFT {shift}u
#define {upper}_ZERO {zero}u
#define {upper}_SENSE {sense}

/* Axis: the reading as a signed word. Values: what is added to the shaft angle. */
static const int16_t {name}_x[{points}] = {{
    {x}
}};
static const int16_t {name}_y[{points}] = {{
    {y}
}};

/* As an integrated curve look-up of s16 by s16. */
static inline int16_t {name}_curve(int16_t x)
{{
    uint32_t k = 0u;
    if (x <= {name}_x[0])
        return {name}_y[0];
    if (x >= {name}_x[{upper}_POINTS - 1u])
        return {name}_y[{upper}_POINTS - 1u];
    while (x >= {name}_x[k + 1u])
        ++k;
    return (int16_t)({name}_y[k] + (int64_t)({name}_y[k + 1u] - {name}_y[k]) * (x - {name}_x[k])
                                       / ({name}_x[k + 1u] - {name}_x[k]));
}}

/* Shaft angle of a reading; a turn is 2^16. */
static inline uint16_t {name}_shaft(uint16_t reading)
{{
    const int32_t x = reading < 32768u ? (int32_t)reading : (int32_t)reading - 65536;
    /* A turn and half a word are added: what is shifted is positive, and rounded. */
    const uint32_t sum = (uint32_t)({name}_curve((int16_t)x) + ((int32_t)65536 << {upper}_SHIFT)
                                    + (((int32_t)1 << {upper}_SHIFT) >> 1));
    return (uint16_t)({counted} - {upper}_ZERO + (sum >> {upper}_SHIFT));
}}

#endif
"""


@dataclass(frozen=True, eq=False)
class Autosar:
    """Points (n,) of the curve: signed words of the reading, and what is added there."""

    x: IntArray
    y: IntArray
    words: Words

    @classmethod
    def fitted(cls, wanted: Wanted, entries: int, least: Least) -> Autosar:
        """The best curve of so many points."""
        words, rest = Words.of(wanted)

        def curve(at: Array) -> Array:
            return wanted.slope * wanted.added(at) + rest

        unit = TAU / TURN
        at = np.round(spread_nodes(curve, entries, -np.pi, np.pi - unit).at_rad / unit).astype(np.int64)
        values = best_values(Nodes(np.asarray(at * unit, dtype=np.float64), closed=False), curve, least)
        return cls(at, np.round(values / words.unit_rad).astype(np.int64), words)

    @classmethod
    def read(cls, text: str) -> Autosar:
        """The curve of a file."""
        x, y = (numbers_of(text, axis).astype(np.int64) for axis in "xy")
        return cls(x, y, Words.read(text))

    def __len__(self) -> int:
        return int(self.x.size)

    def of_words(self, word: IntArray) -> IntArray:
        """What the C makes of words."""
        x = np.clip(np.where(word < _HALF, word, word - TURN), self.x[0], self.x[-1])
        k = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(self) - 2)
        rise, run = self.y[k + 1] - self.y[k], self.x[k + 1] - self.x[k]
        product = rise * (x - self.x[k])
        added = self.y[k] + np.sign(product) * (np.abs(product) // run)
        return self.words.shaft(word, added, self.words.shift)

    def corrected(self, reading_rad: Array) -> Array:
        """What the C makes of the nearest words."""
        return np.asarray(TAU / TURN * self.of_words(word_of(reading_rad)), dtype=np.float64)

    def text(self, about: Sequence[str], name: str) -> str:
        """The header. Raises UserError for a name that no C name begins with."""
        return _TEMPLATE.format(
            **self.words.header(about, name),
            points=len(self),
            x=rows([str(value) for value in self.x], 12),
            y=rows([str(value) for value in self.y], 12),
        )


TARGET = Target(
    name="autosar",
    what="a curve as AUTOSAR's fixed-point interpolation takes it (s16 of s16), with C that does the same",
    ending=".h",
    axis="points where the curve needs them, on the sensor's own reading as a signed word",
    sign="added to SENSE x reading - ZERO, linear in between",
    unit="2^-(16 + SHIFT) turn",
    entries=32,
    most=1024,
    absolute=True,
    fitted=Autosar.fitted,
    read=Autosar.read,
    load="take the two arrays into the curve's calibration parameters, or include the header and call "
    "NAME_shaft(reading)",
)
