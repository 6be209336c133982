"""In which senses sensor and output count, as far as it is known before a fit: by the channels, a twin or the user."""

from __future__ import annotations

from diagnosis.factors.channels import output_sense
from diagnosis.factors.mirror import By, KnownSense
from twin.angles import Array
from twin.following import slope_of
from twin.sweep import Sweep


def known_senses(
    sweep: Sweep, reference: Array, measured: Array, told: KnownSense | None = None
) -> tuple[tuple[int, int] | None, By | None]:
    """The senses (s, h), and who says so; None and None where both are left to the fit.

    The user's word comes first, then raw channels, in which h is plain to see, then a twin. s follows from the slope.
    """
    if sweep.vx is not None and sweep.vy is not None and (told is None or told.by != "option"):
        told = KnownSense(output_sense(measured, sweep.vx, sweep.vy), "channels")
    if told is None:
        return None, None
    return (slope_of(reference, measured) * told.output, told.output), told.by
