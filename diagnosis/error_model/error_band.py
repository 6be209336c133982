"""The error band: Delta E (Eq. 7) from the parameters of a chain, and the discard rule (Eq. 11) at a few readings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from diagnosis.error_model.model import Readings, coefficients
from twin.adc.adc_quantisation import ADC_QUANTISATION, FULL_SCALE
from twin.adc.reference_jitter import REFERENCE_JITTER
from twin.angles import TAU, Array
from twin.chain import Chain
from twin.cordic.cordic_truncation import CORDIC_TRUNCATION
from twin.effect import Effect
from twin.hall.noise import NOISE
from twin.link.output_quantisation import OUTPUT_QUANTISATION

SENTINELS = 32
_REACH = 4.0
"""Standard deviations of a random term that count as its largest deviation."""


def delta_e_rad(chain: Chain, *, immeasurable_rad: float = 0.0) -> float:
    """Eq. 7: quantisation + reference (Eq. 3) + immeasurable + largest CORDIC error [rad]."""
    return sum(band_terms_rad(chain, immeasurable_rad=immeasurable_rad).values())


def band_terms_rad(chain: Chain, *, immeasurable_rad: float = 0.0) -> dict[str, float]:
    """The terms of Eq. 7 [rad] by name: quantisation, reference, noise, cordic, immeasurable.

    The printed sum mixes an RMS with maxima. Eq. 11 compares the band with every single angle, so here every term is a
    largest deviation: half a step of each grid, four standard deviations of each random term.
    """

    def of(effect: Effect, name: str) -> float:
        return float(chain.values.get(effect.name, {}).get(name, effect.params[name].null))

    adc_bits, link_bits = of(ADC_QUANTISATION, "bits"), of(OUTPUT_QUANTISATION, "bits")
    # Half a step on both channels at once, at amplitude 1.
    quantisation = np.sqrt(2.0) * FULL_SCALE / 2.0**adc_bits if adc_bits else 0.0
    quantisation += 0.5 * TAU / 2.0**link_bits if link_bits else 0.0
    # x/2^m Delta D is a relative error of a channel: at 45 deg, where both are 0.707, it turns by half of it each.
    reference = _REACH * 0.01 * of(REFERENCE_JITTER, "percent_rms") / np.sqrt(2.0)
    noise = _REACH * np.radians(of(NOISE, "rms_deg"))
    iterations = of(CORDIC_TRUNCATION, "iterations")
    cordic = np.arctan(2.0 ** (1.0 - iterations)) if iterations else 0.0
    terms = {"quantisation": quantisation, "reference": reference, "noise": noise, "cordic": cordic}
    return {**{name: float(size) for name, size in terms.items()}, "immeasurable": immeasurable_rad}


def outside(readings: Readings, band_rad: float) -> Callable[[Array], NDArray[np.bool_]]:
    """The discard rule (Eq. 11) on readings (batch, n): which points (batch, particles, 6) leave the band somewhere.

    It is checked at :data:`SENTINELS` readings spread over the rows, so that its cost does not grow with their number.
    """
    pick = np.unique(np.linspace(0, readings.count - 1, SENTINELS).astype(np.intp))
    few = readings.sweeps((slice(None), pick))
    # r sin and r cos of the angle from the reading to the point are sums of products, as the objective is.
    across = np.swapaxes(few.features(), -1, -2)
    turned = replace(few, cos_read=few.sin_read, sin_read=-few.cos_read)
    along = np.tan(min(band_rad, 1.5)) * np.swapaxes(turned.features(), -1, -2)
    counted = None if few.weights is None else (few.weights > 0.0)[:, None, :]

    def leaves(points: Array) -> NDArray[np.bool_]:
        coefs = coefficients(points)
        out = np.abs(coefs @ across) > coefs @ along
        if counted is not None:
            out &= counted
        return np.asarray(out.any(axis=-1))

    return leaves
