"""What the discard rule (Eq. 11) did to a fit, and whether the fitted curve itself keeps the band Delta E (Eq. 7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from diagnosis.error_model.result import BaselineFit


@dataclass(frozen=True)
class BandCheck:
    """Delta E [deg]; how many of the particles were discarded; how many readings leave the band about the fit.

    ``largest_deg`` is the largest distance of a reading from the fit. Gross errors, left out, do not count.
    """

    delta_e_deg: float
    particles_discarded: int
    readings_outside: int
    largest_deg: float


def band_check(fit: BaselineFit, band_rad: float) -> BandCheck:
    """The check of one fit."""
    apart = np.abs(fit.residual_rad[~fit.outliers])
    return BandCheck(
        delta_e_deg=float(np.degrees(band_rad)),
        particles_discarded=fit.contributions.particles_discarded,
        readings_outside=int(np.count_nonzero(apart > band_rad)),
        largest_deg=float(np.degrees(np.max(apart, initial=0.0))),
    )
