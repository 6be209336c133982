"""A simulated coast: mechanics, the columns of a bench without a reference, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenarios.commands.coast import Coast
from tests.command_line import halltwin
from twin.angles import TAU
from twin.presets import read_twin_or_preset


def columns(path: Path) -> dict[str, np.ndarray]:
    names = path.read_text(encoding="utf-8").partition("\n")[0].split(",")
    return dict(zip(names, np.loadtxt(path, delimiter=",", skiprows=1).T, strict=True))


@pytest.mark.parametrize("dry_share", [0.0, 0.3, 0.999, 1.0 - 1e-9, 1.0])
@pytest.mark.parametrize("stop_rpm", [None, 60.0])
def test_a_coast_slows_as_its_friction_says(dry_share: float, stop_rpm: float | None) -> None:
    motion = Coast(start_rpm=1200.0, stop_rpm=stop_rpm, time_s=4.0, dry_share=dry_share).motion()
    time, speed = motion.time_s, motion.speed_rad_s
    assert len(motion) == 8000
    assert speed[0] == pytest.approx(1200.0 * TAU / 60.0)
    slowing = -np.gradient(speed, time)[1:-1]
    last = speed[-1] - slowing[-1] / 2000.0
    assert last == pytest.approx((stop_rpm or 120.0) * TAU / 60.0, rel=2e-3)
    # the speed is what the angle does
    np.testing.assert_allclose(np.gradient(motion.shaft_rad, time)[1:-1], speed[1:-1], rtol=1e-5)
    # and the friction a dry part and one that follows the speed
    wanted = slowing[0] * (dry_share + (1.0 - dry_share) * speed[1:-1] / speed[1])
    np.testing.assert_allclose(slowing, wanted, rtol=5e-3)


def test_a_shaft_may_coast_to_rest() -> None:
    speed = Coast(stop_rpm=0.0, time_s=2.0).motion().speed_rad_s
    assert speed[-1] == pytest.approx(0.0, abs=0.2)
    assert np.all(np.diff(speed) < 0.0)


def test_a_coast_is_logged_without_a_reference(tmp_path: Path) -> None:
    path = tmp_path / "coast.csv"
    ended = halltwin("simulate", "--coast", "--coast-time", "3", "--rate", "1000", "--seed", "4", "-o", path)
    assert ended.code == 0, ended.err
    found = columns(path)
    assert list(found) == ["time_s", "measured_deg"]
    motion = Coast(time_s=3.0, rate_Hz=1000.0).motion()
    np.testing.assert_allclose(found["time_s"], motion.time_s, atol=1e-9)
    wanted = read_twin_or_preset("imc-14bit").simulate(motion, seed=4).measured_deg
    np.testing.assert_allclose(found["measured_deg"], wanted, atol=1e-6)


def test_reference_and_channels_are_recorded_where_they_are_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "coast.csv"
    halltwin("simulate", "--coast", "--rate", "500", "--reference", "--channels", "-o", path)
    found = columns(path)
    assert list(found) == ["time_s", "reference_deg", "measured_deg", "vx", "vy"]
    off = np.radians(found["measured_deg"] - found["reference_deg"])
    assert np.degrees(np.abs(np.angle(np.exp(1j * off)))).max() < 5.0


def test_a_spin_at_two_speeds_may_have_no_reference(tmp_path: Path) -> None:
    path = tmp_path / "spin.csv"
    speeds = ("--speed-rpm", "600", "--speed-rpm", "1800", "--turns", "4", "--points", "64")
    assert halltwin("simulate", *speeds, "--no-reference", "--no-channels", "-o", path).code == 0
    found = columns(path)
    assert list(found) == ["time_s", "measured_deg", "direction", "speed_rpm"]
    assert set(found["speed_rpm"]) == {600.0, 1800.0}


def test_noise_takes_the_place_of_the_twins_own(tmp_path: Path) -> None:
    read = []
    for name, noise in (("still", "0"), ("noisy", "0.2")):
        path = tmp_path / f"{name}.csv"
        assert halltwin("simulate", "--coast", "--noise", noise, "-o", path).code == 0
        read.append(columns(path)["measured_deg"])
    off = np.degrees(np.angle(np.exp(1j * np.radians(read[1] - read[0]))))
    assert np.std(off) == pytest.approx(0.2, rel=0.1)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--coast", "--turns", "3"), "--turns is of a protocol, and --coast a motion of its own"),
        (("--coast", "--speed-rpm", "60"), "--speed-rpm is of a protocol"),
        (("--coast", "--temperatures", "25"), "--temperatures is of a protocol"),
        (("--dry-share", "0.2"), "--dry-share is of a coast; add --coast"),
        (("--coast", "--rate", "100"), "rate is 100 Hz; expected at least 200 Hz, 4 readings a turn at 3000 rpm"),
        (("--coast", "--stop-rpm", "3000"), "expected from 0 to below the start speed of 3000 rpm"),
        (("--coast", "--stop-rpm", "0", "--dry-share", "0"), "without dry friction no shaft stops"),
        (("--coast", "--coast-time", "1e5", "--rate", "1000"), "readings (coast-time times rate) is 1e+08"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    ended = halltwin("simulate", *arguments, "-o", path)
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    assert says in ended.err
    assert not path.exists()
