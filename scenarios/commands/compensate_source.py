"""What a correction is made of: a twin, or the readings of one sweep or of several at different temperatures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from diagnosis import diagnose_many
from diagnosis.correction.as_read import AsRead, as_read
from diagnosis.correction.calibration import Calibration, calibrate, calibrate_over_temperature
from diagnosis.correction.compensation import Correction, correction_of, correction_over
from diagnosis.correction.cross_validation import Shaft
from diagnosis.factors.findings import OneSense
from diagnosis.report.motion import not_separable
from diagnosis.report.temperature_answer import to_dict
from diagnosis.thermal.recording import SMALLEST_SPAN_K, Recording, over_temperature
from twin.decoded import Decoded
from twin.errors import UserError
from twin.estimated_motion import EstimatedMotion
from twin.sweep import Sweep


@dataclass(frozen=True, eq=False)
class Readings:
    """The readings of one sensor, and how corrections are made of them: of all, and of parts in the same way."""

    decoded: tuple[Decoded, ...]
    tolerance_deg: float
    seed: int

    @cached_property
    def sweeps(self) -> tuple[Sweep, ...]:
        """The sweeps without the faults of their words."""
        return tuple(one.usable for one in self.decoded)

    @property
    def title(self) -> str:
        """What a picture calls them."""
        first = self.sweeps[0].name
        return first if len(self.sweeps) == 1 else f"{first} and {len(self.sweeps) - 1} more"

    @cached_property
    def recording(self) -> Recording:
        """All readings without the faults of their words. Raises UserError where a sweep counts the other way round."""
        return self.as_read.kept

    @cached_property
    def as_read(self) -> AsRead:
        """All readings as the drive reads them."""
        return as_read(self.decoded)

    @cached_property
    def over_temperature(self) -> bool:
        """Whether they hold temperatures far enough apart for the factors to follow them."""
        return over_temperature(self.sweeps)

    @cached_property
    def one_sense(self) -> OneSense:
        """In which senses sensor and output count, as ``halltwin diagnose`` finds it.

        The correction is the same for both pairs; the factors that are told beside it are not.
        """
        return diagnose_many(self.sweeps, seed=self.seed).one_sense

    @cached_property
    def calibration(self) -> Calibration:
        """The calibration by all readings."""
        return self.calibrated(self.recording)

    @property
    def own_zeros(self) -> bool:
        """Whether the reference was set anew on the way."""
        over = self.calibration.over
        return over is not None and over.own_zeros

    @cached_property
    def correction(self) -> Correction:
        """The correction by all readings."""
        made = self.corrected(self.calibration)
        faults = dict.fromkeys(fault.cause for fault in self.as_read.faults)
        return replace(made, left_out=(*made.left_out, *faults))

    def shaft_of(self, recording: Recording) -> Shaft:
        """The correction that some of the readings make."""
        return self.corrected(self.calibrated(recording)).shaft

    def calibrated(self, recording: Recording) -> Calibration:
        """The calibration by some of the readings."""
        rng = np.random.default_rng(self.seed)
        if self.over_temperature:
            return calibrate_over_temperature(recording, rng=rng, senses=self.one_sense.senses)
        return calibrate(recording.reference_rad, recording.measured_rad, rng=rng)

    def corrected(self, found: Calibration) -> Correction:
        """The correction of a calibration; it follows the temperature where a factor does."""
        if found.over is None or not found.over.followed.any():
            return correction_of(found.chain, tolerance_deg=self.tolerance_deg)
        return correction_over(found.at, found.span.low_c, found.span.high_c, tolerance_deg=self.tolerance_deg)

    def laws(self) -> dict[str, Any]:
        """The laws of the factors over temperature as plain values; empty where there is none."""
        over = self.calibration.over
        return {} if over is None else to_dict(over, sweeps=len(self.sweeps), decided_by=self.one_sense.by)

    @cached_property
    def estimated(self) -> EstimatedMotion | None:
        """The motion in place of a reference; None where one of the sweeps has a reference."""
        motions = [sweep.estimated for sweep in self.sweeps]
        return motions[0] if all(motion is not None for motion in motions) else None

    @property
    def not_separable(self) -> list[int] | None:
        """Orders that may be a torque's; None where a reference tells."""
        return None if self.estimated is None else not_separable(self.estimated)

    @property
    def temperature_words(self) -> str | None:
        """What is said of temperatures that are taken as one; None where none was recorded, or laws say it."""
        recorded = [sweep for sweep in self.sweeps if sweep.temperature_c is not None]
        if self.over_temperature or not recorded:
            return None
        low, high = self.recording.temperature_c.min(), self.recording.temperature_c.max()
        at = f"{low:.1f}" if high - low < 0.05 else f"{low:.1f} .. {high:.1f}"
        return f"temperature {at} C alone: what others do to the error is not in the correction"


def readings_of(decoded: Sequence[Decoded], *, tolerance_deg: float, seed: int) -> Readings:
    """The readings of sweeps. Raises UserError for several that are no measurement over temperature.

    Without a reference several are taken at whichever temperature: their motions were estimated together, so that they
    have one zero, and their speeds tell torques from the sensor's errors.
    """
    found = Readings(tuple(decoded), tolerance_deg, seed)
    sweeps = found.sweeps
    without = [sweep.name for sweep in sweeps if sweep.estimated is not None]
    if without and found.estimated is None:
        raise UserError(
            f"{without[0]} has no reference_deg, and others have one; a correction is made of either: give the logs "
            "without a reference, or those with one"
        )
    if len(sweeps) > 1 and not found.over_temperature and found.estimated is None:
        for sweep in sweeps:
            if sweep.temperature_c is None:
                raise UserError(
                    f"{sweep.name}: several sweeps make one correction over temperature, and this one has "
                    "no temperature_c; add the column, or give one sweep"
                )
        raise UserError(
            f"{len(sweeps)} sweeps hold temperatures within {SMALLEST_SPAN_K:g} K of each other; one correction over "
            "temperature needs more between them: give one sweep, or add sweeps at other temperatures"
        )
    return found
