"""Every kind of physics with its right answers: the named ones, the clean ones, and those outside the catalogue."""

from __future__ import annotations

from ..motion import Demands
from . import (
    converters,
    cordics,
    frames,
    loops,
    magnetisation,
    placed,
    plays,
    references,
    rim,
    rotor,
    shaken,
    swings,
    thermal,
)
from .kind import BOTH_WAYS, FAST, OVEN, STOPPED, Kind

MISPLACED = ("magnet_misalignment",)
"""What a misplaced magnet may be called, or left in the error model."""
SATURATION = (("saturation",),)
HYSTERESIS = (("hysteresis",),)
LATENCY = (("latency",),)
INL = (("adc_inl",), ("unnamed",))
UNNAMED = (("unnamed",),)
SEVERAL = ("unnamed",)
"""One mechanism may need several lines."""

NAMED: dict[str, Kind] = {
    "froehlich": Kind(magnetisation.froehlich_axes, SATURATION, channels=False),
    "froehlich_raw": Kind(magnetisation.froehlich_axes, SATURATION, channels=True),
    "tanh": Kind(magnetisation.tanh_axes, SATURATION),
    "langevin": Kind(magnetisation.langevin_axes, SATURATION),
    "cubic_1": Kind(magnetisation.cubic_axes(1.0), SATURATION),
    "cubic_2": Kind(magnetisation.cubic_axes(2.0), SATURATION),
    "cubic_3.3": Kind(magnetisation.cubic_axes(3.3), SATURATION, channels=False),
    "falling_harmonics": Kind(rim.falling_harmonics, (("magnet_harmonic",),), ("magnet_harmonic",), channels=False),
    "hysteresis_vector": Kind(plays.vector_stack, HYSTERESIS, protocols=BOTH_WAYS),
    # on each axis the lag ripples four times a turn
    "hysteresis_axes": Kind(plays.scalar_stack, HYSTERESIS, SEVERAL, protocols=BOTH_WAYS),
    "hysteresis_preisach": Kind(plays.preisach, HYSTERESIS, SEVERAL, protocols=BOTH_WAYS),
    "sar_capacitor": Kind(converters.sar_capacitor, INL, ("adc_inl", "unnamed"), STOPPED, channels=False),
    "stuck_in_sar": Kind(converters.stuck_in_sar, (("adc_stuck_bit",),), protocols=STOPPED, channels=False),
    "pipeline_gain": Kind(converters.pipeline_gain, INL, ("adc_inl", "unnamed"), STOPPED, channels=False),
    "charger_ripple": Kind(
        converters.charger_ripple,
        (("reference_ripple",),),
        ("reference_ripple",),
        protocols=("spin", "spin_both"),
        demands=Demands(time_column=True),
        channels=False,
        outcome_repeats=False,
    ),
    "cordic": Kind(cordics.guarded, (("cordic_truncation",),), channels=False, protocols=STOPPED),
    "drag_torsion": Kind(rotor.drag_torsion, (("load_torsion",), ("unnamed",)), protocols=("speeds",)),
    "universal_joint": Kind(rotor.universal_joint, (("cardan_coupling",),), channels=True),
    "play_friction": Kind(rotor.play_under_friction, (("backlash",),), protocols=BOTH_WAYS),
    "microsteps": Kind(rotor.microsteps, (("drive_ripple",),), ("drive_ripple",), demands=Demands(points=240)),
    "ball_bearing": Kind(
        rotor.ball_bearing, (("bearing_wobble",),), protocols=("many_turns", "spin"), demands=Demands(turns=5)
    ),
    "tracking_loop": Kind(loops.tracking_loop, LATENCY, protocols=FAST, channels=False),
    "low_pass": Kind(loops.low_pass, LATENCY, protocols=FAST, channels=False),
    "moving_average": Kind(loops.moving_average, LATENCY, protocols=FAST, channels=False),
    "digital_low_pass": Kind(loops.digital_low_pass, LATENCY, protocols=FAST, channels=False),
    "stale_bursts": Kind(
        frames.stale_bursts,
        (("stale_frames",),),
        protocols=STOPPED,
        channels=False,
        outcome_repeats=False,
        demands=Demands(single_readings=True),
    ),
    "top_bits": Kind(frames.top_bits, (("bus_glitch",),), channels=False, outcome_repeats=False),
    "eccentric_disc": Kind(references.eccentric_disc, (("reference_eccentricity",),), channels=True),
    "two_heads": Kind(references.two_heads, (("reference_eccentricity",),), channels=True),
    "sine_interpolation": Kind(
        references.sine_interpolation, (("drive_ripple",),), ("drive_ripple",), demands=Demands(points=240)
    ),
    "lost_once": Kind(
        references.lost_once,
        (("index_slip",),),
        protocols=("static", "many_turns"),
        demands=Demands(turns=2, time_column=True),
        outcome_repeats=False,
    ),
    "lost_several": Kind(
        references.lost_several,
        (("index_slip",),),
        ("index_slip",),
        ("static", "many_turns"),
        Demands(turns=4, time_column=True),
        outcome_repeats=False,
    ),
    "index_made_anew": Kind(
        references.index_made_anew,
        (("reference_rezero",),),
        protocols=("many_turns",),
        demands=Demands(turns=6, turn_column=True),
        outcome_repeats=False,
    ),
    "lagging_offset": Kind(thermal.lagging_offset, (("offset_drift",),), SEVERAL, OVEN, outcome_repeats=False),
    "curved_offset": Kind(thermal.curved_offset, (("offset_drift",),), SEVERAL, OVEN),
    "expanding_frame": Kind(thermal.expanding_frame, (("thermal_zero_shift",),), protocols=OVEN),
    "mobility": Kind(thermal.mobility, (("gain_drift",),), protocols=OVEN),
    "turned_plate": Kind(thermal.turned_plate, (("phase_drift",),), protocols=OVEN),
    "creeping_frame": Kind(
        thermal.creeping_frame,
        (("zero_drift",),),
        protocols=("many_turns", "static"),
        demands=Demands(turns=4, time_column=True),
        outcome_repeats=False,
    ),
    "hum": Kind(
        shaken.hum,
        (("mains_pickup",),),
        ("mains_pickup", *SEVERAL),
        ("spin", "spin_both", "speeds"),
        Demands(mains_free=True, time_column=True),
        channels=False,
        outcome_repeats=False,
    ),
}
"""With a name in the catalogue."""

