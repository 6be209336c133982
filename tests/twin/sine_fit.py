"""SINAD and ENOB by the sine fit, as IEEE Std 1241 (terminology and test methods for converters) defines them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from twin.angles import TAU, Array


@dataclass(frozen=True)
class SineFit:
    """offset + amplitude cos(2 pi f t + phase), and the RMS of what it leaves, all in the record's unit."""

    amplitude: float
    frequency_Hz: float
    phase_rad: float
    offset: float
    residual_rms: float

    @property
    def sinad_db(self) -> float:
        """RMS of the sine over RMS of noise and distortion [dB]."""
        return float(20.0 * np.log10(self.amplitude / np.sqrt(2.0) / self.residual_rms))

    def enob(self, full_scale_range: float) -> float:
        """Effective number of bits: the bits of an ideal converter of this range that leaves as much."""
        return float(np.log2(full_scale_range / (np.sqrt(12.0) * self.residual_rms)))


def fit_sine(record: Array, rate_Hz: float, frequency_Hz: float, *, known: bool = False) -> SineFit:
    """Fit a sine to a record (n,) sampled at ``rate_Hz``, from a first guess of its frequency.

    Three parameters where the frequency is ``known``, else four: the frequency is improved by Gauss-Newton steps.
    """
    # Counted from the middle, so that the frequency is nearly independent of the other parameters.
    time = (np.arange(record.size) - 0.5 * (record.size - 1)) / rate_Hz
    frequency = frequency_Hz
    for _ in range(1 if known else 6):
        c, s = np.cos(TAU * frequency * time), np.sin(TAU * frequency * time)
        columns = [c, s, np.ones_like(time)]
        if not known:
            a, b = np.linalg.lstsq(np.stack(columns, axis=-1), record, rcond=None)[0][:2]
            columns.append(TAU * time * (-a * s + b * c))
        solved = np.linalg.lstsq(np.stack(columns, axis=-1), record, rcond=None)[0]
        if not known:
            frequency += float(solved[3])
    c, s = np.cos(TAU * frequency * time), np.sin(TAU * frequency * time)
    design = np.stack([c, s, np.ones_like(time)], axis=-1)
    a, b, offset = np.linalg.lstsq(design, record, rcond=None)[0]
    left = record - design @ np.array([a, b, offset])
    return SineFit(
        amplitude=float(np.hypot(a, b)),
        frequency_Hz=float(frequency),
        phase_rad=float(np.arctan2(-b, a)),
        offset=float(offset),
        residual_rms=float(np.sqrt(np.mean(left**2))),
    )


def ideal_sinad_db(bits: int) -> float:
    """A full-scale sine over the noise of rounding: 20 log10(2^N sqrt(3/2)), the 6.02 N + 1.76 dB of the books."""
    return float(20.0 * np.log10(2.0**bits * np.sqrt(1.5)))


def jitter_sinad_db(frequency_Hz: float, aperture_s: float) -> float:
    """A sine of this frequency over the noise that jitter of its sampling instants makes: -20 log10(2 pi f t)."""
    return float(-20.0 * np.log10(TAU * frequency_Hz * aperture_s))
