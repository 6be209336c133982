"""Spins on the bench: no reference on the bus, the shaft coasts or turns, and the Hall encoder alone is read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from diagnosis.spin.of_log import sweeps_of
from scenarios.bench.buses import Interface
from scenarios.bench.command import Options, run
from scenarios.bench.faults import Fault, parse
from scenarios.bench.replay import replay
from scenarios.bench.sequence import NodeGone, Patience
from scenarios.bench.spin import SpinJob, SpinPlan, Spun, measure_spin
from scenarios.bench.virtual import Setup, running
from scenarios.bench.world import DRY_AS_SPEED_RAD_S, FRICTION_PER_S
from scenarios.bench.written import files_of_spin
from scenarios.commands.coast import slowed
from tests.scenarios.bench.rig import quiet_encoder
from twin.angles import Array, wrap_deg
from twin.errors import UserError
from twin.motion import RPM, Motion
from twin.spin import Spin
from twin.sweep_reader import read_columns as read_any

SHORT = SpinPlan(coast=True, time_s=1.5, rate_Hz=400.0)
WORD_DEG = 360.0 / 2**14


def spun(output: Path, *, plan: SpinPlan = SHORT, faults: Sequence[str] = (), record: Path | None = None) -> Spun:
    """A spin of the quiet encoder on a bench without a reference."""
    parsed = [fault for text in faults for fault in parse(text)]
    open_bus = Interface().opener()
    with running(Setup(chain=quiet_encoder(), faults=parsed, reference=False), open_bus):
        return measure_spin(job_of(output, plan=plan, record=record), open_bus)


def job_of(output: Path, *, plan: SpinPlan = SHORT, record: Path | None = None) -> SpinJob:
    return SpinJob(
        plan=plan,
        output=output,
        files=files_of_spin(output, record=record),
        patience=Patience(timeout_s=0.05, attempts=100),
        record=record,
    )


def read_columns(path: Path) -> dict[str, Array]:
    return read_any(path, spin=True)


def coasted_deg(time_s: Array, rpm: float) -> Array:
    """How far a shaft coasts that is let go at a speed."""
    angle, _ = slowed(rpm * RPM, time_s, dry_as_rad_s=DRY_AS_SPEED_RAD_S, rate_per_s=FRICTION_PER_S)
    return np.degrees(angle)


def test_a_coast_is_what_the_encoder_reads_of_a_shaft_that_friction_slows(tmp_path: Path) -> None:
    found = spun(tmp_path / "coast.csv")
    columns = read_columns(tmp_path / "coast.csv")
    assert (found.readings, found.asked, list(columns)) == (600, 600, ["time_s", "measured_deg", "vx", "vy"])
    np.testing.assert_allclose(np.diff(columns["time_s"]), 1.0 / 400.0, atol=2e-7)
    # Up to 600 rpm in a second it turns by 1800 deg, half of what it would at that speed.
    shaft = 1800.0 + coasted_deg(columns["time_s"] - 1.0, 600.0)
    wanted = quiet_encoder().simulate(Motion.from_angle(np.radians(shaft), time_s=columns["time_s"], has_channels=True))
    assert np.max(np.abs(wrap_deg(columns["measured_deg"] - wanted.measured_deg))) <= 0.51 * WORD_DEG


def test_each_speed_both_ways(tmp_path: Path) -> None:
    plan = SpinPlan(coast=False, speeds_rpm=(150.0, 300.0), both_directions=True, time_s=0.5, rate_Hz=400.0)
    spun(tmp_path / "steady.csv", plan=plan)
    columns = read_columns(tmp_path / "steady.csv")
    speed = np.diff(np.unwrap(columns["measured_deg"], period=360.0)) / np.diff(columns["time_s"]) / 6.0
    each = [np.median(part) for part in np.split(speed, [200, 400, 600])]
    np.testing.assert_allclose(each, [150.0, -150.0, 300.0, -300.0], rtol=0.03)
    assert np.all(np.diff(columns["time_s"]) > 0.0)


def test_frames_that_are_lost_or_spoiled_are_asked_for_again(tmp_path: Path) -> None:
    spun(tmp_path / "undisturbed.csv")
    found = spun(tmp_path / "coast.csv", faults=["lost=0.02", "checksum=0.02", "duplicated=0.02"])
    assert found.counts["asked again"] > 10
    assert (tmp_path / "coast.csv").read_bytes() == (tmp_path / "undisturbed.csv").read_bytes()


def test_a_reading_that_was_spoiled_when_it_was_taken_is_left_out(tmp_path: Path) -> None:
    spun(tmp_path / "undisturbed.csv")
    found = spun(tmp_path / "coast.csv", faults=["spi=0.05"])
    assert 10 < found.counts["fault flag"] == 600 - found.readings < 60
    kept, whole = read_columns(tmp_path / "coast.csv"), read_columns(tmp_path / "undisturbed.csv")
    rows = np.isin(whole["time_s"], kept["time_s"])
    np.testing.assert_array_equal(kept["measured_deg"], whole["measured_deg"][rows])


@pytest.mark.parametrize("suffix", [".asc", ".log"])
def test_replay_gives_the_same_bytes(suffix: str, tmp_path: Path) -> None:
    log = tmp_path / f"bus{suffix}"
    spun(tmp_path / "live.csv", record=log, faults=["lost=0.02", "duplicated=0.02", "spi=0.02"])
    found = replay(log, tmp_path / "again.csv")
    assert isinstance(found, Spun)
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "live.csv").read_bytes()


def test_a_bench_that_stays_spins_anew_for_each_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first breaks off in the leg that the second begins with, under the same number."""
    open_bus = Interface().opener()

    def gone(*_: object, **__: object) -> None:
        raise NodeGone("gone")

    with running(Setup(chain=quiet_encoder()), open_bus):
        with monkeypatch.context() as broken:
            broken.setattr("scenarios.bench.spin._read_out", gone)
            with pytest.raises(UserError, match="begins anew"):
                measure_spin(job_of(tmp_path / "broken.csv"), open_bus)
        plan = SpinPlan(coast=True, speeds_rpm=(300.0,), time_s=1.5, rate_Hz=400.0)
        measure_spin(job_of(tmp_path / "coast.csv", plan=plan), open_bus)
    travel = np.ptp(np.unwrap(read_columns(tmp_path / "coast.csv")["measured_deg"], period=360.0))
    assert travel == pytest.approx(float(coasted_deg(np.array([1.4975]), 300.0)[0]), rel=0.02)


