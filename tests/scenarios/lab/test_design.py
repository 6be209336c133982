"""What the design view tells: the study's own figures, and what a wrong question is answered."""

from __future__ import annotations

import csv
import json
import shlex
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenarios.lab import session
from scenarios.lab.design import asked_of
from scenarios.lab.twins import named
from tests.command_line import halltwin
from tests.scenarios.lab.serving import Client, serving
from twin.files import from_dict
from twin.motion import Motion


@pytest.fixture(scope="module")
def begun(client: Client) -> dict[str, Any]:
    design: dict[str, Any] = client.ask("start").json["twin"]["design"]
    design["demand"]["mountings"] = 20
    return design


def changed(design: dict[str, Any], **values: Any) -> dict[str, Any]:
    """The design with values by their path, such as magnet__diameter_mm."""
    new = json.loads(json.dumps(design))
    for path, value in values.items():
        *folders, name = path.split("__")
        part = new
        for folder in folders:
            part = part[folder]
        part[name] = value
    return new


DESIGNS: dict[str, dict[str, Any]] = {
    "as the twin has it": {},
    "another magnet": {"magnet__diameter_mm": 7.35, "magnet__height_mm": 3.1, "magnet__grade": "SmCo5"},
    "a ring": {"magnet__shape": "ring", "magnet__bore_mm": 2.5, "placement__air_gap_mm": 1.25},
    "a block": {"magnet__shape": "block", "magnet__length_mm": 5.0, "magnet__width_mm": 5.0},
    "badly mounted": {
        "placement__sensor_x_mm": -0.45,
        "placement__sensor_tilt_y_deg": 3.5,
        "placement__magnet_x_mm": 0.3,
    },
    "in a stray field": {"placement__stray_x_mT": 0.75, "magnet__remanence_T": 1.1},
    "other demands": {"demand__tolerance": {"air_gap": 0.2, "magnet_tilt": 0.5}, "demand__window_mT": [40, 70]},
}


@pytest.mark.parametrize("name", DESIGNS)
def test_the_figures_are_those_of_the_command_line_it_shows(
    name: str, client: Client, begun: dict[str, Any], tmp_path: Path
) -> None:
    """Byte for byte: the row of designs.csv, and the record of best.json."""
    design = changed(begun, **DESIGNS[name])
    command = client.ask("design/at-once", design).json["command"]
    ended = halltwin(*shlex.split(command)[1:], "-o", tmp_path / "study", "--no-plot", "--workers", "1")
    assert ended.code == 0, ended.err
    told = client.ask("design/study", design).json["figures"]
    (best,) = json.loads((tmp_path / "study/best.json").read_text())["best"]
    assert json.dumps(told) == json.dumps({key: best[key] for key in told})
    (row,) = csv.DictReader((tmp_path / "study/designs.csv").read_text().splitlines())
    assert {key: f"{value:.6g}" for key, value in told.items()} == {key: row[key] for key in told}


def test_a_mounting_that_the_command_cannot_say_has_no_command(client: Client, begun: dict[str, Any]) -> None:
    told = client.ask("design/at-once", changed(begun, placement__sensor_y_mm=0.2)).json
    assert told["command"] is None


def test_what_follows_the_pointer_is_the_chains_own_error(client: Client, begun: dict[str, Any]) -> None:
    """At the twin's own magnet nothing is scaled: the chain itself says the same, and so do its figures."""
    told = client.ask("design/at-once", begun).json
    chain = named("imc-14bit").chain
    angle = np.radians(np.arange(360.0))
    both = np.concatenate([angle, angle[::-1]])
    motion = Motion.from_angle(both, direction=np.repeat([1.0, -1.0], 360))
    error = np.degrees(chain.error(motion))
    error -= error.mean()
    for way, expected in (("forward_deg", error[:360]), ("backward_deg", error[:359:-1])):
        apart = np.abs(np.subtract(told[way], expected))
        # A reading at the edge of a step of the 14-bit output falls to either side by rounding.
        assert np.max(apart) < 1.01 * 360.0 / 2**14
        assert np.mean(apart < 2e-4) > 0.95
    assert told["figures"]["error_deg"] == pytest.approx(np.max(np.abs(error)), abs=2e-4)
    assert told["figures"]["rms_deg"] == pytest.approx(np.sqrt(np.mean(error**2)), abs=2e-4)
    # At order 0 half of the step between the directions, the other orders as a transform of both has them.
    half = 0.5 * (error[:360] - error[:359:-1])
    assert told["orders"]["amplitude_deg"][0] == pytest.approx(abs(half.mean()), rel=0.02)
    mean = 0.5 * (error[:360] + error[:359:-1])
    second = 2.0 * abs(np.fft.rfft(mean)[2]) / 360.0
    assert told["orders"]["amplitude_deg"][2] == pytest.approx(second, rel=0.05)


