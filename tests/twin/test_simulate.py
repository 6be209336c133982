"""Simulated sweeps: protocols, presets, traces, and the throughput benchmark's own agreement."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenarios.commands.protocol import Protocol, numbers
from scenarios.commands.simulate import Outputs, run
from scenarios.commands.trace import trace
from tests.benchmarks.throughput import largest_difference_deg
from twin.angles import wrap
from twin.chain import Chain
from twin.errors import UserError
from twin.files import from_dict, to_dict, write_twin
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
    traced = Outputs(sweep=tmp_path / "a.csv", trace=tmp_path / "t.csv")
    run(name, traced, recorded=None, protocol=Protocol(), seed=1)
    run(name, Outputs(sweep=tmp_path / "b.csv"), recorded=None, protocol=Protocol(), seed=1)
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    sweep = Sweep.read(tmp_path / "a.csv")
    error = wrap(np.radians(sweep.measured_deg - sweep.reference_deg))
    assert 0.05 < np.degrees(np.max(np.abs(error))) < 4.0
    rows = [line for line in (tmp_path / "t.csv").read_text().splitlines() if not line.startswith("#")]
    assert len(rows) == 361
    header = rows[0].split(",")
    assert all(cell.rsplit("_", 1)[1] in ("s", "deg", "1", "mT", "uV") for cell in header)


def test_the_trace_ends_where_the_sweep_does() -> None:
    chain, motion = read_preset("imc-14bit"), Protocol().motion()
    traced, sweep = trace(chain, motion, seed=4), chain.simulate(motion, seed=4)
    np.testing.assert_allclose(traced.signals[-1].values[0] % 360.0, sweep.measured_deg, atol=1e-9)
    np.testing.assert_array_equal(traced.reference_deg, sweep.reference_deg)
    # What the stages did to the angle adds up to the error, to the second order of 0.1 deg errors.
    moved = sum(signal.moved_deg for signal in traced.signals)
    assert np.max(np.abs(moved - traced.error_deg)) < 1e-6


def test_the_trace_counts_in_the_twins_own_field_disk_and_plate() -> None:
    content = {
        "schema": "halltwin.twin/1",
        "hardware": {"field_mT": 80.0, "disk": {"gain": 2.0}, "plate": {"sensitivity_uV_per_mT": 50.0}},
        "effects": {
            "saturation": {"k_percent": 0.4},
            "offset": {"x_percent": 1.0},
            "gain_mismatch": {"ratio": 1.02},
            "stray_field": {"bx_mT": 1.6, "field_mT": 80.0},
        },
    }
    chain = from_dict(content)
    assert to_dict(chain)["hardware"] == content["hardware"]
    traced = trace(chain, Protocol(points=360).motion(), seed=1)
    signals = {signal.name: signal.values for signal in traced.signals}
    in_plane, vertical, volts = (signals[name] for name in ("field in the plane", "vertical field", "Hall voltage"))
    # 80 mT and the stray field; twice that under the disk, where saturation takes k / 2 of the middle of a turn.
    np.testing.assert_allclose(in_plane[0, [0, 180]], [81.6, -78.4], atol=1e-9)
    np.testing.assert_allclose(in_plane[1, [90, 270]], [80.0, -80.0], atol=1e-9)
    assert np.max(np.abs(vertical - 2.0 * in_plane)) == pytest.approx(0.004 * 163.2, rel=0.1)
    # 50 uV/mT, 1 % of 160 mT more on x, 1.02 times as much on y.
    np.testing.assert_allclose(volts[0], 50.0 * (vertical[0] + 1.6), rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(volts[1], 50.0 * 1.02 * vertical[1], rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("name", preset_names())
def test_a_presets_trace_is_in_its_own_units(name: str) -> None:
    chain = read_preset(name)
    traced = trace(chain, Protocol().motion(), seed=1)
    signals = {signal.name: signal.values for signal in traced.signals}
    size = {key: float(np.max(np.hypot(*signals[key]))) for key in ("field in the plane", "vertical field")}
    # Misalignment, stray field and saturation change the amplitudes by some percent at most.
    assert size["field in the plane"] == pytest.approx(chain.nominal_mT, rel=0.05)
    assert size["vertical field"] == pytest.approx(chain.parts.disk.gain * chain.nominal_mT, rel=0.05)
    assert f"{chain.nominal_mT:.4g} mT" in traced.notes[0]


def test_a_recorded_motion_keeps_the_reference(tmp_path: Path) -> None:
    chain = Chain().with_effect("reference_eccentricity", amplitude_deg=0.3).with_effect("noise", rms_deg=0.05)
    chain.simulate(Protocol(points=90).motion(), seed=1).write(tmp_path / "recorded.csv")
    (tmp_path / "twin.toml").write_text(
        'schema = "halltwin.twin/1"\n[effects.reference_eccentricity]\namplitude_deg = 0.3\n'
    )
    run(
        str(tmp_path / "twin.toml"),
        Outputs(sweep=tmp_path / "again.csv"),
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
        outputs = Outputs(sweep=tmp_path / "s.csv", plot=tmp_path / name)
        run("hall-misaligned", outputs, recorded=None, protocol=Protocol(), seed=0)
        assert (tmp_path / name).stat().st_size > 5_000


def test_a_file_that_bears_a_presets_name_is_not_passed_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_twin(tmp_path / "imc-14bit", Chain().with_effect("zero", zero_deg=12.0))
    with pytest.raises(UserError, match=r"imc-14bit: is a preset and also a file here; give the file as \./imc-14bit"):
        read_twin_or_preset("imc-14bit")
    assert read_twin_or_preset("./imc-14bit").values == {"zero": {"zero_deg": 12.0}}
    # A study's folder of that name is none.
    (tmp_path / "paper-encoder").mkdir()
    assert to_dict(read_twin_or_preset("paper-encoder")) == to_dict(read_preset("paper-encoder"))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: read_twin_or_preset("nothing"), "nothing: is no preset; give one of hall-12bit"),
        (
            lambda: read_twin_or_preset("imc-14bit.toml"),
            "imc-14bit.toml: no such file; the preset is named imc-14bit",
        ),
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
