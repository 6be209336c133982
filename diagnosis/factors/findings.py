"""Everything the diagnoser says about one sweep, in one object: fit, identifiability, equivalents, raw channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from diagnosis.error_model.fit import BATCH, fit_equal
from diagnosis.error_model.model import Readings
from diagnosis.error_model.result import BaselineFit
from diagnosis.factors import channels
from diagnosis.factors.air_gaps import GapSweep, Law, laws
from diagnosis.factors.band_check import BandCheck, band_check
from diagnosis.factors.channels import Added
from diagnosis.factors.identifiability import Identifiability, identifiability
from diagnosis.factors.mechanical import Mechanical, mechanical
from diagnosis.factors.repeats import between_angles
from diagnosis.progress import Count
from twin.angles import Array, radians
from twin.sweep import Sweep

DEFAULT_SEED = 0


@dataclass(frozen=True, eq=False)
class Findings:
    """One diagnosed sweep. ``added`` is None without raw channels."""

    sweep: Sweep
    fit: BaselineFit
    identifiability: Identifiability
    added: Added | None
    repeated: str | None
    """What repeated readings did to the intervals, in words."""
    band: BandCheck | None = None
    """What the discard rule did, where a band was given."""

    def __repr__(self) -> str:
        return f"Findings({self.sweep.name!r}, {self.fit!r})"

    @cached_property
    def mechanical(self) -> Mechanical:
        """The mechanical causes that would make the same curve, for the twin's magnet."""
        return mechanical(self.fit.point)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What can and cannot be known, and what the channels added."""
        channels_say = () if self.added is None else self.added.sentences
        return self.identifiability.sentences + channels_say + (() if self.repeated is None else (self.repeated,))

    @property
    def glitch_rows(self) -> tuple[int, ...]:
        """Numbers of the rows (first reading = 1) that were left out as isolated gross errors."""
        return tuple(self.sweep.numbers[self.fit.outliers].tolist())


def quantify_many(
    sweeps: Sequence[Sweep],
    *,
    rng: np.random.Generator | None = None,
    robust: bool = True,
    band_rad: float | None = None,
    count: Count | None = None,
) -> list[Findings]:
    """Fit and judge many sweeps; those of equal length and senses in one batched swarm.

    ``band_rad`` is the Delta E that the swarm discards particles by (Eq. 11); None: none is discarded.
    ``count`` tells how many are fitted, and then how many are judged.
    """
    count = count or Count(len(sweeps))
    rng = rng or np.random.default_rng(DEFAULT_SEED)
    groups: dict[tuple[int, tuple[int, int] | None], list[int]] = {}
    angles = [(radians(sweep.reference_deg), radians(sweep.measured_deg)) for sweep in sweeps]
    for index, sweep in enumerate(sweeps):
        senses = senses_from_channels(sweep, *angles[index])
        groups.setdefault((len(sweep), senses), []).append(index)
    fits: dict[int, BaselineFit] = {}
    for (_, senses), indices in groups.items():
        for start in range(0, len(indices), BATCH):
            batch = indices[start : start + BATCH]
            reference, measured = (np.stack([angles[i][side] for i in batch]) for side in (0, 1))
            fitted = fit_equal(reference, measured, rng=rng, senses=senses, robust=robust, band_rad=band_rad)
            fits.update(zip(batch, fitted, strict=True))
            count.of("error_model", len(fits), None)
    return [count.of("judging", i + 1, _findings(sweep, fits[i], band_rad)) for i, sweep in enumerate(sweeps)]


def gap_laws(found: Sequence[Findings]) -> tuple[Law, ...]:
    """How the factors follow the field, where all sweeps hold raw channels of different amplitude."""
    curves = [item.added.curve for item in found if item.added is not None]
    if len(curves) < len(found):
        return ()
    return laws([GapSweep(f.fit.point, f.fit.covariance, c.amplitude) for f, c in zip(found, curves, strict=True)])


def senses_from_channels(sweep: Sweep, reference: Array, measured: Array) -> tuple[int, int] | None:
    """With raw channels h is plain to see, and s follows from the slope; without them both are left to the fit."""
    if sweep.vx is None or sweep.vy is None:
        return None
    output = channels.output_sense(measured, sweep.vx, sweep.vy)
    slope = 1 if _follows(reference, measured, 1) >= _follows(reference, measured, -1) else -1
    return slope * output, output


def _follows(reference: Array, measured: Array, sense: int) -> float:
    return float(np.abs(np.mean(np.exp(1j * (measured - sense * reference)))))


def _findings(sweep: Sweep, fit: BaselineFit, band_rad: float | None) -> Findings:
    has_channels = sweep.vx is not None and sweep.vy is not None
    added = channels.added(fit, sweep.vx, sweep.vy) if sweep.vx is not None and sweep.vy is not None else None
    fit, repeated = between_angles(fit, sweep.reference_deg)
    words = identifiability(fit, radians(sweep.reference_deg), radians(sweep.measured_deg), has_channels=has_channels)
    band = None if band_rad is None else band_check(fit, band_rad)
    return Findings(sweep, fit, words, added, repeated, band)


def curve_deg(fit: BaselineFit, shaft_deg: Array) -> Array:
    """The fitted angle error (n,) [deg] at shaft angles (n,) [deg], in the sense that sensor and shaft count together.

    The zero is taken out, as in Fig. 14: what is left is the shape of the error.
    """
    slope = fit.senses.sensor * fit.senses.output
    shaft = radians(shaft_deg)
    readings = Readings.of(shaft, slope * shaft, sensor_sense=fit.senses.sensor, output_sense=fit.senses.output)
    # residual() is h m - atan2(y, x) with m = s h theta: turned round it is the error of the reading in the sense h.
    error = -fit.senses.output * readings.residual(fit.point) - fit.senses.output * fit.point[-1]
    return np.asarray(np.degrees(np.angle(np.exp(1j * error))))