def test_the_channels_are_those_of_the_temperature_looked_at(client: Client, begun: dict[str, Any]) -> None:
    """Of the turn at 25 C, which sets the zero, nothing is shown: a warm magnet's channels are smaller."""
    cold, warm = (
        client.ask("design/at-once", changed(begun, temperature_c=at)).json["signals"]["x"] for at in (25.0, 125.0)
    )
    assert len(cold) == len(warm) == 360
    assert max(warm) < 0.95 * max(cold)


def test_one_design_is_computed_at_a_time(
    client: Client, begun: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two questions of the same drag that shared the time would both be late."""
    inside, most = [0], [0]

    def counted(*_: object) -> dict[str, Any]:
        inside[0] += 1
        most[0] = max(most[0], inside[0])
        time.sleep(0.05)
        inside[0] -= 1
        return {}

    monkeypatch.setattr(session, "at_once", counted)
    with ThreadPoolExecutor(3) as pool:
        told = list(pool.map(lambda _: client.ask("design/at-once", begun).status, range(3)))
    assert told == [200] * 3
    assert most == [1]


def test_an_offset_in_volts_counts_more_in_a_weaker_field(client: Client, begun: dict[str, Any]) -> None:
    """What order 1 gains by the field's fall is what the offset does: all else of that order is far smaller here."""
    near, far = (client.ask("design/at-once", changed(begun, placement__air_gap_mm=gap)).json for gap in (2.5, 4.5))
    weaker = near["figures"]["field_mT"] / far["figures"]["field_mT"]
    assert weaker > 2.0
    # 0.1 % of offset in each channel, and what the plates leave.
    first = [told["orders"]["amplitude_deg"][1] for told in (near, far)]
    assert first[1] / first[0] == pytest.approx(weaker, rel=0.15)


def test_temperature_and_speed_are_followed(client: Client, begun: dict[str, Any]) -> None:
    at_rest = client.ask("design/at-once", begun).json
    warm = client.ask("design/at-once", changed(begun, temperature_c=125.0)).json
    assert warm["figures"]["field_low_mT"] / at_rest["figures"]["field_low_mT"] == pytest.approx(
        (1 - 0.0012 * 105) / (1 - 0.0012 * 5), rel=1e-6
    )
    fast = client.ask("design/at-once", changed(begun, speed_rpm=6000.0)).json
    # 100 us of latency and the reading's own skew, at 36 deg/ms.
    step = np.subtract(fast["forward_deg"], fast["backward_deg"]).mean()
    assert step == pytest.approx(-2 * 3.6, rel=0.1)
    assert client.ask("design/causes", changed(begun, speed_rpm=6000.0)).json["alone_deg"]["latency"] == pytest.approx(
        3.6, rel=0.01
    )
    assert client.ask("design/causes", begun).json["alone_deg"]["latency"] == 0.0


def test_a_cause_that_is_taken_out_takes_its_part_with_it(client: Client) -> None:
    with_field = named("hall-misaligned").begins().to_dict()
    client.ask("twin/preset", {"name": "hall-misaligned"})
    told = client.ask("design/study", with_field).json
    client.ask("twin/preset", {"name": "imc-14bit"})
    # Nearly all of that twin's error is the magnet's and the sensor's place.
    assert told["all_deg"] == told["figures"]["error_deg"]
    assert told["without_deg"]["field"] < 0.1 * told["all_deg"]
    assert told["without_deg"]["output_quantisation"] == pytest.approx(told["all_deg"], rel=0.01)


def test_the_map_holds_the_design_itself(client: Client, begun: dict[str, Any]) -> None:
    """At its own size and gap a map's cell holds what the design's figures are."""
    told = client.ask("design/map", begun).json
    row, column = 5, 7
    there = changed(begun, magnet__diameter_mm=told["size_mm"][column], placement__air_gap_mm=told["air_gap_mm"][row])
    figures = client.ask("design/study", there).json["figures"]
    assert told["error_deg"][row][column] == pytest.approx(figures["error_deg"], rel=1e-3)
    assert told["field_low_mT"][row][column] == pytest.approx(figures["field_low_mT"], rel=1e-3)
    assert told["field_high_mT"][row][column] == pytest.approx(figures["field_high_mT"], rel=1e-3)


def test_a_saved_twin_is_the_design(client: Client, begun: dict[str, Any], tmp_path: Path) -> None:
    """Opened again it is the same design, and the command line reads it."""
    design = changed(begun, magnet__diameter_mm=8.0, placement__sensor_y_mm=0.3, placement__air_gap_mm=3.0)
    got = client.ask("twin/save", design)
    assert got.headers["Content-Disposition"] == 'attachment; filename="twin.toml"'
    told = client.ask("twin/open", body=got.content, X_File_Name="mine.toml").json
    client.ask("twin/preset", {"name": "imc-14bit"})
    assert told["name"] == "mine.toml"
    for part in ("magnet", "placement"):
        assert told["design"][part] == design[part]
    chain = from_dict(tomllib.loads(got.content.decode()))
    # An offset in volts is a larger share of a weaker field.
    near = named("imc-14bit").chain
    assert chain.magnet is not None
    assert near.magnet is not None
    weaker = near.magnet.nominal_mT / chain.magnet.nominal_mT
    assert chain.values["offset"]["x_percent"] == pytest.approx(0.1 * weaker)
    (tmp_path / "mine.toml").write_bytes(got.content)
    ended = halltwin("simulate", tmp_path / "mine.toml", "--points", "36", "-o", tmp_path / "s.csv")
    assert ended.code == 0, ended.err


@pytest.mark.parametrize(
    "held", [{"temperature_c": 25.0, "speed_rpm": 0.0}, {"temperature_c": -20.5, "speed_rpm": 1500.0}]
)
def test_a_saved_sweep_is_the_commands_byte_for_byte(
    held: dict[str, float], client: Client, begun: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the twin as it is saved, by the command that the page shows."""
    monkeypatch.chdir(tmp_path)
    design = changed(begun, magnet__diameter_mm=8.0) | held
    Path("twin.toml").write_bytes(client.ask("twin/save", design).content)
    got = client.ask("sweep/save", design)
    assert got.headers["Content-Disposition"] == 'attachment; filename="sweep.csv"'
    _, *words = shlex.split(client.ask("design/at-once", design).json["sweep_command"])
    ended = halltwin(*words)
    assert ended.code == 0, ended.err
    assert got.content == Path("sweep.csv").read_bytes()
    # It is a recording of that design.
    other = changed(begun, magnet__diameter_mm=9.0) | held
    assert client.ask("sweep/save", other).content != got.content


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"magnet__diameter_mm": 0.0}, "diameter_mm is 0 mm"),
        ({"magnet__diameter_mm": "6"}, "diameter_mm is '6'"),
        ({"magnet__shape": "sphere"}, "shape is 'sphere'"),
        ({"magnet__colour": 1.0}, "magnet has no 'colour'"),
        ({"placement__air_gap_mm": -1.0}, "air_gap_mm is -1 mm"),
        ({"temperature_c": 1e4}, "temperature_c is 10000 C"),
        ({"temperature_c": None}, "temperature_c is None"),
        ({"speed_rpm": True}, "speed_rpm is True"),
        ({"demand__window_mT": [90, 30]}, "window_mT is 90 to 30 mT"),
        ({"demand__mountings": 1e9}, "mountings is 1e+09"),
        ({"demand__tolerance": {"luck": 1.0}}, "tolerance is"),
        ({"more": 1.0}, "a design is"),
    ],
)
@pytest.mark.parametrize("path", ["design/at-once", "design/study", "design/map", "twin/save", "sweep/save"])
def test_a_design_that_cannot_be_is_one_line(
    path: str, changes: dict[str, Any], said: str, client: Client, begun: dict[str, Any]
) -> None:
    got = client.ask(path, changed(begun, **changes))
    assert got.status == 400
    assert said in got.error


def test_what_the_page_holds_comes_back_as_it_went() -> None:
    asked = named("hall-misaligned").begins()
    again = asked_of(json.loads(json.dumps(asked.to_dict())))
    assert again.to_dict() == asked.to_dict()


def test_a_twin_without_a_magnet_says_why_it_shows_no_design(client: Client, tmp_path: Path) -> None:
    with serving(tmp_path, "paper-encoder") as one:
        told = one.ask("start").json["twin"]
        assert told["design"] is None
        assert "no [magnet]" in told["no_design"]
        got = one.ask("design/map", client.ask("start").json["twin"]["design"])
        assert got.status == 400
        assert "no [magnet]" in got.error
