"""Recordings of one device explained together: what is common, what is each one's own, and what they part."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.explanation import Explanation
from diagnosis.factors.mounting import Mounting
from diagnosis.joining import joined
from diagnosis.report.explain_plot import residual_figure
from diagnosis.report.plotting import drawing
from scenarios.commands.protocol import Protocol
from tests.command_line import halltwin
from twin.air_gap import at_air_gap
from twin.angles import Array
from twin.catalogue import CATALOGUE
from twin.chain import Chain
from twin.each_recording import acts_in, everywhere
from twin.errors import UserError
from twin.files import read_twin
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement
from twin.motion import Motion
from twin.sweep import Sweep

THERE = np.radians(np.arange(0.0, 720.0, 4.0))
DEVICE = Chain().with_effect("offset", x_percent=0.8, y_percent=-0.5)


def recorded(
    device: Chain, name: str, *, zero_deg: float, noise_deg: float = 0.02, channels: bool = False, **stated: float
) -> Sweep:
    """One recording there and back, with its own zero, noise and conditions."""
    motion = Motion.from_angle(np.concatenate([THERE, THERE[::-1]]), has_channels=channels)
    chain = device.with_effect("zero", zero_deg=zero_deg).with_effect("noise", rms_deg=noise_deg)
    columns: dict[str, Array] = {column: np.full(len(motion), value) for column, value in stated.items()}
    sweep = chain.simulate(motion, seed=sum(map(ord, name)))
    return replace(sweep, name=name, **columns)  # type: ignore[arg-type]


@cache
def lagging() -> Explanation:
    """Two recordings of a lagging device, the second louder, its zero found anew."""
    device = DEVICE.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0)
    quiet = recorded(device, "quiet.csv", zero_deg=20.0)
    return explain([quiet, recorded(device, "loud.csv", zero_deg=20.4, noise_deg=0.06)])


def test_one_set_of_parameters_explains_both() -> None:
    found = lagging()
    assert [cause.name for cause in found.causes] == ["hysteresis"]
    lag = found.causes[0].parameters["lag_deg"]
    assert lag.low <= 0.1 <= lag.high
    answer = found.to_dict()
    assert answer["held_out_by"] == "recordings"
    quiet, loud = answer["recordings"]
    # Noise that is left is that of each, known to 5 % from 360 readings at two standard deviations.
    assert quiet["extended_rms_deg"] == pytest.approx(0.02, rel=0.1)
    assert loud["extended_rms_deg"] == pytest.approx(0.06, rel=0.1)
    assert abs(abs(loud["zero_deg"]) - abs(quiet["zero_deg"])) == pytest.approx(0.4, abs=0.02)
    level = found.discovery.fit.observations.level
    assert level[-1] / level[0] == pytest.approx(3.0, rel=0.15)
    assert quiet["rms_ratio"] < 1.1 > loud["rms_ratio"]
    assert "loud.csv" in found.summary()


def test_what_is_not_common_is_said() -> None:
    """A column that one recording lacks, and factors of another device in the units of the table."""
    warm = recorded(DEVICE, "warm.csv", zero_deg=20.0, temperature_c=60.0)
    other = recorded(DEVICE.with_effect("offset", x_percent=0.2), "other.csv", zero_deg=20.0)
    found = explain([warm, recorded(DEVICE, "plain.csv", zero_deg=20.0), other])
    assert found.to_dict()["columns_left_out"] == ["temperature_c"]
    said = " ".join(found.summary().split())
    assert "not used, as only some of the recordings have it: temperature_c" in said
    told = re.search(r"other.csv does not share .*[(]offset x ([\d.]+) instead of ([\d.]+) %", said)
    assert told
    # Its own 0.2 %, known to a hundredth by noise of 0.02 deg in 720 readings.
    assert abs(float(told[1]) - 0.2) < 0.02
    assert float(told[2]) > 0.3


def test_the_extended_twin_is_the_devices(tmp_path: Path) -> None:
    """A twin file of its own: no zero of a further recording, and it reads as the device does in the first one."""
    twin = lagging().extended
    assert not any("@" in key for key in twin.values)
    motion = Motion.from_angle(np.concatenate([THERE, THERE[::-1]]))
    device = DEVICE.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0).with_effect("zero", zero_deg=20.0)
    apart = np.degrees(np.angle(np.exp(1j * (twin.readings(motion) - device.readings(motion)))))
    assert np.sqrt(np.mean(apart**2)) < 0.01


def test_a_turned_sensor_parts_the_reference_from_the_sensor() -> None:
    """In one sweep of angles an eccentric reference is an offset; turned by a quarter, only the offset goes along."""
    device = DEVICE.with_effect("reference_eccentricity", amplitude_deg=0.3, phase_deg=40.0)
    upright = recorded(device, "upright.csv", zero_deg=20.0, mounting_deg=0.0)
    turned = recorded(device, "turned.csv", zero_deg=-70.0, mounting_deg=90.0)
    found = explain([upright, turned])
    (cause,) = found.causes
    # A stray field stays with the bench as the reference does.
    assert {cause.name, *cause.indistinguishable_from} == {"reference_eccentricity", "stray_field"}
    offset = found.to_dict()["extended"]["parameters"]["Vx_over_Ax"]
    assert offset["low"] <= 0.008 <= offset["high"]
    assert found.to_dict()["held_out_by"] == "blocks"
    # With no word of the sensor's turn the errors tell it: nothing else makes one device of both recordings.
    untold = explain([replace(upright, mounting_deg=None), replace(turned, mounting_deg=None)])
    assert [one.name for one in untold.causes] == [cause.name]
    setup = untold.to_dict()["recordings"][1]
    assert setup["turn_told"]
    assert setup["turn_stated_deg"] is None
    assert abs(setup["turned_deg"]) == pytest.approx(90.0, abs=1.0)
    said = " ".join(untold.summary().split())
    assert "the sensor is taken as turned, which nobody has stated" in said
    # An encoder that is turned on the shaft makes the same two recordings.
    assert "only if sensor and reference were turned against each other by that. Which of the two was turned" in said
    assert "Not visible in these recordings: " in said


def test_a_zero_that_has_moved_is_the_references_where_nothing_tells_otherwise() -> None:
    """The errors of a sensor alone are the same function of the angle however either of the two has been moved."""
    first = recorded(DEVICE, "first.csv", zero_deg=20.0)
    found = explain([first, recorded(DEVICE, "later.csv", zero_deg=-70.0)])
    setup = found.to_dict()["recordings"][1]
    assert not setup["turn_told"]
    assert abs(setup["reference_counted_on_deg"]) == pytest.approx(90.0, abs=1.0)
    assert "if the sensor was turned, state by how much (--mounting)" in " ".join(found.summary().split())


def test_a_stated_turn_that_the_zero_contradicts_is_said() -> None:
    first = recorded(DEVICE, "first.csv", zero_deg=20.0, mounting_deg=0.0)
    found = explain([first, recorded(DEVICE, "turned.csv", zero_deg=-25.0, mounting_deg=90.0)])
    said = " ".join(found.summary().split())
    assert "The turn stated of turned.csv does not agree with the zero found there." in said
    # Nothing was found, and nothing that the turn would have parted.
    assert found.verdict == "adequate"
    assert re.search(r"turn of 90 deg that is stated of turned.csv does not agree with its zero, by 45.0 deg", said)
    # The table shows it as it was stated, and not as the sensor's axes count.
    assert re.search(r"turned.csv 360 90 ", said)


def test_what_a_contradicted_turn_has_parted_is_partly_explained() -> None:
    device = DEVICE.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0)
    first = recorded(device, "first.csv", zero_deg=20.0, mounting_deg=0.0)
    found = explain([first, recorded(device, "turned.csv", zero_deg=-25.0, mounting_deg=90.0)])
    assert [cause.name for cause in found.causes] == ["hysteresis"]
    assert found.verdict == "partly explained"


@pytest.mark.parametrize("gap_mm", [3.0, 1.5])
def test_another_gap_that_nobody_has_stated_is_asked_for(gap_mm: float) -> None:
    """An offset in volts is the larger a share of the weaker field; beside it nothing has changed."""
    near = DEVICE.with_magnet(Assembly(placement=Placement(air_gap_mm=1.5)))
    sweeps = [recorded(near, "near.csv", zero_deg=20.0), recorded(at_air_gap(near, gap_mm), "far.csv", zero_deg=20.0)]
    start = joined(sweeps, CATALOGUE, mounting=None, given=None, rng=np.random.default_rng(1))
    assert start.sweep.recordings is not None
    ratio = start.sweep.recordings.setups[1].offset_ratio
    if gap_mm == 1.5:
        assert ratio is None
        return
    far = at_air_gap(near, gap_mm)
    # An offset of 0.94 % is known to 0.0026 %: 0.02 deg over the root of 180.
    sd = 3.0 * np.radians(0.02) * np.sqrt(2.0 / 360.0) / 0.0094
    expected = far.values["offset"]["x_percent"] / near.values["offset"]["x_percent"]
    assert ratio == pytest.approx(expected, rel=3.0 * sd)


def test_recordings_at_one_temperature_each_are_one_drift() -> None:
    """Neither has been on its way to another temperature, so that a lag behind it does nothing."""
    device = DEVICE.with_effect("offset_drift", x_percent_per_K=0.01, y_percent_per_K=0.006)
    device = device.with_effect("zero", zero_deg=20.0).with_effect("noise", rms_deg=0.02)
    turn = Protocol(turns=1, points=180, speeds_rpm=(60.0,))
    motions = [replace(turn, temperatures_c=(warm_c,)).motion() for warm_c in (25.0, 85.0)]
    sweeps = [device.simulate(motion, seed=seed) for seed, motion in enumerate(motions)]
    (cause,) = explain(sweeps).causes
    assert cause.name == "offset_drift"
    assert "lag_s" not in cause.parameters
    # 180 readings of 0.02 deg tell an offset to 0.0037 %, and two of them the drift over 60 K to 8.7e-5 %/K.
    assert cause.parameters["x_percent_per_K"].value == pytest.approx(0.01, abs=3.0 * 8.7e-5)


@pytest.mark.parametrize("percents", [(0.0, 1.0), (1.0, 0.0), (0.0, 0.02), (0.05, 0.8), (0.8, 0.05)])
@pytest.mark.parametrize("seed", range(4))
def test_an_offset_that_is_not_there_has_no_ratio(percents: tuple[float, float], seed: int) -> None:
    """Noise points any way, so also that of the other offset; one of 0.05 % is there, but no gap makes it 0.8 %."""
    devices = (DEVICE.with_effect("offset", x_percent=one, y_percent=0.6 * one) for one in percents)
    sweeps = [recorded(device, f"{seed}{k}.csv", zero_deg=20.0) for k, device in enumerate(devices)]
    start = joined(sweeps, CATALOGUE, mounting=None, given=None, rng=np.random.default_rng(1))
    assert start.sweep.recordings is not None
    assert start.sweep.recordings.setups[1].offset_ratio is None


@pytest.mark.parametrize(
    ("temperature_c", "alike"), [((25.0, 60.0), False), ((25.0, 27.0), True), ((25.0, None), True)]
)
def test_a_turn_is_told_of_recordings_that_are_alike_as_far_as_is_known(
    temperature_c: tuple[float | None, ...], alike: bool
) -> None:
    """An encoder's errors of 0.3 deg beside a sensor that was turned; a reading without a temperature says nothing."""
    device = DEVICE.with_effect("reference_eccentricity", amplitude_deg=0.3, phase_deg=40.0)
    sweeps = []
    for name, zero_deg, warm_c in zip(("a", "b"), (20.0, -70.0), temperature_c, strict=True):
        sweep = recorded(device, name, zero_deg=zero_deg)
        column = None if warm_c is None else np.where(np.arange(len(sweep)) == 7, np.nan, warm_c)
        sweeps.append(replace(sweep, temperature_c=column))
    start = joined(sweeps, CATALOGUE, mounting=None, given=None, rng=np.random.default_rng(1))
    assert start.sweep.recordings is not None
    assert start.sweep.recordings.setups[1].turn_told is alike


