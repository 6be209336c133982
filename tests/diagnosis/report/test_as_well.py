"""Where nothing but angles is recorded, a pulley or a gear makes the line that a magnet's order does."""

from __future__ import annotations

import numpy as np

from diagnosis import explain

_SHAFT_DEG = np.arange(0.0, 720.0, 2.0)


def named(*, channels: bool) -> tuple[list[str], str]:
    """What the answer says of a line of order 5: what may be behind it, and what would tell."""
    error = 0.2 * np.sin(np.radians(5.0 * _SHAFT_DEG)) + np.random.default_rng(4).normal(0.0, 0.02, _SHAFT_DEG.size)
    angle = np.radians(_SHAFT_DEG + error)
    raw = {"vx": 500.0 * np.cos(angle), "vy": 500.0 * np.sin(angle)} if channels else {}
    columns = {"reference_deg": _SHAFT_DEG, "measured_deg": np.degrees(angle) % 360.0, **raw}
    (cause,) = explain(columns).to_dict()["causes"]
    assert cause["name"] == "magnet_harmonic"
    return cause["indistinguishable_from"], cause["to_tell_apart"]


def test_mechanics_may_stand_behind_a_line_of_an_angle_alone() -> None:
    rivals, told = named(channels=False)
    assert rivals == ["mechanics"]
    assert "turn the magnet on its shaft" in told


def test_raw_channels_leave_the_magnet() -> None:
    assert named(channels=True) == ([], "")
