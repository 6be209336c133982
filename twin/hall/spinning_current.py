"""Spinning current, phase by phase: how a plate's offset and an amplifier's 1/f noise are moved out of the way.

One cycle has four phases: the bias current flows at 0, 90, 180 and 270 degrees through the plate. The contacts are
switched so that the plate's offset keeps its sign from phase to phase while the Hall voltage changes its own
(the two quadrature phases of the paper's reference 9, each with the current in both senses). Offset and 1/f noise of
plate and amplifier then lie at zero frequency, the signal at the chopper's; the synchronous demodulator swaps the
two, and the mean over a cycle is the filter. What remains is what differs between the phases.

Sources: P. J. A. Munter, Sensors and Actuators A 22 (1990) 743 (spinning current); R. S. Popovic, Hall Effect
Devices, 2nd ed., 2004, chapter 5 (offset of 1 to 50 mT before, 1/f noise of Hall plates); A. Bilotti et al., IEEE
J. Solid-State Circuits 32 (1997) 829 (two quadrature phases with a chopper and synchronous demodulation).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from twin.angles import Array
from twin.limits import require_within
from twin.motion import NOMINAL_C

PHASES = 4
SIGNAL_SIGN = np.array([1.0, -1.0, 1.0, -1.0])
"""Sign of the Hall voltage at the amplifier in each phase; the demodulator multiplies by the same."""
_HANN_ALIKE = 1.0 + 2.0 * ((2.0 / 3.0) ** 2 + (1.0 / 6.0) ** 2)
"""By what the variance of a mean over lines grows because those of a Hann window are alike."""
CURRENT_SIGN = np.array([1.0, 1.0, -1.0, -1.0])
"""Sense of the bias current along its axis."""


@dataclass(frozen=True, kw_only=True)
class Plate:
    """A Hall plate with its biasing and amplifier; voltages in uV at the amplifier's input. By default it is ideal.

    ``sensitivity_uV_per_mT``     at 25 C; ``percent_per_K`` is its drift
    ``offset_uV``                 of the plate (bridge asymmetry), the same in all phases
    ``asymmetry``                 share of that offset that differs between 0 and 90 degrees (non-linear plate)
    ``thermal_uV``                thermoelectric voltage: fixed in the plate, so its sign at the amplifier goes with
                                  contacts and current, and the two senses cancel it
    ``amplifier_offset_uV``       of the amplifier, the same in all phases
    ``white_nV``                  thermal noise of plate and amplifier, per root Hz (one-sided)
    ``corner_Hz``                 where the 1/f noise equals the white noise
    ``settling_s``                time constant after each switching
    ``blanking``                  share of each phase, from its start, that sample and hold leave out
    ``spun``                      whether the bias spins; else it stays in the first phase, and all offsets with it
    """

    sensitivity_uV_per_mT: float = 100.0
    percent_per_K: float = 0.0
    offset_uV: float = 0.0
    asymmetry: float = 0.0
    thermal_uV: float = 0.0
    amplifier_offset_uV: float = 0.0
    white_nV: float = 0.0
    corner_Hz: float = 10e3
    settling_s: float = 0.0
    blanking: float = 0.5
    spun: bool = True
    phase_s: float = 5e-6
    samples: int = 8

    def __post_init__(self) -> None:
        require_within("sensitivity_uV_per_mT", self.sensitivity_uV_per_mT, 1e-3, 1e6, "uV/mT")
        require_within("percent_per_K", self.percent_per_K, -1.0, 1.0, "%/K")
        for name in ("offset_uV", "thermal_uV", "amplifier_offset_uV"):
            require_within(name, getattr(self, name), -1e6, 1e6, "uV")
        require_within("asymmetry", self.asymmetry, -1.0, 1.0)
        require_within("white_nV", self.white_nV, 0.0, 1e6, "nV")
        require_within("corner_Hz", self.corner_Hz, 0.0, 1e9, "Hz")
        require_within("settling_s", self.settling_s, 0.0, 1.0, "s")
        require_within("blanking", self.blanking, 0.0, 0.9)
        require_within("phase_s", self.phase_s, 1e-9, 1.0, "s")
        require_within("samples", self.samples, 2, 1024, whole=True)

    @property
    def ideal(self) -> bool:
        """Whether its output is the field: nothing is left after spinning, and nothing follows the temperature."""
        left = [self.asymmetry * self.offset_uV]
        if not self.spun:
            left = [self.offset_uV, self.thermal_uV, self.amplifier_offset_uV]
        return not any((*left, self.percent_per_K, self.white_nV, self.settling_s))

    @property
    def cycle_Hz(self) -> float:
        """Cycles per second: the rate of the output."""
        return 1.0 / (PHASES * self.phase_s)

    def sensitivity_at(self, temperature_c: Array | float) -> Any:
        """Sensitivity [uV/mT] at this temperature (any shape), linear about 25 C."""
        return self.sensitivity_uV_per_mT * (1.0 + 0.01 * self.percent_per_K * (temperature_c - NOMINAL_C))


TYPICAL = Plate(
    percent_per_K=0.05,
    offset_uV=1000.0,
    asymmetry=2e-3,
    thermal_uV=5.0,
    amplifier_offset_uV=500.0,
    white_nV=20.0,
    settling_s=0.2e-6,
)
"""Typical assumptions, of the size of the sources' figures."""


@dataclass(frozen=True, eq=False)
class Spinning:
    """The signals of one run, with units in the names; (cycles, phases, samples), the output (cycles,)."""

    time_s: Array
    plate_uV: Array
    amplified_uV: Array
    demodulated_uV: Array
    output_mT: Array
    unspun_mT: Array