def test_recordings_of_two_devices_are_told() -> None:
    """Offsets a tenth of a percent apart: half of that is 0.02 deg RMS in each, as much as the noise."""
    other = DEVICE.with_effect("offset", x_percent=0.9)
    found = explain([recorded(DEVICE, "one.csv", zero_deg=5.0), recorded(other, "other.csv", zero_deg=5.0)])
    one, two = found.to_dict()["recordings"]
    assert set(one["differ"]) == set(two["differ"]) == {"Vx_over_Ax"}
    # Shared out by halves it is the root of two; the louder of the two gives way a little more.
    assert 1.2 < one["rms_ratio"] < 2.0
    assert one["differ"]["Vx_over_Ax"]["own"] == pytest.approx(0.008, abs=1e-4)
    assert "does not share one device's parameters" in " ".join(found.summary().split())


def test_what_cannot_belong_together_is_refused() -> None:
    sweep = recorded(DEVICE, "a.csv", zero_deg=0.0)
    gapped = recorded(DEVICE, "b.csv", zero_deg=1.0, air_gap_mm=2.0)
    with pytest.raises(UserError, match=r"a\.csv: no number in a column air_gap_mm"):
        explain([sweep, gapped])
    with pytest.raises(UserError, match="there is one sweep"):
        explain(sweep, mounting=Mounting(turned_deg=(90.0,)))
    with pytest.raises(UserError, match="list of no sweep"):
        explain([])


