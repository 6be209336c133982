"""The converter on integers: one converter for both channels, with the errors of its instants, reference and steps.

Pure functions over arrays: :func:`instants` says when each channel is sampled, the caller evaluates the signal there,
:func:`convert` turns the values into codes. Codes are signed; a full scale of F covers [-F, F).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from twin.angles import TAU, Array
from twin.limits import OutOfRangeError, require_within

Codes = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Converter:
    """The imperfections of one converter; by default it has none.

    ``gap_s``          y is converted this much after x (sequential conversion)
    ``aperture_s``     RMS of the sampling instant's jitter
    ``droop_per_s``    share of the held value lost per second between sampling and conversion of y
    ``reference_rms``  white noise of the reference, relative; ``ripple`` of the reference, relative, at ``ripple_Hz``
    ``noise_rms``      white noise at the input, in the unit of the full scale
    ``inl_lsb``        bow of the transfer curve: its largest deviation, in steps; ``dnl_lsb``: RMS of the step widths
    ``part``           number of this part in its batch: the seed from which its step widths are drawn
    ``stuck_bit``      number of a bit of the offset binary code that stays at ``stuck_at``; None: none does
    ``latency_s``      from the sampling of x to the code
    """

    bits: int = 14
    full_scale: float = 1.25
    gap_s: float = 0.0
    aperture_s: float = 0.0
    droop_per_s: float = 0.0
    reference_rms: float = 0.0
    ripple: float = 0.0
    ripple_Hz: float = 100.0
    noise_rms: float = 0.0
    inl_lsb: float = 0.0
    dnl_lsb: float = 0.0
    part: int = 0
    stuck_bit: int | None = None
    stuck_at: int = 0
    latency_s: float = 0.0

    def __post_init__(self) -> None:
        require_within("bits", self.bits, 1, 20, "bit", whole=True)
        require_within("full_scale", self.full_scale, 1e-6, 1e6)
        for name, upper, unit in (
            ("gap_s", 1.0, "s"),
            ("aperture_s", 1.0, "s"),
            ("droop_per_s", 1e6, "1/s"),
            ("reference_rms", 0.5, ""),
            ("ripple", 0.5, ""),
            ("ripple_Hz", 1e9, "Hz"),
            ("noise_rms", self.full_scale, ""),
            ("dnl_lsb", 0.3, "LSB"),
            ("latency_s", 1.0, "s"),
        ):
            require_within(name, getattr(self, name), 0.0, upper, unit)
        require_within("inl_lsb", self.inl_lsb, -(2.0 ** (self.bits - 2)), 2.0 ** (self.bits - 2), "LSB")
        require_within("stuck_at", self.stuck_at, 0, 1, whole=True)
        if self.stuck_bit is not None:
            require_within("stuck_bit", self.stuck_bit, 0, self.bits - 1, whole=True)

    @property
    def step(self) -> float:
        """Width of an ideal step, in the unit of the full scale."""
        return 2.0 * self.full_scale / 2.0**self.bits

    @cached_property
    def transitions(self) -> Array:
        """Inputs at which the code goes up by one (2^bits - 1,), rising, in the unit of the full scale.

        The bow is u - u^3 over the range u in [-1, 1], scaled to its largest value; the ends stay.
        """
        ideal = np.arange(-(2 ** (self.bits - 1)) + 1, 2 ** (self.bits - 1)) - 0.5
        u = ideal / 2.0 ** (self.bits - 1)
        bow = self.bow(u)
        widths = np.random.default_rng(self.part).standard_normal(ideal.size) * self.dnl_lsb
        walk = np.cumsum(widths)
        # Through both ends, as a trimmed converter's curve goes: a bridge instead of a walk.
        walk -= np.linspace(0.0, walk[-1], ideal.size)
        return np.asarray(np.maximum.accumulate(ideal + bow + walk) * self.step)

    def bow(self, u: Array) -> Array:
        """How much too high its curve lies, in steps, at inputs (any shape) in full scales."""
        return np.asarray(self.inl_lsb * (u - u**3) / (2.0 / np.sqrt(27.0)))


def instants(time_s: Array, converter: Converter, rng: np.random.Generator | None = None) -> Array:
    """When x and y are sampled (2, n) [s], for conversions started at ``time_s`` (n,)."""
    start = np.stack([time_s, time_s + converter.gap_s])
    if rng is None or converter.aperture_s == 0.0:
        return start
    return np.asarray(start + converter.aperture_s * rng.standard_normal(start.shape))


def convert(values: Array, at_s: Array, converter: Converter, rng: np.random.Generator | None = None) -> Codes:
    """Codes (2, n) of the values (2, n) held at the instants (2, n) [s]; without a generator nothing random acts."""
    # y waits for x to be converted, and its held value droops meanwhile.
    held = values * np.array([[1.0], [1.0 - converter.droop_per_s * converter.gap_s]])
    if rng is not None and converter.noise_rms > 0.0:
        held = held + converter.noise_rms * rng.standard_normal(held.shape)
    reference = 1.0 + converter.ripple * np.cos(TAU * converter.ripple_Hz * at_s)
    if rng is not None and converter.reference_rms > 0.0:
        reference = reference + converter.reference_rms * rng.standard_normal(held.shape)
    seen = held / reference
    half = 2 ** (converter.bits - 1)
    if converter.inl_lsb == 0.0 and converter.dnl_lsb == 0.0:
        codes = np.clip(np.floor(seen / converter.step + 0.5), -half, half - 1).astype(np.int64)
    else:
        codes = np.searchsorted(converter.transitions, seen, side="right").astype(np.int64) - half
    if converter.stuck_bit is not None:
        offset_binary = codes + half
        mask = 1 << converter.stuck_bit
        codes = ((offset_binary | mask) if converter.stuck_at else (offset_binary & ~mask)) - half
    return np.asarray(codes, dtype=np.int64)


def sample(
    signal: Callable[[Array], Array],
    time_s: Array,
    converter: Converter,
    rng: np.random.Generator | None = None,
) -> tuple[Codes, Array]:
    """Codes (2, n) of a signal, a function from instants (2, n) [s] to values (2, n), and when they are ready (n,)."""
    at = instants(time_s, converter, rng)
    return convert(signal(at), at, converter, rng), time_s + converter.latency_s


def linearity(converter: Converter) -> tuple[Array, Array]:
    """INL (2^bits - 1,) and DNL (2^bits - 2,) in steps, through the end points (IEEE Std 1241)."""
    if converter.bits < 2:
        raise OutOfRangeError("bits is 1 bit; expected at least 2 bit for a linearity")
    levels = converter.transitions
    step = (levels[-1] - levels[0]) / (levels.size - 1)
    inl = (levels - levels[0]) / step - np.arange(levels.size)
    return np.asarray(inl), np.asarray(np.diff(levels) / step - 1.0)
