"""The one description of noise: what is fitted to a residual, and what a twin simulates."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from twin.angles import Array
from twin.noise.row_scale import RowScale
from twin.noise.spectrum import spectrum


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Noise of the angle, in the order of the readings.

    Attributes
    ----------
    rms_rad : float
        RMS [rad] of a reading at which ``scale`` is 1.
    correlation : float
        Of first-order autoregressive noise, from one reading to the next.
    flicker_exponent : float
        Exponent a of 1/f^a noise.
    white_share : float
        Share of the variance that is white beside coloured noise.
    ringing_per_reading, ringing_quality : float
        Frequency [cycles a reading] and quality of a resonance that random knocks keep ringing; frequency 0: none.
    dof : float
        Degrees of freedom of the Student's t distribution of its innovations; infinite: Gaussian.
    scale : RowScale
        How the RMS depends on the conditions of a reading.
    """

    rms_rad: float = 1.0
    correlation: float = 0.0
    flicker_exponent: float = 0.0
    white_share: float = 0.0
    ringing_per_reading: float = 0.0
    ringing_quality: float = 0.0
    dof: float = np.inf
    scale: RowScale = field(default_factory=RowScale)

    @property
    def white(self) -> bool:
        """Whether no reading has anything to do with the one before."""
        return self.correlation == 0.0 and self.flicker_exponent == 0.0 and not self.rings

    @property
    def rings(self) -> bool:
        """Whether a resonance makes a narrow band of it."""
        return self.ringing_per_reading > 0.0

    @property
    def label(self) -> str:
        """Its spectrum in a word."""
        if self.white:
            return "white"
        parts = [f"AR(1) {self.correlation:g}"] if self.correlation else []
        parts += [f"1/f^{self.flicker_exponent:g}"] if self.flicker_exponent else []
        parts += [f"ringing at {self.ringing_per_reading:g} a reading"] if self.rings else []
        return " x ".join(parts) + (f" + {self.white_share:.0%} white" if self.white_share else "")

    def spectrum(self, n: int) -> Array:
        """Spectrum (n,) of mean 1 over the cosine coefficients; see :func:`twin.noise.spectrum.spectrum`."""
        return spectrum(
            n,
            correlation=self.correlation,
            flicker_exponent=self.flicker_exponent,
            white_share=0.0 if self.white else self.white_share,
            ringing=(self.ringing_per_reading, self.ringing_quality),
        )