def test_commands_line_of_several(tmp_path: Path) -> None:
    for k in range(2):
        recorded(DEVICE, f"s{k}.csv", zero_deg=float(k)).write(tmp_path / f"s{k}.csv")
    one, two = tmp_path / "s0.csv", tmp_path / "s1.csv"
    together = halltwin("explain", tmp_path, "--json", tmp_path / "t.json", "--extended", tmp_path / "t.toml")
    assert "The recordings" in together.out
    assert "zero" in read_twin(tmp_path / "t.toml").values
    each = halltwin("explain", "--each", one, two, "--json", tmp_path / "e.json")
    assert each.out.count("Verdict:") == 2
    assert "--json alone" in halltwin("explain", "--each", one, two, "--plot", tmp_path / "e.png").err
    assert "the same readings" in halltwin("explain", one, one).err
    assert "found 3 angles of the sensor for 2 sweeps" in halltwin("explain", one, two, "--mounting", "0,9,8").err
    for options in (("--mounting", "10"), ("--each", "--mounting", "10")):
        assert "there is one sweep" in halltwin("explain", one, *options).err
    for several in ((one,), (one, two)):
        assert "mounting is ','" in halltwin("explain", *several, "--mounting", ",").err


def test_files_of_one_name_bear_as_much_of_their_paths_as_tells_them_apart(tmp_path: Path) -> None:
    paths = [tmp_path / folder / "s.csv" for folder in ("near", "far")]
    for k, path in enumerate(paths):
        path.parent.mkdir()
        recorded(DEVICE, f"s{k}.csv", zero_deg=float(k)).write(path)
    assert "near/s.csv, far/s.csv" in halltwin("explain", *paths).out
    assert [one["name"] for one in explain(paths).to_dict()["recordings"]] == ["near/s.csv", "far/s.csv"]
    assert "near/s.csv" in halltwin("diagnose", *paths).out