def spin(
    field_mT: Array, plate: Plate, rng: np.random.Generator | None = None, *, temp_c: Array | float = NOMINAL_C
) -> Spinning:
    """Run the plate on a vertical field (cycles,) [mT] at a temperature, or one a cycle; without ``rng`` no noise.

    The plate cycles all the time and the field is steady over a cycle, so each cycle begins settled from a last phase
    like its own, however long ago the reading before was. The output is counted with the sensitivity at 25 C.
    ``unspun_mT`` is what the same plate gives with its bias left in phase 0: the offset and noise before spinning.
    """
    cycles = field_mT.size
    shape = (cycles, PHASES, plate.samples)
    nominal = plate.sensitivity_at(NOMINAL_C)
    hall = (plate.sensitivity_at(temp_c) * field_mT)[:, None] * SIGNAL_SIGN
    # The axis at 90 degrees (the second and fourth phase) sees an offset that differs a little.
    offset = plate.offset_uV * (1.0 + plate.asymmetry * np.array([0.5, -0.5, 0.5, -0.5]))
    thermal = plate.thermal_uV * SIGNAL_SIGN * CURRENT_SIGN
    steady = hall + offset + thermal
    # After each switching the voltage settles from that of the phase before.
    before = np.roll(steady, 1, axis=1)
    elapsed = (np.arange(plate.samples) + 0.5) / plate.samples * plate.phase_s
    held = elapsed >= plate.blanking * plate.phase_s
    with np.errstate(over="ignore"):
        # So short a time constant that it is none.
        decay = np.exp(-elapsed / plate.settling_s) if plate.settling_s > 0.0 else np.zeros(plate.samples)
    at_plate = steady[..., None] + (before - steady)[..., None] * decay
    rate = plate.samples / plate.phase_s
    noise = (
        np.zeros(shape)
        if rng is None or plate.white_nV == 0.0
        else flicker(rng, cycles * PHASES * plate.samples, rate, plate).reshape(shape)
    )
    amplified = at_plate + plate.amplifier_offset_uV + noise
    demodulated = amplified * SIGNAL_SIGN[:, None]
    return Spinning(
        time_s=(np.arange(amplified.size) + 0.5).reshape(shape) / rate,
        plate_uV=at_plate,
        amplified_uV=amplified,
        demodulated_uV=demodulated,
        output_mT=demodulated[..., held].mean(axis=(1, 2)) / nominal,
        unspun_mT=(steady[:, 0] + plate.amplifier_offset_uV + noise[..., held].mean(axis=(1, 2))) / nominal,
    )


def residual_offset_mT(plate: Plate) -> tuple[float, float]:
    """Offset before and after spinning [mT], from a cycle without field and noise."""
    quiet = spin(np.zeros(1), plate)
    return float(quiet.unspun_mT[0]), float(quiet.output_mT[0])


def flicker(rng: np.random.Generator, count: int, rate_Hz: float, plate: Plate) -> Array:
    """Noise (count,) [uV] of one-sided density white^2 (1 + corner / f), shaped in the frequency domain."""
    frequency = np.fft.rfftfreq(count, 1.0 / rate_Hz)
    # The lowest line of the record stands for all that lies below it.
    density = plate.white_nV**2 * (1.0 + plate.corner_Hz / np.maximum(frequency, rate_Hz / count))
    parts = rng.standard_normal((2, frequency.size))
    spectrum = (parts[0] + 1j * parts[1]) * np.sqrt(density * rate_Hz * count / 4.0)
    return np.asarray(1e-3 * np.fft.irfft(spectrum, count))


def density(values: Array, rate_Hz: float, segments: int = 64) -> tuple[Array, Array]:
    """Frequencies [Hz] and one-sided power density [unit^2/Hz]: the mean over half-overlapping Hann windows.

    Source: P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70.
    """
    length = 2 * values.size // (segments + 1)
    window = np.hanning(length)
    starts = np.arange(segments) * (length // 2)
    blocks = np.stack([values[start : start + length] for start in starts])
    blocks = (blocks - blocks.mean(axis=-1, keepdims=True)) * window
    power = np.mean(np.abs(np.fft.rfft(blocks, axis=-1)) ** 2, axis=0) * 2.0 / (rate_Hz * np.sum(window**2))
    frequency = np.asarray(np.fft.rfftfreq(length, 1.0 / rate_Hz), dtype=np.float64)
    # The lowest two lines carry the window's leakage of the mean.
    return frequency[2:-1], np.asarray(power[2:-1], dtype=np.float64)


def corner_of(frequency_Hz: Array, power: Array) -> float:
    """The 1/f corner [Hz] of a density: see :func:`corner_and_error`."""
    return corner_and_error(frequency_Hz, power)[0]


def corner_and_error(frequency_Hz: Array, power: Array) -> tuple[float, float]:
    """The 1/f corner [Hz] of a density and its standard error: of a (1 + corner / f), weighted by the density's error.

    Under the Hann window the amplitudes of neighbouring lines correlate by 2/3, those of the next but one by 1/6.
    """
    design = np.stack([np.ones_like(frequency_Hz), 1.0 / frequency_Hz], axis=-1)
    weight = 1.0 / power
    for _ in range(20):
        white, pink = np.linalg.lstsq(design * weight[:, None], power * weight, rcond=None)[0]
        weight = 1.0 / np.maximum(design @ np.array([white, pink]), 1e-3 * power.min())
    corner = float(max(pink, 0.0) / white)
    weighted = design * weight[:, None]
    left = power * weight - weighted @ np.array([white, pink])
    variance = _HANN_ALIKE * (left @ left) / max(power.size - 2, 1)
    covariance = np.linalg.inv(weighted.T @ weighted) * variance
    slope = np.array([-corner, 1.0]) / white
    return corner, float(np.sqrt(slope @ covariance @ slope))
