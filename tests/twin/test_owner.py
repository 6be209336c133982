"""Whose each parameter of the catalogue is."""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

from twin.catalogue import CATALOGUE, STAGES, find
from twin.effect import Owner
from twin.param import OWNER_OF_STAGE

OTHERS = {
    "mounting": {"stray_field": {"field_mT"}, "motor_field": {"field_mT"}},
    "bench": {"mains_pickup": {"x_percent", "y_percent"}},
    "recording": {
        **{"mains_pickup": {"frequency_Hz", "phase_deg"}, "reference_ripple": {"phase_deg"}},
        "error_code": {"fraction_percent", "run_rows"},
    },
}
"""Parameters that belong to another than most of their effect."""
WHOLE = {
    "mounting": {"zero", "magnet_harmonic", "magnet_misalignment"},
    "bench": {
        *(
            "backlash",
            "cardan_coupling",
            "bearing_wobble",
            "load_torsion",
            "drive_ripple",
            "motor_poles",
            "motor_field",
            "reference_eccentricity",
            "reference_quantisation",
        ),
        *("stray_field", "mains_pickup", "thermal_zero_shift", "unnamed_speed_zero", "unnamed_flanks"),
    },
    "recording": {
        *("noise", "zero_drift", "index_slip", "reference_rezero", "stale_frames", "bus_glitch"),
        *("unnamed_tone", "unnamed_drift", "unnamed_creep", "unnamed_burst"),
    },
}
"""Effects that belong to another than the device, which all others belong to."""


def test_every_parameter_belongs_to_whom_physics_says() -> None:
    for effect in CATALOGUE:
        usual = next((owner for owner, names in WHOLE.items() if effect.name in names), "device")
        for name in effect.params:
            other = (owner for owner, effects in OTHERS.items() if name in effects.get(effect.name, ()))
            assert effect.owner(name) == next(other, usual), f"{effect.name}.{name}"


def test_every_stage_has_an_owner() -> None:
    assert set(OWNER_OF_STAGE) == set(STAGES)
    assert set(OWNER_OF_STAGE.values()) <= set(get_args(Owner))


def test_a_parameter_that_says_it_goes_before_its_stage() -> None:
    effect = find("latency")
    told = replace(effect, params={"delay_us": replace(effect.params["delay_us"], owner="recording")})
    assert effect.owner("delay_us") == "device"
    assert told.owner("delay_us") == "recording"
