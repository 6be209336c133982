"""explain and compensate of logs without a reference: what is found, what is left open, and what is refused."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from diagnosis import Explanation, explain
from diagnosis.progress import Progress
from diagnosis.report.console import text
from diagnosis.report.explain_plot import residual_figure
from diagnosis.spin.of_log import sweeps_of
from tests.command_line import halltwin
from tests.hidden.spins.generator import draw
from tests.hidden.spins.judging import left_by
from tests.spin_answerer import explained
from twin.errors import SweepError
from twin.spin import Spin

TIME = np.arange(0.0, 4.0, 0.001)


def even(turns_per_s: float, *, order: int = 1, error_deg: float = 0.5, seed: int = 1) -> dict[str, Any]:
    """A shaft at one speed, and a sensor with an error of one order."""
    angle = 360.0 * turns_per_s * TIME
    noise = 0.03 * np.random.default_rng(seed).standard_normal(TIME.size)
    read = angle + error_deg * np.cos(order * np.radians(angle)) + noise
    return {"time_s": TIME, "measured_deg": np.mod(read, 360.0)}


def stop_with_one(progress: Progress) -> None:
    """End the search as soon as it holds a cause."""
    if progress.causes:
        raise StopIteration


def test_the_motion_is_a_stage_and_who_stops_there_gets_what_there_is() -> None:
    """On one thread of the linear algebra as all else."""
    told: list[tuple[str, set[int]]] = []

    def stop(progress: Progress) -> None:
        told.append((progress.stage, {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}))
        raise StopIteration

    with threadpool_limits(2, user_api="blas"):
        answer = explain(even(9.0, order=5), progress=stop).to_dict()
    assert told[0] == ("estimated_motion", {1})
    assert answer["verdict"] == "stopped"
    assert answer["cut_short"]["stage"] == "estimated_motion"
    assert answer["motion"]["not_separable"] == list(range(1, 33))


@cache
def at_one_speed() -> Explanation:
    return explain(even(9.0, order=5))


def test_what_was_estimated_is_no_column_of_the_log() -> None:
    found = at_one_speed()
    assert found.to_dict()["sweep"]["columns"] == ["time_s", "measured_deg"]
    labels = {axis.get_xlabel() for axis in residual_figure(found.discovery).axes}
    assert "estimated shaft angle [deg]" in labels
    assert not any("reference" in label for label in labels)


def test_at_one_speed_a_cause_may_be_a_torque() -> None:
    answer = at_one_speed().to_dict()
    assert [cause["name"] for cause in answer["causes"]] == ["magnet_harmonic"]
    assert "torque_ripple" in answer["causes"][0]["indistinguishable_from"]
    assert "second speed" in answer["causes"][0]["to_tell_apart"]
    assert answer["motion"]["not_separable"] == list(range(1, 33))
    assert "orders 1 to 32" in text(answer, width=400)


def test_a_cogging_of_a_higher_order_than_is_looked_for_may_be_a_torque_too() -> None:
    """Of 40 teeth."""
    (cause,) = explain(even(9.0, order=40, error_deg=0.1)).to_dict()["causes"]
    assert "torque_ripple" in cause["indistinguishable_from"]
    assert "second speed" in cause["to_tell_apart"]


def test_a_cogging_and_its_double_may_be_a_torque_too() -> None:
    """Of 18 teeth: to the sensor it is one of 18 periods, whose double lies above the orders that are looked for."""
    log, angle = even(9.0, order=18, error_deg=0.4), 360.0 * 9.0 * TIME
    log["measured_deg"] = np.mod(log["measured_deg"] + 0.1 * np.cos(36.0 * np.radians(angle)), 360.0)
    causes = explain(log).to_dict()["causes"]
    assert causes[0]["name"] == "multipole"
    assert all("torque_ripple" in cause["indistinguishable_from"] for cause in causes)


def test_at_one_speed_a_ripple_of_the_reference_is_two_waves_in_time() -> None:
    answer = at_one_speed().to_dict()
    assert answer["not_visible"]["reference_ripple"] == ["a reference|two speeds|vx"]
    assert "reference_ripple" not in answer["in_factors"]
    assert "reference_ripple (one speed, no reference)" in text(answer, width=400)


def test_behind_a_rounding_too_a_cause_may_be_a_torque() -> None:
    """Its wave is one no longer, and has orders that no torque is looked for at."""
    rows = even(9.0, order=5)
    step = 360.0 / 2.0**12
    answer = explain({**rows, "measured_deg": step * np.round(rows["measured_deg"] / step)}).to_dict()
    told = {cause["name"]: cause["indistinguishable_from"] for cause in answer["causes"]}
    assert "torque_ripple" in told["magnet_harmonic"]


def test_a_frame_that_is_sent_again_is_no_torque() -> None:
    rows = even(9.0, order=5)
    again = np.arange(50, TIME.size, 40)
    rows["measured_deg"][again] = rows["measured_deg"][again - 1]
    told = {cause["name"]: cause["indistinguishable_from"] for cause in explain(rows).to_dict()["causes"]}
    assert "torque_ripple" not in told["stale_frames"]
    assert "torque_ripple" in told["magnet_harmonic"]


def test_what_grows_with_the_current_may_be_the_torque_that_the_current_makes() -> None:
    """At two speeds too: that torque is not locked to the angle."""
    logs, some = [], slice(1000)
    for turns_per_s in (9.0, 25.0):
        rows, current = even(turns_per_s, error_deg=0.0), 1.0 + np.cos(2.0 * np.pi * 3.3 * TIME)
        turned = 0.2 * current * np.cos(2.0 * np.pi * turns_per_s * TIME)
        told = {**rows, "measured_deg": np.mod(rows["measured_deg"] + turned, 360.0), "current_a": current}
        logs.append({name: values[some] for name, values in told.items()})
    (cause,) = explain(logs, progress=stop_with_one).to_dict()["causes"]
    assert cause["name"] == "motor_field"
    assert cause["indistinguishable_from"] == ["torque_ripple"]
    assert "coasts" in cause["to_tell_apart"]


def test_a_search_that_was_cut_short_says_too_what_may_be_a_torque() -> None:
    found = explain(even(9.0, order=5), progress=stop_with_one)
    (cause,) = found.to_dict()["causes"]
    assert not cause["rivals_sought"]
    assert cause["indistinguishable_from"] == ["torque_ripple"]
    words = " ".join(found.summary().split())
    assert "cannot be told from: torque_ripple" in words
    assert "what else it may be was not looked for" in words


def test_at_two_speeds_it_may_not() -> None:
    answer = explain([even(9.0, order=5), even(25.0, order=5, seed=2)]).to_dict()
    assert [cause["name"] for cause in answer["causes"]] == ["magnet_harmonic"]
    assert "torque_ripple" not in answer["causes"][0]["indistinguishable_from"]
    assert 5 not in answer["motion"]["not_separable"]
    assert answer["causes"][0]["parameters"]["amplitude_deg"]["value"] == pytest.approx(0.5, abs=0.01)


def test_what_a_reference_does_is_not_looked_for() -> None:
    lacks = at_one_speed().to_dict()["not_visible"]
    assert {"backlash", "index_slip", "drive_ripple", "zero_drift", "latency"} <= set(lacks)
    assert "a reference" in lacks["index_slip"]


def test_a_coast_of_the_independent_generator_is_corrected(tmp_path: Path) -> None:
    """To 0.02 deg over orders 1 to 16, of 0.2 to 0.7: cogging, an unbalance and friction that follows the angle."""
    drawn = draw("coast", seed=11)
    _, corrected, _ = explained([str(path) for path in drawn.write(tmp_path)])
    left = left_by(corrected, drawn.at_rest)
    assert left.rms_deg < 0.02 < 0.1 * left.raw_rms_deg * 10.0


def test_a_channel_that_is_read_late_is_named(tmp_path: Path) -> None:
    """By what grows with the speed; what it moves the shaft by, alike at all angles, no figure counts."""
    drawn = draw("several_speeds", seed=789037750, causes=("xy_skew",))
    answer, corrected, _ = explained([str(path) for path in drawn.write(tmp_path)])
    assert [cause["name"] for cause in answer["causes"]] == ["xy_skew"]
    assert answer["extended"]["rms_deg"] < answer["baseline"]["rms_deg"]
    assert left_by(corrected, drawn.at_rest).rms_deg < 0.005


def test_compensate_takes_such_a_log(tmp_path: Path) -> None:
    log = tmp_path / "spin.csv"
    rows = even(9.0)
    np.savetxt(log, np.column_stack(list(rows.values())), delimiter=",", header=",".join(rows), comments="")
    done = halltwin("compensate", log, "--table", tmp_path / "table.csv")
    assert done.code == 0
    table = np.genfromtxt(tmp_path / "table.csv", delimiter=",", names=True, comments="#")
    assert len(table) == 64


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"time_s": TIME, "measured_deg": np.full(TIME.size, 20.0)}, "the shaft stands still, at 20 deg"),
        ({"time_s": TIME[::-1], "measured_deg": 90.0 * TIME}, "row 2, column time_s: found 3.998 after 3.999"),
        ({"time_s": TIME[:20], "measured_deg": 90.0 * TIME[:20]}, "20 usable rows and no reference_deg"),
        ({"time_s": 0.0 * TIME, "measured_deg": 90.0 * TIME}, "column time_s: every row is 0"),
        # At each angle once: what bends the motion there is as good an error of the sensor.
        ({"time_s": TIME, "measured_deg": 1.8 * 90.0 * TIME % 360.0}, r"\(1.8 turns\).* each angle passed twice"),
    ],
)
def test_what_is_no_spin_is_refused_with_the_reason(columns: dict[str, Any], said: str) -> None:
    with pytest.raises(SweepError, match=said):
        explain(columns)


def test_columns_say_which_of_a_logs_are_those_of_a_spin(tmp_path: Path) -> None:
    log = tmp_path / "own.csv"
    rows = even(9.0)
    np.savetxt(
        log,
        np.column_stack([1e3 * rows["time_s"], np.radians(rows["measured_deg"])]),
        delimiter=",",
        header="t_ms,ang",
        comments="",
    )
    done = halltwin(
        "compensate", log, "--columns", "time_s=t_ms:ms, measured_deg=ang:rad", "--table", tmp_path / "t.csv"
    )
    assert done.code == 0, done.err


def test_what_a_torque_may_have_done_is_in_the_intervals() -> None:
    """A shaft that a torque turns to and fro once a turn, at one speed: the sensor's own offset is none."""
    swing = even(9.0, error_deg=0.5)
    told = explain(swing).to_dict()["extended"]["parameters"]
    for name in ("Vx_over_Ax", "Vy_over_Ay"):
        assert told[name]["low"] < 0.0 < told[name]["high"]
    assert abs(told["Vy_over_Ay"]["value"]) > 0.008 > told["Vy_over_Ay"]["as_named"][1] - told["Vy_over_Ay"]["value"]
    assert told["Vy_over_Ay"]["open_by"] == ["torque_ripple"]
    # What is not seen of an order no torque has done.
    assert told["gain_ratio"]["high"] - told["gain_ratio"]["low"] < 1e-3
    amplitude = at_one_speed().to_dict()["causes"][0]["parameters"]["amplitude_deg"]
    assert amplitude["low"] == 0.0
    assert amplitude["as_named"] == pytest.approx([0.5, 0.5], abs=0.01)