def test_the_motion_is_estimated_from_such_a_log(tmp_path: Path) -> None:
    run(Options(output=tmp_path / "coast.csv", spin="coast", spin_time_s=4.0, rate_Hz=500.0, seed=3))
    [sweep] = sweeps_of([Spin.from_columns(read_columns(tmp_path / "coast.csv"))])
    assert sweep.time_s is not None
    wanted = coasted_deg(sweep.time_s - 1.0, 600.0)
    off = wrap_deg(sweep.reference_deg - wanted)
    # The zero is not seen without a reference, nor are parts of a thousandth of a degree in a noise of 0.05.
    assert float(np.std(off)) < 0.01


def test_a_spin_that_breaks_off_leaves_nothing_but_says_what_to_do(tmp_path: Path) -> None:
    job = SpinJob(
        plan=SHORT,
        output=tmp_path / "coast.csv",
        files=files_of_spin(tmp_path / "coast.csv"),
        patience=Patience(timeout_s=0.01, attempts=3),
    )
    open_bus = Interface().opener()
    gone = Setup(chain=quiet_encoder(), faults=[Fault("gone", "hall", 100.0)], reference=False)
    with running(gone, open_bus), pytest.raises(UserError, match=r"Hall encoder did not answer.*begins anew"):
        measure_spin(job, open_bus)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"spin": "coats"}, "did you mean coast"),
        ({"spin": "coast", "closed_loop": True}, "--closed-loop is of a sweep"),
        ({"spin": "coast", "temperatures": "25,60"}, "--temperatures is of a sweep"),
        ({"spin": "coast", "restart": True}, "--restart is of a sweep"),
        ({"spin": "coast", "points": 36}, "--points is of a sweep"),
        ({"spin": "coast", "faults": ("lost:reference=0.1",)}, "no reference is on the bus"),
        ({"spin": "coast", "rate_Hz": 50.0, "speeds_rpm": (1200.0,)}, "expected at least 80 Hz"),
        ({"spin": "coast", "speeds_rpm": (36.9,)}, "steps of 0.5 rpm"),
        ({"spin": "coast", "spin_time_s": 100.0}, "readings of a leg"),
        ({"spin_time_s": 4.0}, "--spin-time is of a spin"),
        ({"rate_Hz": 400.0, "replay": Path("bus.log")}, "--rate is of a spin"),
    ],
)
def test_what_is_no_spin_is_refused_before_a_file_is_made(
    options: dict[str, object], said: str, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match=said):
        run(Options(output=tmp_path / "coast.csv", **options))  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())
