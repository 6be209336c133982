"""How well the words sensitive and immune are put, and what the selective correction leaves: sensors at random.

``python -m tests.benchmarks.over_temperature`` draws sensors of which two of five factors, drawn too, follow the
temperature along a straight line, and records a turn each way at -40, 25 and 85 C. It counts the words, and the
intervals that hold the truth, and tries the correction on noiseless turns at the three temperatures and at others that
were not in the data, beside the correction that the same readings make where the temperature is not used.
"""

from __future__ import annotations

import argparse
from collections import Counter
from dataclasses import dataclass

import numpy as np

from diagnosis.correction.calibration import calibrate, calibrate_over_temperature
from diagnosis.correction.compensation import correction_of, correction_over
from diagnosis.thermal.recording import joined
from twin.angles import TAU, Array, radians, wrap
from twin.baseline import FACTORS
from twin.chain import Chain
from twin.motion import Motion
from twin.sweep import Sweep

MEASURED_C = (-40.0, 25.0, 85.0)
BETWEEN_C = (-20.0, 0.0, 50.0, 70.0)
TYPICAL = (1.0, 1.0, 0.01, 0.3, 0.3)
"""Spread of offset x and y [%], gain ratio, phase [deg] and quadratic term [%]."""
WEIGHTS_DEG = (0.405, 0.405, 20.3, 0.61, 0.20)
"""By how much a unit of each moves the angle [deg], in RMS over the turn."""
_POINTS = 180


@dataclass(frozen=True)
class Sensor:
    """Factors (5,) at 25 C in the twin's units, what they gain per kelvin, and the noise of a reading."""

    at_25: Array
    per_k: Array
    noise_deg: float

    def at(self, celsius: float) -> Chain:
        """The noiseless sensor at a temperature."""
        x, y, ratio, beta, q = self.at_25 + self.per_k * (celsius - 25.0)
        chain = Chain().with_effect("zero", zero_deg=37.0).with_effect("offset", x_percent=x, y_percent=y)
        chain = chain.with_effect("gain_mismatch", ratio=1.0 + ratio).with_effect("phase", beta_deg=beta)
        return chain.with_effect("quadratic_nonlinearity", q_percent=q)


def drawn(rng: np.random.Generator) -> Sensor:
    """A sensor of which two factors move the angle by 2 to 10 times the noise over the span."""
    noise = float(rng.uniform(0.01, 0.04))
    per_k = np.zeros(5)
    for k in rng.choice(5, 2, replace=False):
        moves = rng.choice([-1.0, 1.0]) * noise * rng.uniform(2.0, 10.0)
        per_k[k] = moves / WEIGHTS_DEG[k] / (MEASURED_C[-1] - MEASURED_C[0])
    return Sensor(rng.normal(0.0, TYPICAL), per_k, noise)


def recorded(sensor: Sensor, rng: np.random.Generator) -> Sweep:
    """A turn each way at each temperature."""
    angle = TAU * np.arange(_POINTS) / _POINTS
    there_and_back = np.concatenate([angle, angle[::-1]])
    parts = []
    for leg, celsius in enumerate(MEASURED_C):
        clean = sensor.at(celsius).readings(Motion.from_angle(there_and_back))
        measured = np.degrees(clean) + sensor.noise_deg * rng.standard_normal(clean.size)
        turn = 2 * leg + np.repeat([0, 1], _POINTS)
        parts.append((np.degrees(there_and_back), measured, np.full(clean.size, celsius), turn))
    columns = ("reference_deg", "measured_deg", "temperature_c", "turn")
    return Sweep.from_columns({n: np.concatenate(c) for n, c in zip(columns, zip(*parts, strict=True), strict=True)})


def tried(draws: int, seed: int) -> tuple[Counter[str], dict[float, Array]]:
    """Counts of words and intervals; by temperature the RMS errors (draws, 3) without, with a constant, selective."""
    counts: Counter[str] = Counter()
    errors: dict[float, list[tuple[float, ...]]] = {celsius: [] for celsius in sorted((*MEASURED_C, *BETWEEN_C))}
    for draw in range(draws):
        rng = np.random.default_rng([seed, draw])
        sensor = drawn(rng)
        sweep = recorded(sensor, rng)
        found = calibrate_over_temperature(joined([sweep]), rng=rng)
        assert found.over is not None
        for k, law in enumerate(found.over.factors):
            truth = sensor.per_k[k] if k < 5 else 0.0
            counts[f"{'drifts' if truth else 'steady'}: {law.verdict}"] += 1
            per_k = law.per_power[0].times(FACTORS[k].per_coordinate)
            counts["intervals"] += 1
            counts["intervals that hold the truth"] += per_k.low <= truth <= per_k.high
        selective = correction_over(found.at, found.span.low_c, found.span.high_c)
        constant = correction_of(calibrate(radians(sweep.reference_deg), radians(sweep.measured_deg), rng=rng).chain)
        shaft = TAU * np.arange(360) / 360
        for celsius, rows in errors.items():
            reading = sensor.at(celsius).readings(Motion.from_angle(shaft))
            raw = wrap(reading - shaft - np.angle(np.mean(np.exp(1j * (reading - shaft)))))
            left = (raw, wrap(constant.shaft(reading) - shaft), wrap(selective.shaft(reading, celsius) - shaft))
            rows.append(tuple(float(np.degrees(np.sqrt(np.mean(one**2)))) for one in left))
    return counts, {celsius: np.array(rows) for celsius, rows in errors.items()}


def main() -> None:
    """Draw, count and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--seed", type=int, default=14)
    given = parser.parse_args()
    counts, errors = tried(given.draws, given.seed)
    for name, count in sorted(counts.items()):
        print(f"{name:32} {count}")
    print("T / C    RMS error in deg, median (95th percentile): without, one for all temperatures, selective")
    for celsius, rows in errors.items():
        told = [f"{np.median(c):.4f} ({np.percentile(c, 95):.4f})" for c in rows.T]
        print(f"{celsius:6.0f}{'' if celsius in MEASURED_C else '*':2} {'   '.join(told)}")
    print("* a temperature that was not in the data")


if __name__ == "__main__":
    main()
