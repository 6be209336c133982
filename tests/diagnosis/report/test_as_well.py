"""A pulley or a gear makes the line that a magnet's order does, but for what that does to the channels' radius."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.report.as_well import _other_makers
from twin.catalogue import find

_SHAFT_DEG = np.arange(0.0, 720.0, 2.0)


def named(*, channels: bool, radius: float = 0.0) -> tuple[list[str], str]:
    """What the answer says of a line of order 5: what may be behind it, and what would tell.

    The radius has a wave of the same order, so many times as large as that of the direction.
    """
    wave, size = np.exp(5j * np.radians(_SHAFT_DEG)), np.radians(0.2)
    noise = np.radians(np.random.default_rng(4).normal(0.0, 0.02, (2, _SHAFT_DEG.size)))
    angle = np.radians(_SHAFT_DEG) + size * wave.imag + noise[0]
    vectors = 500.0 * (1.0 + radius * size * wave.real + noise[1]) * np.exp(1j * angle)
    raw = {"vx": vectors.real, "vy": vectors.imag} if channels else {}
    columns = {"reference_deg": _SHAFT_DEG, "measured_deg": np.degrees(angle) % 360.0, **raw}
    (cause,) = explain(columns).to_dict()["causes"]
    assert cause["name"] == "magnet_harmonic"
    return cause["indistinguishable_from"], cause["to_tell_apart"]


def test_mechanics_may_stand_behind_a_line_of_an_angle_alone() -> None:
    rivals, told = named(channels=False)
    assert rivals == ["mechanics"]
    assert "turn the magnet on its shaft" in told


def test_a_line_that_leaves_the_radius_alone_may_be_that_of_mechanics() -> None:
    """An uneven turn of the shaft turns the field as a whole."""
    rivals, told = named(channels=True)
    assert rivals == ["mechanics"]
    assert "turn the magnet on its shaft" in told


@pytest.mark.parametrize("radius", [1.0, -1.0, 0.3])
def test_a_line_that_the_radius_has_too_is_the_magnets(radius: float) -> None:
    """A part of the field that turns so many times as fast as the shaft is now along it, now across."""
    assert named(channels=True, radius=radius) == ([], "")


@pytest.mark.parametrize(("zero_deg", "turns", "drifts"), [(0.0, 1, True), (40.0, 1, False), (0.0, 2, False)])
def test_one_turn_from_the_word_0_may_have_drifted(zero_deg: float, turns: int, drifts: bool) -> None:
    """A factor of 0.99 makes a ramp with its step where the words begin anew, a drift where the record begins."""
    shaft = np.arange(0.0, 360.0 * turns, 3.0)
    read = np.mod(shaft + zero_deg + 0.4 * np.sin(np.radians(shaft)), 360.0)
    noisy = 0.99 * read + np.random.default_rng(6).normal(0.0, 0.02, shaft.size)
    (cause,) = explain({"reference_deg": shaft, "measured_deg": noisy}).to_dict()["causes"]
    assert cause["name"] == "scale_error"
    assert cause["indistinguishable_from"] == (["zero_drift"] if drifts else [])
    assert ("record a second turn" in cause["to_tell_apart"]) == drifts


@pytest.mark.parametrize(("turns", "again"), [(1, ["stale_frames"]), (2, [])])
def test_a_word_that_holds_once_may_be_a_frame_repeated(turns: int, again: list[str]) -> None:
    shaft = np.arange(0.0, 360.0 * turns, 1.0)
    read = np.round((shaft + 0.4 * np.sin(np.radians(shaft))) % 360.0 / 360.0 * 4096) * (360.0 / 4096)
    read[(read > 100.0) & (read < 108.0)] = 100.0 - 100.0 % (360.0 / 4096)
    causes = explain({"reference_deg": shaft, "measured_deg": read}).to_dict()["causes"]
    # Beside the grid, which is all that is left of a sweep without noise.
    (cause,) = [cause for cause in causes if cause["name"] != "output_quantisation"]
    assert cause["name"] == "dead_zone"
    assert cause["indistinguishable_from"] == again
    assert ("at the same angles again" in cause["to_tell_apart"]) == bool(again)


def test_other_motors_that_make_the_same_lines_are_named() -> None:
    """Orders 6, 8 and 12: 6 slots and 8 poles, or 6 slots and 4 poles, of which 8 and 12 are multiples."""
    lines = [{"slots": 6.0, "poles": 8.0, "order": order} for order in (6.0, 8.0, 12.0)]
    ((said, told),) = _other_makers(find("motor_poles"), lines)
    assert said == "motor_poles of 6 slots and 4 poles"
    assert told == "count them on the part itself"
    twelve = [{"slots": 12.0, "poles": 14.0, "order": order} for order in (12.0, 14.0, 24.0, 28.0)]
    assert _other_makers(find("motor_poles"), twelve) == []
    assert _other_makers(find("magnet_harmonic"), [{"order": 4.0}]) == []
