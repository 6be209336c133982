"""The noises that a search chooses among: a coarse grid of spectra, from white to strongly correlated and 1/f.

Whitening is a weight on each cosine coefficient, so that every spectrum of the family costs one weighted sum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from twin.angles import Array
from twin.noise.description import Noise

MEMBERS = (
    Noise(),
    *(Noise(correlation=phi) for phi in (0.35, 0.6, 0.75, 0.85, 0.92, 0.97)),
    *(Noise(correlation=phi, white_share=0.5) for phi in (0.6, 0.85, 0.95)),
    *(Noise(correlation=phi, white_share=0.8) for phi in (0.9, 0.98)),
    Noise(flicker_exponent=0.5),
    *(Noise(flicker_exponent=1.0, white_share=share) for share in (0.0, 0.3, 0.6)),
)


@dataclass(frozen=True, eq=False)
class NoiseFamily:
    """Noises, and their spectra (members, n) of mean 1 over the cosine coefficients of a sequence.

    ``colour_log_odds`` are those of white noise against each coloured one before a reading is seen.
    """

    members: tuple[Noise, ...]
    spectra: Array
    colour_log_odds: float

    @property
    def labels(self) -> tuple[str, ...]:
        """What to call each member."""
        return tuple(noise.label for noise in self.members)

    @cached_property
    def weights(self) -> Array:
        """Inverse spectra (members, n)."""
        return np.asarray(1.0 / self.spectra)

    def cost(self, rows: int) -> Array:
        """What each member (members,) adds to minus twice the log likelihood of so many rows in use.

        The log determinant of its covariance, and the prior odds: colour is what readings must show.
        """
        odds = np.array([0.0 if noise.white else 2.0 * self.colour_log_odds for noise in self.members])
        return np.asarray(self._log_determinants * (rows / self.spectra.shape[1]) + odds)

    @cached_property
    def _log_determinants(self) -> Array:
        """Log determinants (members,) of all rows' covariance."""
        return np.array([log_determinant(spectrum, spectrum.size) for spectrum in self.spectra])

    def with_(self, noise: Noise, spectrum: Array) -> NoiseFamily:
        """The family with another noise, of this spectrum (n,), as its last member."""
        return replace(self, members=(*self.members, noise), spectra=np.concatenate([self.spectra, spectrum[None]]))

    def white_alone(self) -> NoiseFamily:
        """The family of white noise only."""
        return replace(self, members=self.members[:1], spectra=self.spectra[:1])


def log_determinant(spectrum: Array, rows: int) -> float:
    """Log determinant of the covariance of so many rows in use of a sequence with this spectrum (n,).

    Masked rows take their share of it with them: left in, it would favour the steeper spectra.
    """
    return float(np.sum(np.log(spectrum))) * (rows / spectrum.size)


def noise_family(
    lengths: Sequence[int],
    colour_log_odds: float,
    *,
    motion: Array | float = 0.0,
    members: tuple[Noise, ...] = MEMBERS,
) -> NoiseFamily:
    """The family for sequences of so many readings, one behind the other and independent of each other.

    ``motion`` (n,) is the spectrum of what the shaft may have done beside the noise, where no reference was recorded.
    """
    spectra = [np.concatenate([noise.spectrum(n) for n in lengths]) + motion for noise in members]
    return NoiseFamily(members, np.stack(spectra), colour_log_odds)
