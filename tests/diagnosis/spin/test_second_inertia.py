"""A belt that resonates with a torque's order is told from a log that passes it, and from what only looks so."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.spin import smoother
from diagnosis.spin.of_log import sweeps_of
from diagnosis.spin.smoother import MotionFit, fitted_motion
from diagnosis.spin.torques import torque_columns
from tests.diagnosis.spin.test_explain import stop_with_one
from tests.diagnosis.spin.test_smoother import TIME, coasting, error_of, read
from tests.hidden.spins.generator import draw
from tests.hidden.spins.rotor import Belt, Hum, Rotor, Wave, integrate
from twin.spin import Spin

BELT = Belt(frequency_Hz=30.0, damping=0.03, inertia=0.3)
RESONANCE_HZ = 30.0 * np.sqrt(1.3)


@cache
def coast_fit(*, seek: bool, belt: bool = True, hum: bool = False) -> MotionFit:
    """From 120 to 30 rad/s under a cogging of order 3, which passes the resonance half way."""
    rotor = Rotor(
        coulomb=15.0 * (1.3 if belt else 1.0),
        waves=(Wave(3, 60.0, 0.7),),
        belt=BELT if belt else None,
        hums=(Hum(47.0, 150.0, 0.2),) if hum else (),
    )
    path = integrate(rotor, None, speed=120.0, duration_s=float(TIME[-1]) + 0.01)
    return fitted_motion(read(path.at(TIME)[0]), TIME, [slice(0, TIME.size)], seek_second=seek)


def test_a_coast_tells_the_belt_and_with_it_the_sensor() -> None:
    found = coast_fit(seek=True)
    assert found.second is not None
    truth = np.log([2.0 * np.pi * RESONANCE_HZ, BELT.damping, BELT.inertia])
    z = (found.second.logarithms - truth) / np.sqrt(np.diag(found.second.covariance))
    assert np.abs(z).max() < 4.0
    assert np.sqrt(found.second.covariance[0, 0]) < 0.01
    sd = np.sqrt(np.diag(found.terms.covariance))
    assert error_of(found, 3) == pytest.approx([0.004, 0.0], abs=5.0 * sd[4])
    assert np.median(found.noise_rad) == pytest.approx(3e-4, rel=0.1)


def test_a_swing_does_not_pass_for_a_damping() -> None:
    """Of three torques, of which two pass the resonance: a damping of 100/s would hold them all."""
    rotor = Rotor(
        coulomb=18.0,
        viscous=0.05,
        waves=(Wave(1, 3.0, 0.4), Wave(3, 24.0, 1.0), Wave(8, 78.0, 2.0)),
        belt=Belt(frequency_Hz=25.0, damping=0.05, inertia=0.4),
    )
    path = integrate(rotor, None, speed=125.0, duration_s=float(TIME[-1]) + 0.01)
    found = fitted_motion(read(path.at(TIME)[0]), TIME, [slice(0, TIME.size)], seek_second=True)
    assert found.second is not None
    away = found.second.logarithms - np.log([2.0 * np.pi * 25.0 * np.sqrt(1.4), 0.05, 0.4])
    assert np.all(np.abs(away) < 4.0 * np.sqrt(np.diag(found.second.covariance)))
    assert found.damping_per_s < 2.0
    assert np.median(found.noise_rad) == pytest.approx(3e-4, rel=0.1)


def test_two_steady_speeds_pass_no_resonance() -> None:
    """What wavers a little about each of them would have to tell it."""
    logs = []
    for seed, (speed, wavers) in enumerate(((60.0, 0.02), (130.0, 0.03))):
        angle = speed * (TIME + wavers / 9.0 * np.sin(9.0 * TIME))
        torque = 0.004 * (60.0 / speed) ** 2 * np.cos(3.0 * angle + 1.0)
        logs.append(read(angle + torque, seed=seed + 1))
    slices = [slice(0, TIME.size), slice(TIME.size, 2 * TIME.size)]
    time = np.concatenate([TIME, TIME[-1] + 1.0 + TIME])
    with patch.object(smoother, "tied", side_effect=AssertionError("looked for")):
        found = fitted_motion(np.concatenate(logs), time, slices, seek_second=True)
    assert found.second is None


def test_two_hums_of_the_torque_are_no_resonance() -> None:
    """Of 47 and 49 Hz: one wave does not take both away, and what is left has no damping."""
    rotor = Rotor(coulomb=15.0, waves=(Wave(3, 60.0, 0.7),), hums=(Hum(47.0, 100.0, 0.2), Hum(49.0, 100.0, 1.2)))
    path = integrate(rotor, None, speed=120.0, duration_s=float(TIME[-1]) + 0.01)
    assert fitted_motion(read(path.at(TIME)[0]), TIME, [slice(0, TIME.size)], seek_second=True).second is None


def test_without_it_the_coast_is_off() -> None:
    """By more than ten times what is left with it: the belt is what the test above is about."""
    of_one_piece = coast_fit(seek=False)
    off, rest = (np.hypot(*(error_of(fit, 3) - [0.004, 0.0])) for fit in (of_one_piece, coast_fit(seek=True)))
    assert off > 10.0 * max(rest, 5e-5)


def test_a_rotor_of_one_piece_has_none() -> None:
    assert coast_fit(seek=True, belt=False).second is None
    assert fitted_motion(read(coasting()), TIME, [slice(0, TIME.size)], seek_second=True).second is None


def test_a_hum_of_the_torque_is_no_resonance() -> None:
    """150 rad/s^2 at 47 Hz turn the shaft by 0.1 deg, six times the noise."""
    assert coast_fit(seek=True, belt=False, hum=True).second is None


@cache
def of_two_speeds() -> tuple[Spin, dict[str, Any]]:
    """A log of an independent bench: 7.5 turns/s and then 25, a belt that resonates at 38.3 Hz, cogging of order 4."""
    drawn = draw("two_speeds", seed=1840982994)
    spin = Spin.from_columns({name: drawn.logs[0].columns[name] for name in ("time_s", "measured_deg")})
    return spin, dict(drawn.truth)


def test_the_way_from_one_speed_to_another_tells_it() -> None:
    """The rows of the way are set aside afterwards, and what they told stays."""
    spin, truth = of_two_speeds()
    assert truth["belt"]
    (sweep,) = sweeps_of([spin])
    assert sweep.set_aside > 100
    assert sweep.estimated is not None
    second = sweep.estimated.second
    assert second is not None
    away = second.logarithms - np.log([2.0 * np.pi * 38.3, 0.0203, 0.309])
    assert np.all(np.abs(away) < 4.0 * np.sqrt(np.diag(second.covariance)))
    # What torques may do is wider by how well it is told, in three ways.
    motion = sweep.motion()
    of_one_piece = replace(motion, estimated=replace(sweep.estimated, second=None))
    assert len(torque_columns(motion)) == len(torque_columns(of_one_piece)) + 3


@pytest.mark.parametrize("seed", [1957853800, 1278845361])
def test_the_way_from_one_speed_to_another_of_one_piece_tells_none(seed: int) -> None:
    """A log of an independent bench, with mains in the torque: what gains by chance does not do."""
    drawn = draw("two_speeds", seed=seed)
    assert not drawn.truth["belt"]
    (sweep,) = sweeps_of(
        [Spin.from_columns({name: drawn.logs[0].columns[name] for name in ("time_s", "measured_deg")})]
    )
    assert sweep.estimated is not None
    assert sweep.estimated.second is None


def test_the_answer_says_so() -> None:
    spin, _ = of_two_speeds()
    found = explain(spin, progress=stop_with_one)
    motion = found.to_dict()["motion"]
    resonance = motion["second_inertia"]["resonance_Hz"]
    assert resonance["value"] == pytest.approx(38.3, rel=0.02)
    assert 0.95 * resonance["value"] < resonance["low"] < resonance["high"] < 1.05 * resonance["value"]
    assert motion["of_one_piece"] == []
    words = " ".join(found.summary().split())
    assert "The rotor is not of one piece: a belt or a coupling ties an inertia to it" in words
    assert "if the rotor turns as one piece" not in words