def test_what_happened_in_one_recording_is_named_with_it() -> None:
    """The reference slips once, in the second recording: no parameter of the device."""
    motion = Motion.from_angle(np.concatenate([THERE, THERE[::-1]]), time_s=np.arange(2.0 * THERE.size))
    sensor = DEVICE.with_effect("noise", rms_deg=0.02)
    slipped = sensor.with_effect("index_slip", step_deg=0.4, time_s=150.0)
    sweeps = [replace(one.simulate(motion, seed=k), name=f"{k}.csv") for k, one in enumerate([sensor, slipped])]
    found = explain(sweeps)
    assert [cause.name for cause in found.causes] == ["index_slip"]
    (entry,) = found.to_dict()["causes"]
    assert entry["in_recordings"] == ["1.csv"]
    assert entry["parameters"]["step_deg"]["value"] == pytest.approx(0.4, abs=0.02)
    assert "in 1.csv alone" in found.summary()


def test_what_belongs_to_a_recording_is_each_ones_own() -> None:
    """By the parameters' owners: what happens in time, and a phase that counts from the middle of a record."""
    sweeps = [recorded(DEVICE, f"{k}.csv", zero_deg=float(k)) for k in range(2)]
    start = joined(sweeps, CATALOGUE, mounting=None, given=None, rng=np.random.default_rng(1)).start
    own = {everywhere(effect.name) for effect in start.effects if acts_in(effect.name) is not None}
    assert {
        "zero",
        "zero_drift",
        "index_slip",
        "mains_pickup",
        "reference_ripple",
        "unnamed_tone",
        "unnamed_drift",
    } <= own
    common = {effect.name for effect in start.effects if acts_in(effect.name) is None}
    # Zeros of turns belong to their recording already; noise and single readings are no part of the mean.
    assert {"offset", "hysteresis", "latency", "offset_drift", "reference_rezero", "stale_frames"} <= common


