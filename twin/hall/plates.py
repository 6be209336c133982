"""The two Hall plates as they act on the chain's channels: what spinning leaves, temperature, and noise."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from twin.angles import Array
from twin.effect import Effect, Parameters
from twin.hall.spinning_current import PHASES, Plate, Spinning, spin
from twin.motion import NOMINAL_C, Motion
from twin.part import part, per_design

STRETCH = 1 << 21
"""Samples of the amplifier that are computed together: some 130 MB, and 65,536 readings of the usual plate."""


@lru_cache(maxsize=64)
def spun_line(plate: Plate) -> tuple[float, float]:
    """What spinning makes of a steady field at 25 C, in expectation: the output's offset [mT] and its gain.

    The output is a straight line of the field: settling takes its share of the field's voltage as of the offset's.
    """
    none, unit = plate_output_mT(spin(np.array([0.0, 1.0]), plate), plate)
    return float(none), float(unit - none)


def expected_mT(field_mT: Array, plate: Plate, temp_c: Array | float) -> Array:
    """The mean output [mT] for a vertical field [mT] and temperatures that broadcast together."""
    offset, gain = spun_line(plate)
    warm = plate.sensitivity_at(temp_c) / plate.sensitivity_at(NOMINAL_C)
    return np.asarray(offset + gain * warm * field_mT)


def described(plates: tuple[Plate, Plate], vertical_mT: Any) -> Effect:
    """Both plates as an operation on channels whose amplitude 1 stands for ``vertical_mT`` (or one a design)."""
    scale = per_design(vertical_mT)

    def forward(signal: Array, motion: Motion, values: Parameters, rng: np.random.Generator | None) -> Array:
        field = scale * signal
        axes = [field[..., axis : axis + 1, :] for axis in (0, 1)]
        seen = [_seen_mT(*one, motion.temperature_c, rng) for one in zip(axes, plates, strict=True)]
        return np.concatenate(seen, axis=-2) / scale

    source = "the Hall plates as described in [hardware.plate] and [hardware.plate_y]"
    return part("plates", "hall", forward, source, noisy=any(plate.white_nV > 0.0 for plate in plates))


def _seen_mT(field_mT: Array, plate: Plate, temp_c: Array, rng: np.random.Generator | None) -> Array:
    """The output [mT] of one plate; only its noise needs the cycle phase by phase."""
    if rng is None or plate.white_nV == 0.0:
        return expected_mT(field_mT, plate, temp_c)
    temps = np.broadcast_to(temp_c, field_mT.shape).ravel()
    flat, seen = field_mT.ravel(), np.empty(field_mT.size)
    # Stretch by stretch, so that a long record asks for no more memory; the noise of each is drawn by itself.
    together = max(STRETCH // (PHASES * plate.samples), 1)
    for start in range(0, flat.size, together):
        part = slice(start, start + together)
        seen[part] = plate_output_mT(spin(flat[part], plate, rng, temp_c=temps[part]), plate)
    return seen.reshape(field_mT.shape)


def plate_output_mT(cycle: Spinning, plate: Plate) -> Array:
    """What leaves the plate: the spun output, or that of the first phase where the bias stays there."""
    return cycle.output_mT if plate.spun else cycle.unspun_mT
