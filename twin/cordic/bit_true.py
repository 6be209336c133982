"""The arctangent as the silicon computes it, on integers: a vectoring CORDIC, and the table look-up beside it.

Inputs are signed converter codes; angles leave as words of ``angle_bits`` bits, a whole turn being 2^angle_bits.
The half-plane x < 0 is folded by half a turn first, as in :func:`twin.cordic.cordic_truncation.vectoring`.
Source: J. E. Volder, IRE Trans. EC-8 (1959); rounding: Y. H. Hu, IEEE Trans. Signal Processing 40 (1992) 834.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from twin.angles import TAU, Array
from twin.limits import require_within

Codes = NDArray[np.int64]

BLOCK = 1 << 13
SIGN = 63


@dataclass(frozen=True, kw_only=True)
class Cordic:
    """Word lengths of one vectoring unit. The data path holds the input word, one bit of growth and the guard bits."""

    iterations: int = 14
    word_bits: int = 14
    guard_bits: int = 3
    angle_bits: int = 18

    def __post_init__(self) -> None:
        require_within("iterations", self.iterations, 1, 40, whole=True)
        require_within("word_bits", self.word_bits, 1, 32, "bit", whole=True)
        require_within("guard_bits", self.guard_bits, 0, 24, "bit", whole=True)
        require_within("angle_bits", self.angle_bits, 1, 48, "bit", whole=True)

    @property
    def steps(self) -> Codes:
        """The angles atan(2^-k) as angle words (iterations,)."""
        shifts = np.arange(self.iterations, dtype=np.float64)
        return np.round(np.arctan(2.0**-shifts) / TAU * 2.0**self.angle_bits).astype(np.int64)

    @property
    def gain(self) -> float:
        """By how much the iterations lengthen the vector: the product of sqrt(1 + 2^-2k)."""
        shifts = np.arange(self.iterations, dtype=np.float64)
        return float(np.prod(np.sqrt(1.0 + 4.0**-shifts)))

    def bound_rad(self, radius_codes: float) -> float:
        """The largest angle error [rad] against the exact arctangent of the same codes of at least this radius.

        atan(2^-(n-1)) is left by the last micro-rotation. Each shift drops up to one unit of x and of y, a vector of
        up to sqrt(2) units, which turns the vector of ``radius * 2^guard`` units (or longer) by as much; it counts
        twice, once in the angle that was turned and once in what the later rotations can still take up. Each step of
        the table is rounded to half a unit of the angle word.
        """
        left = np.arctan(2.0 ** -(self.iterations - 1))
        dropped = 2.0 * self.iterations * np.sqrt(2.0) / (radius_codes * 2.0**self.guard_bits)
        rounded = 0.5 * self.iterations * TAU / 2.0**self.angle_bits
        return float(left + dropped + rounded)


def vectoring(x: Codes, y: Codes, unit: Cordic) -> tuple[Codes, Codes]:
    """Angle words in [-2^(angle_bits-1), 2^(angle_bits-1)) and magnitudes (times the gain) of codes of any shape.

    The vector of length zero gets the angle that the sign rule happens to give, as in hardware.
    """
    _require_codes(x, y, unit.word_bits)
    flat_x, flat_y = (np.ravel(codes).astype(np.int64) for codes in np.broadcast_arrays(x, y))
    words, magnitudes = np.empty_like(flat_x), np.empty_like(flat_x)
    # In blocks that the processor's cache holds: twice as fast as over the whole array.
    for start in range(0, flat_x.size, BLOCK):
        part = slice(start, start + BLOCK)
        words[part], magnitudes[part] = _iterate(flat_x[part], flat_y[part], unit)
    shape = np.broadcast_shapes(np.shape(x), np.shape(y))
    return words.reshape(shape), magnitudes.reshape(shape)


def _iterate(x: Codes, y: Codes, unit: Cordic) -> tuple[Codes, Codes]:
    """Angle words and magnitudes (n,) of one block."""
    # A mask is -1 where its condition holds, else 0; (v ^ mask) - mask is then -v or v.
    folded = x >> SIGN
    half = 1 << (unit.angle_bits - 1)
    turned = (((half ^ (y >> SIGN)) - (y >> SIGN)) & folded).astype(np.int64)
    # The data path: inputs moved up by the guard bits; shifts are arithmetic, so they round down.
    along, across = (((codes ^ folded) - folded) << unit.guard_bits for codes in (x, y))
    for shift, step in enumerate(unit.steps):
        down = across >> SIGN
        dropped = across >> shift
        across = across - (((along >> shift) ^ down) - down)
        along = along + ((dropped ^ down) - down)
        turned += (step ^ down) - down
    return wrapped(turned, unit.angle_bits), along >> unit.guard_bits


@dataclass(frozen=True, kw_only=True)
class Table:
    """The alternative: atan of a ratio in [0, 1] from a table over one octant, addressed by its leading bits."""

    address_bits: int = 10
    angle_bits: int = 18
    word_bits: int = 14

    def __post_init__(self) -> None:
        require_within("address_bits", self.address_bits, 1, 20, "bit", whole=True)
        require_within("angle_bits", self.angle_bits, 4, 48, "bit", whole=True)
        require_within("word_bits", self.word_bits, 4, 32, "bit", whole=True)

    @property
    def entries(self) -> Codes:
        """atan at the middle of each address's interval, as angle words (2^address_bits + 1,)."""
        count = 1 << self.address_bits
        middle = np.minimum((np.arange(count + 1) + 0.5) / count, 1.0)
        return np.round(np.arctan(middle) / TAU * 2.0**self.angle_bits).astype(np.int64)

    def bound_rad(self) -> float:
        """The largest angle error [rad]: half an interval, atan having slope 1 at most, and half a unit."""
        return float(0.5 / 2**self.address_bits + 0.5 * TAU / 2**self.angle_bits)


def look_up(x: Codes, y: Codes, table: Table) -> Codes:
    """Angle words of codes of any shape by division and table, octants folded by comparison and sign."""
    _require_codes(x, y, table.word_bits)
    a, b = np.abs(x).astype(np.int64), np.abs(y).astype(np.int64)
    steep = b > a
    long, short = np.where(steep, b, a), np.where(steep, a, b)
    ratio = (short << table.address_bits) // np.maximum(long, 1)
    quarter = 1 << (table.angle_bits - 2)
    angle = table.entries[ratio]
    angle = np.where(steep, quarter - angle, angle)
    angle = np.where(x < 0, 2 * quarter - angle, angle)
    return wrapped(np.where(y < 0, -angle, angle), table.angle_bits)


def angle_rad(words: Codes, angle_bits: int) -> Array:
    """Angle words of any shape as angles [rad] in [-pi, pi)."""
    return np.asarray(words * (TAU / 2.0**angle_bits))


def wrapped(words: Codes, angle_bits: int) -> Codes:
    """Angle words of any shape brought to [-2^(angle_bits-1), 2^(angle_bits-1)), as a register does."""
    half = 1 << (angle_bits - 1)
    return np.asarray(((words + half) & ((1 << angle_bits) - 1)) - half, dtype=np.int64)


def _require_codes(x: Codes, y: Codes, word_bits: int) -> None:
    half = 1 << (word_bits - 1)
    for name, codes in (("x", x), ("y", y)):
        require_within(f"code {name}", codes, -half, half - 1, whole=True)
