"""Everything the diagnoser says about one sweep, in one object: fit, identifiability, equivalents, raw channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from diagnosis.error_model.fit import BATCH, fit_equal
from diagnosis.error_model.model import Readings
from diagnosis.error_model.result import BaselineFit
from diagnosis.error_model.swarm import SwarmSettings
from diagnosis.factors import channels
from diagnosis.factors.air_gaps import AirGaps, air_gaps, start_gaps
from diagnosis.factors.band_check import BandCheck, band_check
from diagnosis.factors.channels import Added
from diagnosis.factors.gap_model import GapSweep
from diagnosis.factors.identifiability import Identifiability, identifiability
from diagnosis.factors.mechanical import Mechanical, mechanical
from diagnosis.factors.mirror import By, KnownSense, Mirror, judged
from diagnosis.factors.mounting import Mounting
from diagnosis.factors.repeats import between_angles
from diagnosis.factors.senses import known_senses
from diagnosis.factors.sentences import said_of_the_mirror_solution
from diagnosis.progress import Count
from twin.angles import Array, radians
from twin.sweep import Sweep

DEFAULT_SEED = 0
Senses = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Findings:
    """One diagnosed sweep. ``added`` is None without raw channels."""

    sweep: Sweep
    fit: BaselineFit
    identifiability: Identifiability
    added: Added | None
    repeated: str | None
    """What repeated readings did to the intervals, in words."""
    mirror: Mirror
    """Whether the mirror image of the fit, with both senses swapped, is a solution too."""
    mounting: Mounting = field(default_factory=Mounting.unstated)
    gap_mm: float | None = None
    """Air gap of this sweep; None: the one of the mounting."""
    band: BandCheck | None = None
    """What the discard rule did, where a band was given."""
    words: tuple[str, ...] = ()
    """Faults of the link that were taken off the readings, in words."""

    def __repr__(self) -> str:
        return f"Findings({self.sweep.name!r}, {self.fit!r})"

    @cached_property
    def mechanical(self) -> Mechanical:
        """The mechanical causes that would make the same curve, for the magnet and its air gap."""
        return mechanical(self.fit, self.mounting, self.gap_mm)

    @property
    def mirror_mechanical(self) -> Mechanical | None:
        """Those of the mirror solution; None where there is none."""
        return None if self.mirror.other is None else mechanical(self.mirror.other, self.mounting, self.gap_mm)

    @property
    def sentences(self) -> tuple[str, ...]:
        """What can and cannot be known, and what the channels added."""
        channels_say = () if self.added is None else self.added.sentences
        repeated = () if self.repeated is None else (self.repeated,)
        return (
            self.words
            + self.identifiability.sentences
            + said_of_the_mirror_solution(self.mirror)
            + channels_say
            + repeated
        )

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
    told: KnownSense | None = None,
    swarm: SwarmSettings | None = None,
) -> list[Findings]:
    """Fit and judge many sweeps; those of equal length and senses together, by the swarm where it is asked for.

    ``band_rad`` is the Delta E that the swarm discards particles by (Eq. 11); None: none is discarded. ``count`` tells
    how many are fitted, and then how many are judged; ``told`` in which sense the output counts.
    """
    count = count or Count(len(sweeps))
    rng = rng or np.random.default_rng(DEFAULT_SEED)
    angles = [(radians(sweep.reference_deg), radians(sweep.measured_deg)) for sweep in sweeps]
    known = [known_senses(sweep, *pair, told) for sweep, pair in zip(sweeps, angles, strict=True)]
    fit = partial(_fitted, rng=rng, robust=robust, band_rad=band_rad, swarm=swarm)
    fits = fit(angles, [senses for senses, _ in known], count=count)
    found = [
        count.of("judging", i + 1, _judged(sweep, fits[i], known[i][1], band_rad)) for i, sweep in enumerate(sweeps)
    ]
    undecided = [i for i, one in enumerate(found) if not one.mirror.decided]
    swapped: list[Senses | None] = [(-fits[i].senses.sensor, -fits[i].senses.output) for i in undecided]
    others = fit([angles[i] for i in undecided], swapped)
    for i, other in zip(undecided, others, strict=True):
        found[i] = _both(found[i], fits[i], other, band_rad)
    return found


def placed(found: Sequence[Findings], mounting: Mounting) -> list[Findings]:
    """The findings for this magnet, each at its own air gap: the stated one, or that which the amplitudes tell."""
    known = mounting.for_sweeps(len(found))
    gaps = None if known.assumed else start_gaps([_gap_sweep(item, item.fit) for item in found], known)
    each = (known.air_gap_mm * len(found))[: len(found)] if gaps is None else gaps
    return [replace(item, mounting=known, gap_mm=float(gap)) for item, gap in zip(found, each, strict=True)]


def _fitted(
    angles: Sequence[tuple[Array, Array]],
    senses: Sequence[Senses | None],
    *,
    rng: np.random.Generator,
    robust: bool,
    band_rad: float | None,
    swarm: SwarmSettings | None,
    count: Count | None = None,
) -> list[BaselineFit]:
    """The fits of sweeps (reference, measured) with these senses, None: both tried; in their order."""
    groups: dict[tuple[int, Senses | None], list[int]] = {}
    for index, pair in enumerate(angles):
        groups.setdefault((pair[0].size, senses[index]), []).append(index)
    fits: dict[int, BaselineFit] = {}
    for (_, given), indices in groups.items():
        for start in range(0, len(indices), BATCH):
            batch = indices[start : start + BATCH]
            reference, measured = (np.stack([angles[i][side] for i in batch]) for side in (0, 1))
            fitted = fit_equal(
                reference, measured, rng=rng, senses=given, robust=robust, settings=swarm, band_rad=band_rad
            )
            fits.update(zip(batch, fitted, strict=True))
            if count is not None:
                count.of("error_model", len(fits), None)
    return [fits[i] for i in range(len(angles))]


def _judged(sweep: Sweep, fit: BaselineFit, by: By | None, band_rad: float | None) -> Findings:
    """What a fit says; ``by``: who knew the senses."""
    has_channels = sweep.vx is not None and sweep.vy is not None
    added = channels.added(fit, sweep.vx, sweep.vy) if sweep.vx is not None and sweep.vy is not None else None
    counted, repeated = between_angles(fit, sweep.reference_deg)
    reference = radians(sweep.reference_deg)
    words = identifiability(counted, reference, radians(sweep.measured_deg), has_channels=has_channels)
    mirror = judged(fit, reference, counted=counted, covered_deg=words.covered_deg) if by is None else Mirror(by, None)
    band = None if band_rad is None else band_check(counted, band_rad)
    return Findings(sweep, counted, words, added, repeated, mirror, band=band)


def _both(found: Findings, fit: BaselineFit, other: BaselineFit, band_rad: float | None) -> Findings:
    """Both solutions of a sweep that cannot tell them apart; h = +1 comes first, so that a series keeps to one."""
    first, second = (fit, other) if fit.senses.output > 0 else (other, fit)
    main = found if first is fit else _judged(found.sweep, first, None, band_rad)
    second, _ = between_angles(second, found.sweep.reference_deg)
    return replace(main, mirror=replace(found.mirror, other=second))


def gap_fit(found: Sequence[Findings], mounting: Mounting) -> AirGaps | None:
    """The joint fit of several air gaps, by the magnet's field; None where the gaps are not known to differ."""
    fits = _of_one_sense(found)
    sweeps = [_gap_sweep(item, fit) for item, fit in zip(found, fits, strict=True)]
    freedom = sum(fit.degrees_of_freedom for fit in fits)
    return air_gaps(sweeps, [item.sweep.name for item in found], mounting, freedom)


def _gap_sweep(item: Findings, fit: BaselineFit) -> GapSweep:
    amplitude = None if item.added is None else (item.added.curve.amplitude, item.added.curve.amplitude_error)
    return GapSweep.of(fit, radians(item.sweep.reference_deg), amplitude)


def _of_one_sense(found: Sequence[Findings]) -> list[BaselineFit]:
    """The fits of one sensor: where some sweeps decide between the mirror solutions they do so for the others."""
    decided = sum(item.fit.senses.output for item in found if item.mirror.decided)
    return [
        item.mirror.other if decided * item.fit.senses.output < 0 and item.mirror.other is not None else item.fit
        for item in found
    ]


@dataclass(frozen=True)
class OneSense:
    """The senses (sensor, output) in which sweeps of one sensor count, and who decides; None: nobody does."""

    senses: Senses
    by: By | None


def one_sense(found: Sequence[Findings]) -> OneSense:
    """The senses of one sensor, by the sweeps that decide between the mirror solutions; else those told first."""
    first = _of_one_sense(found)[0].senses
    by = next(
        (item.mirror.by for item in found if item.mirror.decided and item.fit.senses.output == first.output), None
    )
    return OneSense((first.sensor, first.output), by)


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
