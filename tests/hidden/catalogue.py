"""Which sweeps can show which cause, and who settles its parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from . import channel_causes as channel
from . import current_causes as current
from . import period_causes as periods
from . import shaft_causes as shaft
from . import word_causes as word
from .baseline import Injected, Setting
from .motion import NO_DEMANDS, Demands
from .protocols import PROTOCOLS


@dataclass(frozen=True)
class Cause:
    """A hidden cause as the draw sees it."""

    plan: Callable[[np.random.Generator, float, Setting], Injected]
    protocols: tuple[str, ...]
    demands: Demands = NO_DEMANDS
    easy_demands: Demands = NO_DEMANDS
    """Asked on the easy bench besides."""


ONE_TURN = tuple(PROTOCOLS)
BOTH_WAYS = ("static_both", "oven_both", "speeds")
STOPPED = ("static", "static_both", "many_turns", "oven")
OVENS = ("oven", "oven_both")
FAST = ("speeds", "speeds_one_way", "spin_both")
LIVE = ("speeds", "speeds_one_way", "spin", "spin_both")
SEQUENCE = ("static", "static_both", "many_turns", "speeds", "spin")
LONG = ("static", "static_both", "many_turns")

CAUSES: dict[str, Cause] = {
    "saturation": Cause(channel.plan_saturation, ONE_TURN),
    "clipping": Cause(channel.plan_clipping, ONE_TURN, Demands(points=100)),
    "magnet_harmonic": Cause(shaft.plan_magnet_harmonic, ONE_TURN),
    "multipole": Cause(periods.plan_multipole, ONE_TURN),
    "motor_field": Cause(current.plan_motor_field, ONE_TURN, Demands(single_readings=True)),
    "load_torsion": Cause(current.plan_load_torsion, ONE_TURN, Demands(single_readings=True)),
    "motor_poles": Cause(periods.plan_motor_poles, LONG, Demands(points=96, single_readings=True)),
    "cardan_coupling": Cause(shaft.plan_cardan_coupling, STOPPED, Demands(channels=True)),
    "reference_eccentricity": Cause(shaft.plan_reference_eccentricity, STOPPED, Demands(channels=True)),
    "drive_ripple": Cause(shaft.plan_drive_ripple, LONG, Demands(points=96, single_readings=True), Demands(points=300)),
    "bearing_wobble": Cause(
        shaft.plan_bearing_wobble, ("static", "many_turns", "spin"), Demands(turns=4, single_readings=True)
    ),
    "hysteresis": Cause(shaft.plan_hysteresis, BOTH_WAYS),
    "backlash": Cause(shaft.plan_backlash, BOTH_WAYS),
    "latency": Cause(shaft.plan_latency, FAST),
    "time_jitter": Cause(shaft.plan_time_jitter, ("speeds", "speeds_one_way"), Demands(single_readings=True)),
    "xy_skew": Cause(channel.plan_xy_skew, FAST),
    "reference_rezero": Cause(
        shaft.plan_reference_rezero, LONG, Demands(turns=4, turn_column=True, single_readings=True)
    ),
    "phase_drift": Cause(channel.plan_phase_drift, OVENS),
    "offset_drift": Cause(channel.plan_offset_drift, OVENS),
    "gain_drift": Cause(channel.plan_gain_drift, OVENS),
    "zero_drift": Cause(shaft.plan_zero_drift, LONG, Demands(turns=2, time_column=True, single_readings=True)),
    "index_slip": Cause(shaft.plan_index_slip, LONG, Demands(turns=2, time_column=True, single_readings=True)),
    "mains_pickup": Cause(channel.plan_mains_pickup, LIVE, Demands(time_column=True, mains_free=True)),
    "reference_ripple": Cause(channel.plan_reference_ripple, LIVE, Demands(time_column=True)),
    "reference_jitter": Cause(channel.plan_reference_jitter, ONE_TURN, Demands(single_readings=True)),
    "adc_stuck_bit": Cause(channel.plan_adc_stuck_bit, ONE_TURN, Demands(single_readings=True)),
    "cordic_truncation": Cause(word.plan_cordic_truncation, ONE_TURN, Demands(single_readings=True)),
    "output_quantisation": Cause(word.plan_output_quantisation, ONE_TURN, Demands(single_readings=True)),
    "stale_frames": Cause(word.plan_stale_frames, SEQUENCE, Demands(single_readings=True)),
    "bus_glitch": Cause(word.plan_bus_glitch, ONE_TURN, Demands(single_readings=True)),
}