CLEAN: dict[str, Kind] = {
    "disc": Kind(placed.disc_misplaced, tolerated=MISPLACED, channels=False),
    "disc_raw": Kind(placed.disc_misplaced, tolerated=MISPLACED, channels=True),
    "block_raw": Kind(placed.block_misplaced, tolerated=MISPLACED, channels=True),
    # over its hole the field bends so much that the displacements leave lines of their own
    "ring_on_axis_raw": Kind(placed.ring_on_axis, tolerated=(*MISPLACED, "magnet_harmonic", "unnamed"), channels=True),
    "tilted_raw": Kind(placed.tilted, tolerated=MISPLACED, channels=True),
    "chipped_raw": Kind(placed.chipped_disc, tolerated=(*MISPLACED, "magnet_harmonic"), channels=True),
    "uneven_disc_raw": Kind(placed.unevenly_magnetised, tolerated=(*MISPLACED, "magnet_harmonic"), channels=True),
    "vector_saturation_raw": Kind(magnetisation.vector_saturation, tolerated=(*MISPLACED, "saturation"), channels=True),
    "vector_saturation": Kind(magnetisation.vector_saturation, tolerated=MISPLACED, channels=False),
    "white_raw": Kind(shaken.white, channels=True, noisy=True),
    "sluggish": Kind(shaken.sluggish, noisy=True),
    "ringing_bracket": Kind(shaken.ringing_bracket, ((), ("unnamed",)), noisy=True, channels=False),
    "heavy_tails": Kind(shaken.heavy_tails, noisy=True),
    "long_cordic": Kind(cordics.long_enough, tolerated=("cordic_truncation",), channels=False),
    "opposite_heads": Kind(references.opposite_heads, channels=True),
    "coarse_word": Kind(shaken.white, tolerated=("output_quantisation",), noise_bits=12, noisy=True),
}
"""Nothing to name: inside the error model, or in the noise."""

OUTSIDE: dict[str, Kind] = {
    "far_off_axis": Kind(
        placed.far_off_axis,
        ((), ("unnamed",), ("magnet_harmonic",), MISPLACED),
        (*MISPLACED, "magnet_harmonic", "unnamed"),
    ),
    "ring_beside_shaft": Kind(
        placed.ring_beside_shaft,
        (("magnet_harmonic",), ("unnamed",)),
        (*MISPLACED, "magnet_harmonic", "unnamed"),
    ),
    "torsion_swing": Kind(
        rotor.torsion_inertia, (("load_torsion",), ("unnamed",)), own_motion=swings.swing, channels=False
    ),
    "torsion_run_up": Kind(
        rotor.torsion_inertia, (("load_torsion",), ("unnamed",)), own_motion=swings.run_up, channels=False
    ),
    "play_weight": Kind(rotor.play_under_weight, UNNAMED, ("unnamed", "magnet_harmonic"), ("static", "many_turns")),
    "gear_runout": Kind(rotor.gear_runout, UNNAMED, protocols=("many_turns", "spin"), demands=Demands(turns=5)),
    # Twice its order may be one that a motor has; and a sensor of as many periods makes both orders.
    "gear_mesh": Kind(rotor.gear_mesh, (*UNNAMED, ("mechanics",)), (*SEVERAL, "drive_ripple")),
    "belt": Kind(
        rotor.belt, UNNAMED, ("unnamed", "bearing_wobble"), protocols=("many_turns",), demands=Demands(turns=8)
    ),
    "self_heating": Kind(
        thermal.self_heating,
        (("unnamed",), ("offset_drift",)),
        SEVERAL,
        ("static", "many_turns"),
        Demands(turns=4, time_column=True),
        outcome_repeats=False,
    ),
    "head_vibration": Kind(
        rotor.head_vibration, UNNAMED, protocols=FAST, demands=Demands(time_column=True), outcome_repeats=False
    ),
    "knocked": Kind(
        shaken.knocked,
        UNNAMED,
        protocols=STOPPED,
        demands=Demands(turns=2, single_readings=True),
        noisy=True,
        outcome_repeats=False,
    ),
}
"""Structure that no cause of the catalogue is, or that it shares among several."""

KINDS: dict[str, Kind] = {**NAMED, **CLEAN, **OUTSIDE}
