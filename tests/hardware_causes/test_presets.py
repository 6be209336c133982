"""The study of the presets counts a name as false, and a cause as missed, where it is."""

from __future__ import annotations

from tests.hardware_causes.presets import CLEAR, Answer, asked, clear, held
from twin.presets import preset_names, read_preset


def test_names_are_held_against_what_the_preset_has() -> None:
    assert held(read_preset("imc-14bit")) >= {"hysteresis", "saturation", "magnet_misalignment", "latency"}
    assert "offset" not in held(read_preset("imc-14bit"))
    answer = Answer((("hysteresis", "backlash"), ("drive_ripple",)))
    assert answer.false(frozenset({"hysteresis"}))
    assert not answer.false(frozenset({"backlash", "drive_ripple"}))
    assert answer.missed(frozenset({"saturation", "backlash"})) == {"saturation"}


def test_what_is_to_be_named_is_in_the_preset() -> None:
    assert set(CLEAR) == set(preset_names())
    for name in preset_names():
        assert clear(name, "both", channels=True) <= held(read_preset(name))


def test_a_preset_is_simulated_and_explained() -> None:
    answer = asked(read_preset("hall-12bit"), "turn", 0, channels=False)
    assert not answer.false(held(read_preset("hall-12bit")))
