"""The causes: a sensor as a twin file describes it, what is wrong with it, how it is run, and which names are right."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from scenarios.commands.protocol import Protocol
from twin.chain import Chain
from twin.files import SCHEMA, from_dict
from twin.motion import Motion

NOTHING: frozenset[str] = frozenset()
PLACED = frozenset({"magnet_misalignment"})
STOPS = Protocol(turns=2, both_directions=True)
SPEEDS = Protocol(turns=4, both_directions=True, speeds_rpm=(60.0, 600.0))
OVEN3 = Protocol(turns=2, both_directions=True, temperatures_c=(-40.0, 25.0, 125.0))
OVEN4 = Protocol(turns=1, both_directions=True, temperatures_c=(-40.0, 0.0, 60.0, 125.0))

SENSOR: Mapping[str, Any] = {
    "schema": SCHEMA,
    "magnet": {"shape": "cylinder", "placement": {"air_gap_mm": 2.5}},
    "hardware": {"disk": {"gain": 6.0}, "plate": {"sensitivity_uV_per_mT": 100.0, "offset_uV": 1000.0}},
    "effects": {
        "offset": {"x_percent": 0.3, "y_percent": -0.2},
        "gain_mismatch": {"ratio": 1.004},
        "phase": {"beta_deg": 0.1},
        "noise": {"rms_deg": 0.02},
        "adc_quantisation": {"bits": 14},
    },
}
"""A sensor under a concentrator, with the paper's factors and nothing else."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One cause in hardware units.

    ``changes`` are laid over :data:`SENSOR`; ``names`` are those one of which, or a class that holds one, is right,
    ``needed`` whether one has to be given (what offset, gain and phase take up needs none); ``sized`` maps a parameter
    to its true value. ``moved`` changes the motion that the bench runs.
    """

    changes: Mapping[str, Any] = field(default_factory=dict)
    names: frozenset[str] = NOTHING
    needed: bool = True
    protocol: Protocol = STOPS
    sized: Mapping[str, float] = field(default_factory=dict)
    moved: Callable[[Motion, np.random.Generator], Motion] | None = None
    channels_only: bool = False
    """Whether an angle alone cannot show it: then nothing is right, too."""

    @property
    def chain(self) -> Chain:
        """The sensor with its cause."""
        return from_dict(_laid_over(SENSOR, self.changes))

    def motion(self, *, channels: bool, rng: np.random.Generator) -> Motion:
        """What the bench does."""
        motion = replace(self.protocol, channels=channels).motion()
        return motion if self.moved is None else self.moved(motion, rng)


def _laid_over(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    both = dict(below)
    for key, value in above.items():
        both[key] = _laid_over(below.get(key, {}), value) if isinstance(value, Mapping) else value
    return both


def _off_target(motion: Motion, rng: np.random.Generator) -> Motion:
    """Stops up to 0.4 deg from where they were asked for, as the reference reads them."""
    return replace(motion, shaft_rad=motion.shaft_rad + np.radians(rng.uniform(-0.4, 0.4, len(motion))))


def _disk(**numbers: float) -> dict[str, Any]:
    return {"hardware": {"disk": numbers}}


def _placed(**numbers: float) -> dict[str, Any]:
    return {"magnet": {"placement": numbers}}


def _effect(name: str, **numbers: float) -> dict[str, Any]:
    return {"effects": {name: numbers}}


CASES: dict[str, Case] = {
    "nothing": Case(),
    "gap 0.5 mm, disk of 900 mT": Case(
        changes=_placed(air_gap_mm=0.5) | _disk(saturation_mT=900.0), names=frozenset({"saturation", "adc_inl"})
    ),
    "disk saturating at 250 mT": Case(changes=_disk(saturation_mT=250.0), names=frozenset({"saturation", "adc_inl"})),
    "disk saturating as a vector": Case(
        changes=_disk(saturation_mT=250.0, per_axis=0.0), names=frozenset({"saturation"}), needed=False
    ),
    "reference noise 0.3 %": Case(
        changes=_effect("reference_jitter", percent_rms=0.3),
        names=frozenset({"reference_jitter"}),
        sized={"percent_rms": 0.3},
    ),
    "latency 150 us": Case(
        changes=_effect("latency", delay_us=150.0),
        names=frozenset({"latency"}),
        protocol=SPEEDS,
        sized={"delay_us": 150.0},
    ),
    "skew 20 us": Case(
        changes=_effect("xy_skew", delay_us=20.0),
        names=frozenset({"xy_skew"}),
        protocol=SPEEDS,
        sized={"delay_us": 20.0},
    ),
    "clipping at 0.95": Case(
        changes=_effect("clipping", level_percent=95.0),
        names=frozenset({"clipping"}),
        sized={"level_percent": 95.0},
    ),
    "bit 7 stuck": Case(
        changes=_effect("adc_stuck_bit", step_percent=250.0 / 2**7, level=1.0), names=frozenset({"adc_stuck_bit"})
    ),
    "spinning off": Case(changes={"hardware": {"plate": {"spun": False}}}),
    "plate asymmetry 3 %": Case(changes={"hardware": {"plate": {"asymmetry": 0.03}}}),
    "disk shifted and rough": Case(changes=_disk(shift_x_um=3.0, shift_y_um=-2.0, roughness_um=0.2, part=5)),
    "sensor tilted by 6 deg": Case(changes=_placed(sensor_tilt_y_deg=6.0), names=PLACED, needed=False),
    "sensor 0.6 mm off": Case(changes=_placed(sensor_x_mm=0.6), names=PLACED, needed=False),
    "sensor and magnet off": Case(changes=_placed(sensor_x_mm=0.4, magnet_y_mm=0.3), names=PLACED, channels_only=True),
    "stray field (1, -0.5) mT": Case(changes=_placed(stray_x_mT=1.0, stray_y_mT=-0.5)),
    "magnet chipped": Case(
        changes=_effect("magnet_harmonic", order=3.0, amplitude_deg=0.15, phase_deg=40.0),
        names=frozenset({"magnet_harmonic"}),
        sized={"amplitude_deg": 0.15},
    ),
    "offset drifts, three temperatures": Case(
        changes=_effect("offset_drift", x_percent_per_K=0.004, y_percent_per_K=-0.003),
        names=frozenset({"offset_drift"}),
        protocol=OVEN3,
    ),
    "plates drift apart, four temperatures": Case(
        changes={"hardware": {"plate": {"percent_per_K": 0.05}, "plate_y": {"percent_per_K": 0.06}}},
        # The magnet's field falls as it warms, so that the constant offsets grow beside it.
        names=frozenset({"gain_drift", "offset_drift"}),
        protocol=OVEN4,
    ),
    # A bow is the paper's quadratic term.
    "converter bowed by 8 LSB": Case(
        changes=_effect("adc_inl", bow_lsb=8.0), names=frozenset({"adc_inl"}), needed=False
    ),
    "converter's first bits off by 8 LSB": Case(
        changes=_effect("adc_inl", bit1_lsb=8.0, bit2_lsb=-8.0),
        names=frozenset({"adc_inl"}),
        sized={"bit1_lsb": 8.0, "bit2_lsb": -8.0},
    ),
    "supply ripple above half the rate": Case(
        changes=_effect("reference_ripple", amplitude_percent=0.5, frequency_Hz=4513.0, delay_us=20.0),
        names=frozenset({"reference_ripple", "mains_pickup"}),
        protocol=SPEEDS,
    ),
    **{
        f"CORDIC of {count} iterations": Case(
            changes=_effect("cordic_truncation", iterations=count, word_bits=14, guard_bits=3, angle_bits=18),
            names=frozenset({"cordic_truncation"}),
            needed=count < 12,
            sized={"iterations": float(count)},
        )
        for count in (8, 10, 14)
    },
    **{
        f"angle word of {bits} bits": Case(
            changes=_effect("output_quantisation", bits=bits),
            names=frozenset({"output_quantisation"}),
            needed=bits < 13,
            sized={"bits": float(bits)},
        )
        for bits in (12, 14)
    },
    "stops not where they were asked for": Case(moved=_off_target),
    "hysteresis": Case(
        changes=_effect("hysteresis", lag_deg=0.08, memory_deg=8.0),
        names=frozenset({"hysteresis"}),
        sized={"lag_deg": 0.08},
    ),
    "backlash": Case(
        changes=_effect("backlash", half_width_deg=0.08), names=frozenset({"backlash"}), sized={"half_width_deg": 0.08}
    ),
    "reference eccentric": Case(
        changes=_effect("reference_eccentricity", amplitude_deg=0.15, phase_deg=20.0),
        names=frozenset({"reference_eccentricity"}),
        channels_only=True,
    ),
    "mains pickup": Case(
        changes=_effect("mains_pickup", x_percent=0.3, frequency_Hz=50.0),
        names=frozenset({"mains_pickup"}),
        protocol=SPEEDS,
        sized={"x_percent": 0.3},
    ),
}
