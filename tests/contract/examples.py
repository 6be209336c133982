"""One table: for every effect an example of its parameters, its leading signature, and what it remembers.

A signature gives the angle error [rad] (n,) to leading order in the strengths, from first principles and not from
the code under test: with x += dx and y += dy the angle turns by cos a dy - sin a dx.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tests.contract.signatures import (
    Params,
    bump,
    clipping,
    creep,
    drift,
    inl,
    lag,
    line,
    mains,
    misaligned,
    modes,
    motor,
    of_counts,
    of_periods,
    over_flanks,
    play,
    rad,
    ripple,
    seam,
    shift,
    stepper,
    stuck,
    tone,
    turned,
    twist,
    warm,
    zone,
)
from twin import example
from twin.angles import Array
from twin.motion import Motion

Signature = Callable[[Motion, Params], Array]


@dataclass(frozen=True, kw_only=True)
class Example(example.Example):
    """An example of :mod:`twin.example` with the error that it must leave, worked out apart from the code.

    ``kinks``: the effect's slope jumps, so a few readings near the jumps may follow another branch at half the
    strength: the share of the readings for which that is allowed.
    """

    signature: Signature | None
    kinks: float = 0.0


_LINE = {"amplitude_deg": 0.2}
_PHASE = {"phase_deg": 35.0}

EXAMPLES: dict[str, Example] = {
    # mechanics
    "zero": Example(strengths={"zero_deg": 3.0}, shapes={}, signature=lambda m, p: np.full(len(m), rad(p["zero_deg"]))),
    "backlash": Example(strengths={"half_width_deg": 0.1}, shapes={}, signature=play, memory=True),
    "cardan_coupling": Example(strengths=_LINE, shapes=_PHASE, signature=lambda m, p: line(m, p, 2.0)),
    "bearing_wobble": Example(
        strengths=_LINE, shapes={**_PHASE, "order": 0.41}, signature=lambda m, p: line(m, p, p["order"])
    ),
    "load_torsion": Example(
        strengths={"deg_per_krpm_per_s": 0.2, "deg_per_A": 0.03},
        shapes={},
        memory=True,
        signature=twist,
    ),
    "thermal_zero_shift": Example(
        strengths={"deg_per_K": 0.004}, shapes={}, signature=lambda m, p: rad(p["deg_per_K"]) * warm(m)
    ),
    "zero_drift": Example(strengths={"amplitude_deg": 0.5}, shapes={"time_constant_s": 5.0}, signature=drift),
    # magnet
    "magnet_harmonic": Example(
        strengths=_LINE, shapes={**_PHASE, "order": 5.0}, signature=lambda m, p: line(m, p, p["order"])
    ),
    "motor_poles": Example(
        strengths=_LINE,
        shapes={**_PHASE, "slots": 12.0, "poles": 14.0, "order": 28.0},
        signature=lambda m, p: line(m, p, p["order"]),
    ),
    "motor_field": Example(
        strengths={
            **{"bx_mT_per_A": 0.03, "by_mT_per_A": -0.02, "bx_mT_per_krpm": 0.1, "by_mT_per_krpm": 0.2},
        },
        shapes={"field_mT": 60.0},
        signature=motor,
    ),
    "magnet_misalignment": Example(
        strengths={"off_axis_mm": 0.4}, shapes={"direction_deg": 20.0}, signature=misaligned, power=2
    ),
    "stray_field": Example(
        strengths={"bx_mT": 0.3, "by_mT": -0.2},
        shapes={"field_mT": 60.0},
        signature=lambda m, p: shift(m, p["bx_mT"] / p["field_mT"], p["by_mT"] / p["field_mT"]),
    ),
    # concentrator
    "hysteresis": Example(strengths={"lag_deg": 0.1}, shapes={"memory_deg": 12.0}, signature=lag, memory=True),
    "saturation": Example(
        strengths={"k_percent": 0.5},
        shapes={},
        signature=lambda m, p: 0.01 * p["k_percent"] * np.sin(4.0 * m.shaft_rad) / 4.0,
    ),
    # hall
    "multipole": Example(
        strengths={"x_percent": 0.6, "y_percent": -0.4, "ratio": 1.008, "beta_deg": 0.5},
        shapes={"periods": 4.0},
        signature=of_periods,
        origin={"ratio": 1.0},
    ),
    "phase": Example(
        strengths={"beta_deg": 0.2}, shapes={}, signature=lambda m, p: rad(p["beta_deg"]) * np.cos(m.shaft_rad) ** 2
    ),
    "phase_drift": Example(
        strengths={"deg_per_K": 0.004},
        shapes={},
        signature=lambda m, p: rad(p["deg_per_K"]) * warm(m) * np.cos(m.shaft_rad) ** 2,
    ),
    "quadratic_nonlinearity": Example(
        strengths={"q_percent": 0.3},
        shapes={},
        signature=lambda m, p: shift(
            m, 0.01 * p["q_percent"] * np.cos(m.shaft_rad) ** 2, 0.01 * p["q_percent"] * np.sin(m.shaft_rad) ** 2
        ),
    ),
    "offset": Example(
        strengths={"x_percent": 0.3, "y_percent": -0.2},
        shapes={},
        signature=lambda m, p: shift(m, 0.01 * p["x_percent"], 0.01 * p["y_percent"]),
    ),
    "offset_drift": Example(
        strengths={"x_percent_per_K": 0.01, "y_percent_per_K": 0.005},
        shapes={},
        signature=lambda m, p: shift(m, 0.01 * p["x_percent_per_K"] * warm(m), 0.01 * p["y_percent_per_K"] * warm(m)),
    ),
    "gain_mismatch": Example(
        strengths={"ratio": 1.004},
        shapes={},
        signature=lambda m, p: shift(m, 0.0, (p["ratio"] - 1) * np.sin(m.shaft_rad)),
    ),
    "gain_drift": Example(
        strengths={"percent_per_K": 0.01},
        shapes={},
        signature=lambda m, p: shift(m, 0.0, 0.01 * p["percent_per_K"] * warm(m) * np.sin(m.shaft_rad)),
    ),
    "mains_pickup": Example(
        strengths={"x_percent": 0.4, "y_percent": 0.3}, shapes={**_PHASE, "frequency_Hz": 50.2}, signature=mains
    ),
    "noise": Example(
        strengths={"rms_deg": 0.1},
        shapes={
            "correlation": 0.5,
            "correlated_share": 0.5,
            "flicker_exponent": 1.0,
            "ringing_per_reading": 0.2,
            "ringing_quality": 8.0,
            "inverse_dof": 0.2,
            "rotating_frame": 1.0,
            "backward_percent": 50.0,
            "percent_per_K": 1.0,
            "percent_per_rpm": 0.1,
            "angle_percent": 50.0,
            "angle_phase_deg": 35.0,
        },
        signature=None,
    ),
    # adc
    "xy_skew": Example(
        strengths={"delay_us": 60.0},
        shapes={},
        signature=lambda m, p: 1e-6 * p["delay_us"] * m.speed_rad_s * np.cos(m.shaft_rad) ** 2,
    ),
    "clipping": Example(
        strengths={"level_percent": 99.0}, shapes={}, signature=clipping, origin={"level_percent": 100.0}, power=1.5
    ),
    "reference_ripple": Example(
        strengths={"amplitude_percent": 0.4},
        shapes={**_PHASE, "frequency_Hz": 33.0, "delay_us": 4000.0},
        signature=ripple,
    ),
    "reference_jitter": Example(strengths={"percent_rms": 0.3}, shapes={}, signature=None),
    "adc_stuck_bit": Example(strengths={"step_percent": 0.4}, shapes={"level": 1.0}, signature=stuck, kinks=0.02),
    "adc_inl": Example(
        strengths={
            **{"bow_lsb": 10.0, "s_lsb": -8.0, "bit1_lsb": 6.0, "bit2_lsb": 5.0},
            **{"bit3_lsb": 7.0, "bit4_lsb": -4.0, "bit5_lsb": 6.0, "bit6_lsb": -5.0},
        },
        shapes={"full_scale_percent": 140.0},
        signature=inl,
        kinks=0.3,
    ),
    "adc_quantisation": Example(strengths={"bits": 10.0}, shapes={}, signature=None),
    # cordic
    "cordic_truncation": Example(strengths={"iterations": 9.0}, shapes={}, signature=None),
    # link
    "latency": Example(
        strengths={"delay_us": 60.0}, shapes={}, signature=lambda m, p: -1e-6 * p["delay_us"] * m.speed_rad_s
    ),
    "time_jitter": Example(strengths={"rms_us": 20.0}, shapes={}, signature=None),
    "output_quantisation": Example(strengths={"bits": 11.0}, shapes={}, signature=None),
    "stale_frames": Example(strengths={"fraction_percent": 5.0}, shapes={}, signature=None, memory=True),
    "bus_glitch": Example(strengths={"count": 7.0}, shapes={}, signature=None),
    "error_code": Example(
        strengths={"fraction_percent": 5.0}, shapes={"reading_deg": 90.0, "run_rows": 2.0}, signature=None, memory=True
    ),
    "word_bit": Example(strengths={"bit": 9.0}, shapes={"word_bits": 14.0, "level": 1.0}, signature=None),
    "dead_zone": Example(
        strengths={"width_deg": 36.0}, shapes={"start_deg": 100.0, "jump_percent": 50.0}, signature=zone
    ),
    "scale_error": Example(
        strengths={"factor": 1.002}, shapes={}, signature=lambda m, p: (p["factor"] - 1.0) * turned(m)
    ),
    # reference
    "drive_ripple": Example(strengths=_LINE, shapes={**_PHASE, "order": 24.0}, signature=stepper),
    "reference_eccentricity": Example(strengths=_LINE, shapes=_PHASE, signature=lambda m, p: line(m, p, 1.0, -1.0)),
    "reference_rezero": Example(strengths={"spread_deg": 0.3}, shapes={}, signature=None),
    "index_slip": Example(
        strengths={"step_deg": 0.4},
        shapes={"time_s": 4.0},
        signature=lambda m, p: rad(p["step_deg"]) * (m.time_s >= p["time_s"]),
    ),
    "reference_quantisation": Example(
        strengths={"step_deg": 0.3}, shapes={"counts_per_turn": 1000.0}, signature=of_counts
    ),
    # empirical
    "unnamed_order": Example(
        strengths=_LINE, shapes={**_PHASE, "order": 11.0}, signature=lambda m, p: line(m, p, p["order"])
    ),
    "unnamed_direction": Example(
        strengths={"sin2_deg": 0.1, "cos3_deg": -0.05},
        shapes={},
        signature=lambda m, p: (
            m.direction * (rad(p["sin2_deg"]) * np.sin(2 * m.shaft_rad) + rad(p["cos3_deg"]) * np.cos(3 * m.shaft_rad))
        ),
    ),
    "unnamed_direction_order": Example(
        strengths=_LINE,
        shapes={**_PHASE, "order": 7.0},
        signature=lambda m, p: line(m, p, p["order"], weight=m.direction),
    ),
    "unnamed_temperature_order": Example(
        strengths=_LINE,
        shapes={**_PHASE, "order": 9.0, "at_K": 60.0},
        signature=lambda m, p: line(m, p, p["order"], weight=warm(m) / 60.0),
    ),
    "unnamed_temperature": Example(
        strengths={"cos0_deg": 0.1, "sin4_deg": 0.05},
        shapes={"at_K": 60.0},
        signature=lambda m, p: warm(m) / 60.0 * (rad(p["cos0_deg"]) + rad(p["sin4_deg"]) * np.sin(4 * m.shaft_rad)),
    ),
    "unnamed_speed": Example(
        strengths=_LINE,
        shapes={**_PHASE, "order": 2.0, "power": 1.0, "at_rpm": 600.0},
        signature=lambda m, p: line(m, p, p["order"], weight=m.speed_rad_s / (20.0 * np.pi)),
    ),
    "unnamed_speed_zero": Example(
        strengths={"amplitude_deg": 0.1},
        shapes={"power": 2.0, "at_rpm": 600.0},
        signature=lambda m, p: rad(p["amplitude_deg"]) * m.speed_rad_s * np.abs(m.speed_rad_s) / (20.0 * np.pi) ** 2,
    ),
    "unnamed_tone": Example(strengths=_LINE, shapes={**_PHASE, "frequency_Hz": 3.0}, signature=tone),
    "unnamed_drift": Example(
        strengths={"mode1_deg": 0.2, "mode2_deg": -0.1, "mode3_deg": 0.05, "mode4_deg": 0.05},
        shapes={},
        signature=modes,
    ),
    "unnamed_creep": Example(
        strengths=_LINE,
        shapes={**_PHASE, "time_constant_s": 3.0, "at_s": 8.0},
        signature=creep,
    ),
    "unnamed_bump": Example(
        strengths={"height_deg": 0.3}, shapes={"centre_deg": 77.0, "width_deg": 12.0}, signature=bump
    ),
    "unnamed_seam": Example(strengths={"step_deg": 0.2}, shapes={"centre_deg": 77.4}, signature=seam),
    "unnamed_flanks": Example(
        strengths={"height_deg": 0.1}, shapes={"centre_deg": 77.0, "width_deg": 12.0}, signature=over_flanks
    ),
    "unnamed_burst": Example(
        strengths={"rms_deg": 0.3}, shapes={"first_row": 40.0, "last_row": 90.0}, signature=None, memory=True
    ),
}