@pytest.mark.parametrize("seed", [440220981, 128465933], ids=["seen on the way", "not seen"])
def test_at_two_speeds_a_cogging_does_not_grow(seed: int) -> None:
    """Of order 3, with a jerk from one speed to the other in which the motion is not told.

    On the way it is seen or not; what grows, friction that runs out, has no third harmonic that is stronger.
    """
    columns = draw("two_speeds", seed=seed).logs[0].columns
    (sweep,) = sweeps_of([Spin.from_columns({name: columns[name] for name in ("time_s", "measured_deg")})])
    assert sweep.set_aside > 200
    assert sweep.estimated is not None
    cogging = sweep.estimated.torques[2]
    speed = float(np.median(np.radians(6.0 * np.abs(sweep.speed_rpm))))
    assert cogging.scatter_rad_s2 > 100.0
    assert cogging.growing_rad_s * speed < 0.1 * cogging.scatter_rad_s2


@pytest.mark.parametrize("speeds", [(9.0, 25.0), (9.0, 15.0, 25.0)])
def test_what_two_speeds_tell_takes_the_rotor_for_one_piece(speeds: tuple[float, ...]) -> None:
    """A torque of order 3 turns the shaft by 0.1 deg at 9 turns/s, and by 1/speed^2 at others."""
    logs = [even(one, order=3, error_deg=0.1 * (9.0 / one) ** 2, seed=seed) for seed, one in enumerate(speeds)]
    answer = explain(logs).to_dict()
    assert [one["order"] for one in answer["motion"]["torque_ripple"]] == [3]
    assert answer["motion"]["of_one_piece"] == ([3] if len(speeds) == 2 else [])
    assert ("if the rotor turns as one piece" in text(answer, width=600)) is (len(speeds) == 2)