def test_the_report_shows_them_side_by_side(tmp_path: Path) -> None:
    lagging().write_report(tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "The recordings side by side" in page
    assert "loud.csv" in page.split("The recordings side by side")[1]
    assert "Not visible in these recordings" in page
    assert "this sweep could not" not in page


def test_the_picture_has_a_row_for_each() -> None:
    figure = residual_figure(lagging().discovery)
    labels = [axis.get_ylabel() for axis in figure.axes]
    assert [label.split("\n")[0] for label in labels if label] == ["quiet.csv", "loud.csv"]
    left = [float(re.search(r"([\d.]+) deg RMS", axis.get_title())[1]) for axis in figure.axes[2::3]]  # type: ignore[index]
    # Each by itself, as the table has them.
    assert left == pytest.approx([0.02, 0.06], rel=0.1)


def test_no_title_of_the_picture_is_cut_at_its_edge() -> None:
    figure = residual_figure(lagging().discovery)
    with drawing():
        figure.canvas.draw()
        for axis in figure.axes:
            place = axis.title.get_window_extent()
            assert figure.bbox.x0 <= place.x0 < place.x1 <= figure.bbox.x1
            # Room for five digits more.
            assert place.width < 0.8 * figure.bbox.width / 3.0


def test_zeros_of_turns_are_their_recordings() -> None:
    """A reference that finds its zero anew in each turn: a recording held out has zeros that no other one tells."""
    shaft = np.radians(np.arange(0.0, 4.0 * 360.0, 5.0))
    motion = Motion.from_angle(shaft, turn=np.floor(shaft / (2.0 * np.pi)))
    sensor = DEVICE.with_effect("saturation", k_percent=1.0).with_effect("noise", rms_deg=0.02)
    device = sensor.with_effect("reference_rezero", spread_deg=0.3)
    found = explain([replace(device.simulate(motion, seed=k), name=f"{k}.csv") for k in range(2)])
    assert {cause.name for cause in found.causes} == {"saturation", "reference_rezero"}
    answer = found.to_dict()
    assert answer["held_out_by"] == "recordings"
    # Half of a turn's 72 readings tell its zero to a sixth of the noise.
    assert answer["extended"]["heldout_rms_deg"] < 0.03


@pytest.mark.parametrize("held", [True, False])
def test_an_automatic_gain_gauges_no_gap(held: bool) -> None:
    """A constant voltage is a larger share of a weaker field, whether or not the channels show how much weaker.

    2 and 3 mm before a cylinder of 6 mm x 2.5 mm; the offset is known to some thousandths of a percent by 360 readings.
    """
    device = DEVICE.with_magnet(Assembly(placement=Placement(air_gap_mm=2.0)))
    far = at_air_gap(device, 3.0)
    assert device.magnet is not None
    assert far.magnet is not None
    ratio = far.magnet.nominal_mT / device.magnet.nominal_mT
    sweeps = [
        recorded(replace(chain, magnet=None), f"{gap} mm.csv", zero_deg=5.0, channels=True, air_gap_mm=gap)
        for chain, gap in ((device, 2.0), (far, 3.0))
    ]
    assert sweeps[1].vx is not None
    assert sweeps[1].vy is not None
    if not held:
        sweeps[1] = replace(sweeps[1], vx=ratio * sweeps[1].vx, vy=ratio * sweeps[1].vy)
    answer = explain(sweeps).to_dict()
    assert [one["amplitude_held"] for one in answer["recordings"]] == [held, held]
    # The radius of so many readings tells the ratio to a thousandth.
    assert answer["recordings"][1]["field_ratio"] == pytest.approx(ratio, rel=2e-3)
    assert answer["causes"] == []
    assert answer["baseline"]["parameters"]["Vx_over_Ax"]["value"] == pytest.approx(0.008, abs=1e-4)


def test_a_twin_is_held_against_recordings_at_their_gaps() -> None:
    """Its offset in volts, 0.8 % at its own 1.5 mm, is a larger share at 3 mm and has not changed."""
    twin = DEVICE.with_magnet(Assembly(placement=Placement(air_gap_mm=1.5))).with_effect("noise", rms_deg=0.02)
    sweeps = [recorded(at_air_gap(twin, gap), f"{gap} mm.csv", zero_deg=5.0, air_gap_mm=gap) for gap in (3.0, 4.0)]
    answer = explain(sweeps, twin=twin).to_dict()
    assert answer["changed"] == []
    assert not answer["other_device"]
