"""Figures of the converter, the CORDIC and the misaligned magnet: ``python -m tests.benchmarks.stages``."""

from __future__ import annotations

import numpy as np

from tests.twin.sine_fit import jitter_sinad_db
from tests.twin.test_adc import TONE_HZ, five_sigma_db, sinad_of
from tests.twin.test_cordic import WORD_BITS, circle
from tests.twin.test_magnet_field import harmonics_deg, placed
from twin.adc.converter import Converter
from twin.angles import wrap
from twin.cordic.bit_true import Cordic, angle_rad, vectoring


def main() -> None:
    """Print the figures that the tests of these stages hold against their formulas."""
    print(
        f"converter, IEEE 1241 sine fit; 5 sigma of a record: {five_sigma_db(1.8):.2f} dB, {five_sigma_db(4.5):.2f} dB"
    )
    for bits in (8, 10, 12, 14, 16):
        sinad, enob = sinad_of(Converter(bits=bits), seed=None)
        print(f"  {bits:2d} bit: SINAD {sinad:.2f} dB against {6.02 * bits + 1.76:.2f} dB, ENOB {enob:.3f}")
    for aperture_s in (2e-8, 2e-7, 2e-6):
        sinad, _ = sinad_of(Converter(bits=18, aperture_s=aperture_s))
        stated = jitter_sinad_db(TONE_HZ, aperture_s)
        print(f"  jitter {aperture_s:.0e} s: SINAD {sinad:.2f} dB against {stated:.2f} dB")
    x, y = circle()
    print(f"CORDIC, {WORD_BITS} bit words on {x.size} angles of all quadrants, largest error in deg")
    for iterations in range(8, 17):
        unit = Cordic(iterations=iterations, word_bits=WORD_BITS)
        words, _ = vectoring(x, y, unit)
        error = np.max(np.abs(wrap(angle_rad(words, unit.angle_bits) - np.arctan2(y, x))))
        last, bound = np.arctan(2.0 ** -(iterations - 1)), unit.bound_rad(float(np.min(np.hypot(x, y))))
        print(
            f"  {iterations:2d} iterations: {np.degrees(error):.4f}, atan(2^-(n-1)) {np.degrees(last):.4f}, "
            f"with the word length {np.degrees(bound):.4f}"
        )
    print("misaligned magnet, order 2 of the angle error in deg")
    print(f"  magnet 0.5 mm off the shaft, sensor on it: {harmonics_deg(placed(magnet_x_mm=0.5))[2]:.1e}")
    for shift in (0.1, 0.2, 0.4):
        print(f"  sensor {shift} mm off the axis: {harmonics_deg(placed(sensor_x_mm=shift))[2]:.4f}")


if __name__ == "__main__":
    main()