@pytest.mark.parametrize(("scale", "unit", "reads"), [(1.0, "", ""), (1e3, "milli", ":ms,"), (1e6, "micro", ":us,")])
def test_a_reading_each_second_may_be_one_each_millisecond(scale: float, unit: str, reads: str) -> None:
    columns = even(9.0, order=5)
    answer = explain(columns | {"time_s": scale * TIME}, progress=stop_with_one).to_dict()
    assert answer["motion"]["reading_every_s"] == pytest.approx(0.001 * scale)
    words = text(answer, width=600)
    assert (f"if these are {unit}seconds" in words) is bool(unit)
    assert (f'--columns "time_s=time_s{reads}measured_deg=measured_deg"' in words) is bool(unit)


@pytest.mark.parametrize(("frequency", "usb"), [(1000.0, True), (870.0, False)])
def test_a_wave_in_time_may_be_times_that_are_told_wrong(frequency: float, usb: bool) -> None:
    """Readings that are fetched every 0.25 ms, and taken up to 20 us from when they are said to be."""
    time = np.arange(2400) / 4000.0
    taken = time + 20e-6 * np.sin(2.0 * np.pi * frequency * time)
    noise = 0.03 * np.random.default_rng(3).standard_normal(time.size)
    found = explain({"time_s": time, "measured_deg": np.mod(360.0 * 41.3 * taken + noise, 360.0)})
    answer = found.to_dict()
    (told,) = answer["motion"]["times_off"]
    assert told["frequency_Hz"] == pytest.approx(frequency, abs=0.5)
    assert told["off_us"] == pytest.approx(20.0, rel=0.05)
    assert told["usb_frames"] is usb
    assert ("frames of a USB" in text(answer, width=400)) is usb
    assert answer["causes"][0]["indistinguishable_from"] == ["torque_ripple", "time_stamps"]
    assert "a wave of 20 us" in answer["causes"][0]["to_tell_apart"]
    assert "cannot be told from: torque_ripple, time_stamps" in text(answer, width=400)
