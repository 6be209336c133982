"""Simulated sweeps: protocols, presets, traces, and the throughput benchmark's own agreement."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenarios.protocol import Protocol, numbers
from scenarios.simulate import run
from scenarios.trace import trace
from tests.benchmarks.throughput import largest_difference_deg
from twin.angles import wrap
from twin.chain import Chain
from twin.errors import UserError
from twin.presets import preset_names, read_preset, read_twin_or_preset
from twin.sweep import Sweep


def test_a_protocol_visits_every_condition() -> None:
    motion = Protocol(
        turns=2, points=36, both_directions=True, speeds_rpm=(60.0, 600.0), temperatures_c=(25.0, 85.0)
    ).motion()
    assert len(motion) == 2 * 36 * 2 * 2 * 2
    assert {"both directions", "two speeds", "two temperatures", "two turns", "vx", "several turns"} <= motion.provides
    assert np.all(np.diff(motion.time_s) > 0.0)
    # Time stamps and speed agree within each leg: 60 rpm is 360 deg a second.
    assert np.diff(motion.time_s)[0] * 360.0 == pytest.approx(10.0)


def test_stop_and_measure_has_no_speed() -> None:
    motion = Protocol(points=36).motion()
    assert "speed_rpm" not in motion.columns
    assert np.all(motion.speed_rad_s == 0.0)


@pytest.mark.parametrize("name", preset_names())
def test_presets_simulate_to_a_readable_sweep(name: str, tmp_path: Path) -> None:
    run(name, tmp_path / "a.csv", recorded=None, protocol=Protocol(), seed=1, trace_path=tmp_path / "t.csv")
    run(name, tmp_path / "b.csv", recorded=None, protocol=Protocol(), seed=1)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    sweep = Sweep.read(tmp_path / "a.csv")
    error = wrap(np.radians(sweep.measured_deg - sweep.reference_deg))
    assert 0.05 < np.degrees(np.max(np.abs(error))) < 4.0
    header = (tmp_path / "t.csv").read_text().splitlines()[1].split(",")
    assert all(cell.rsplit("_", 1)[1] in ("s", "deg", "1", "mT", "uV") for cell in header)


def test_the_trace_ends_where_the_sweep_does() -> None:
    chain, motion = read_preset("imc-14bit"), Protocol().motion()
    traced, sweep = trace(chain, motion, seed=4), chain.simulate(motion, seed=4)
    np.testing.assert_allclose(traced.signals[-1].values[0] % 360.0, sweep.measured_deg, atol=1e-9)
    np.testing.assert_array_equal(traced.reference_deg, sweep.reference_deg)
    # What the stages did to the angle adds up to the error, to the second order of 0.1 deg errors.
    moved = sum(signal.moved_deg for signal in traced.signals)
    assert np.max(np.abs(moved - traced.error_deg)) < 1e-6


def test_a_recorded_motion_keeps_the_reference(tmp_path: Path) -> None:
    chain = Chain().with_effect("reference_eccentricity", amplitude_deg=0.3).with_effect("noise", rms_deg=0.05)
    chain.simulate(Protocol(points=90).motion(), seed=1).write(tmp_path / "recorded.csv")
    (tmp_path / "twin.toml").write_text(
        'schema = "halltwin.twin/1"\n[effects.reference_eccentricity]\namplitude_deg = 0.3\n'
    )
    run(
        str(tmp_path / "twin.toml"),
        tmp_path / "again.csv",
        recorded=tmp_path / "recorded.csv",
        protocol=Protocol(),
        seed=2,
    )
    one, two = Sweep.read(tmp_path / "recorded.csv"), Sweep.read(tmp_path / "again.csv")
    np.testing.assert_allclose(two.reference_deg, one.reference_deg, atol=1e-6)
    assert two.vx is not None


def test_draws_the_trace(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    for name in ("trace.png", "trace.svg"):
        run(
            "hall-misaligned", tmp_path / "s.csv", recorded=None, protocol=Protocol(), seed=0, plot_path=tmp_path / name
        )
        assert (tmp_path / name).stat().st_size > 5_000


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: read_twin_or_preset("nothing"), "nothing: is no preset (hall-12bit"),
        (lambda: Protocol(points=0), "points is 0; expected a whole number from 8 to 1e+06"),
        (lambda: Protocol(speeds_rpm=(float("nan"),)), "speed-rpm is nan rpm; expected from 0 to 100000 rpm"),
        (lambda: numbers("temperatures", "25;60"), "temperatures is '25;60'; expected numbers with commas between"),
    ],
)
def test_mistakes_are_one_line(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(UserError) as refused:
        call()
    assert str(refused.value).startswith(message)
    assert "\n" not in str(refused.value)


def test_chain_and_loop_over_samples_agree() -> None:
    # One step of the 14-bit angle path at most: a rounding of a channel may fall the other way.
    assert largest_difference_deg(turns=1) < 360.0 / 2**14
