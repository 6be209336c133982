"""Many devices by one command: the same answer however it is run, and one bad file ends nothing."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenarios.studies.fleet.job import ANSWERS
from scenarios.studies.fleet.order import in_order
from tests.command_line import halltwin
from tests.hidden.fleets.generator import Plan, write
from tests.scenarios.study_jobs import content

COUNT = 40
PLAN = Plan(count=COUNT, cause="hysteresis", strength_deg=0.006, points=180, odd={4: ("drive_ripple", 0.1)})


@pytest.fixture(scope="module")
def devices(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Forty devices, one of them odd; a file that is no sweep, and one that holds the readings of another."""
    folder = tmp_path_factory.mktemp("batch") / "devices"
    write(PLAN, folder, seed=3)
    (folder / "device_41.csv").write_text("rubbish\n1,2\n")
    shutil.copy(folder / "device_2.csv", folder / "device_42.csv")
    return folder


@pytest.fixture(scope="module")
def asked(devices: Path) -> Path:
    """The folder of the study, with the answer as JSON and page beside it."""
    place = devices.parent
    ended = halltwin("fleet", devices, "-o", place / "study", "--json", place / "answer.json", "--workers", "2")
    assert ended.code == 1
    assert "2 of 42 files could not be used: device_41.csv, device_42.csv" in ended.err
    (place / "said.txt").write_text(ended.out)
    return place


def answer_in(place: Path) -> dict[str, Any]:
    return dict(json.loads((place / "answer.json").read_text(encoding="utf-8")))


def test_the_answer_says_what_the_batch_holds(asked: Path) -> None:
    answer = answer_in(asked)
    assert answer["schema"] == "halltwin.fleet/1"
    assert (answer["devices"]["files"], answer["devices"]["used"]) == (42, COUNT)
    assert [one["name"] for one in answer["causes"]] in (["hysteresis"], ["backlash"])
    assert answer["causes"][0]["size"] == pytest.approx(0.006, rel=0.3)
    (apart,) = answer["apart"]
    assert (apart["file"], apart["place"]) == ("device_5.csv", 5)
    assert apart["figures"][0] == "drive_ripple"
    # The larger residual is told too, behind what makes it.
    assert apart["figures"][-1] == "residual RMS"
    assert "drive_ripple" in [cause["name"] for cause in apart["explained"]["causes"]]
    whole = json.loads((asked / "study" / apart["explained"]["answer"]).read_text(encoding="utf-8"))
    assert whole["verdict"] == apart["explained"]["verdict"]
    left = {one["name"]: one["rms_deg"] for one in answer["corrections"]}
    assert left["own factors and causes"] < left["common factors"] < left["none"]


def test_a_person_reads_the_same(asked: Path) -> None:
    said = (asked / "said.txt").read_text()
    for words in ("40 devices", "hysteresis", "device_5.csv", "Nothing changes", "not used: device_41.csv"):
        assert words in said


def test_files_that_cannot_be_used_are_listed_with_the_reason(asked: Path) -> None:
    unusable = {one["file"]: one["reason"] for one in answer_in(asked)["devices"]["unusable"]}
    assert list(unusable) == ["device_41.csv", "device_42.csv"]
    assert "reference_deg is missing" in unusable["device_41.csv"]
    assert unusable["device_42.csv"] == "holds the same readings as device_2.csv; each device counts once"


def test_any_number_of_workers_gives_the_same_bytes(devices: Path, asked: Path, tmp_path: Path) -> None:
    halltwin("fleet", devices, "-o", tmp_path / "one", "--json", tmp_path / "one.json", "--workers", "1")
    assert (tmp_path / "one.json").read_bytes() == (asked / "answer.json").read_bytes()
    assert content(tmp_path / "one") == content(asked / "study")


def test_a_cluster_gives_the_same_bytes(devices: Path, asked: Path, tmp_path: Path) -> None:
    pytest.importorskip("distributed", reason="needs the extra 'sweeps'")
    halltwin("fleet", devices, "-o", tmp_path / "s", "--json", tmp_path / "a.json", "--scheduler", "local")
    assert (tmp_path / "a.json").read_bytes() == (asked / "answer.json").read_bytes()


def test_what_was_stopped_is_gone_on_with(devices: Path, asked: Path, tmp_path: Path) -> None:
    """Of a study some chunks of either look and the explanation are lost: these alone are computed anew."""
    shutil.copytree(asked / "study", tmp_path / "s")
    marks = sorted((tmp_path / "s" / "done").iterdir())
    kept = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "s" / "chunks").iterdir()}
    lost = [marks[0], marks[len(marks) // 2], marks[-1]]
    for mark in lost:
        mark.unlink()
    shutil.rmtree(tmp_path / "s" / ANSWERS)
    halltwin("fleet", devices, "-o", tmp_path / "s", "--json", tmp_path / "a.json")
    assert (tmp_path / "a.json").read_bytes() == (asked / "answer.json").read_bytes()
    assert content(tmp_path / "s") == content(asked / "study")
    again = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "s" / "chunks").iterdir()}
    assert {name for name in kept if again[name] != kept[name]} == {f"{mark.name}.npz" for mark in lost[:2]}


def test_other_devices_are_another_study(devices: Path, asked: Path, tmp_path: Path) -> None:
    shutil.copytree(devices, tmp_path / "devices")
    path = tmp_path / "devices" / "device_1.csv"
    *lines, last = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([*lines, f"{last}1"]) + "\n", encoding="utf-8")
    ended = halltwin("fleet", tmp_path / "devices", "-o", asked / "study")
    assert ended.code == 2
    assert "was begun with the files' content" in ended.err


def test_the_page_holds_every_device_and_needs_nothing_else(devices: Path, asked: Path, tmp_path: Path) -> None:
    halltwin("fleet", devices, "-o", asked / "study", "--report", tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.S)
    assert found
    data = json.loads(found[1])
    assert len(data["names"]) == 42
    assert all(len(one["values"]) == 42 for one in data["figures"])
    assert data["apart"] == {"4": answer_figures(asked)}
    assert "hysteresis" in " ".join(one["name"] for one in data["figures"])
    assert not re.search(r"https?://|src=|@import", page)
    # Ten figures of a device in a page of at most two megabytes for ten thousand devices.
    assert len(found[1]) < 200 * 42


def answer_figures(asked: Path) -> str:
    return ", ".join(answer_in(asked)["apart"][0]["figures"])


def test_the_table_holds_every_device(devices: Path, asked: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="needs the extra 'formats'")
    halltwin("fleet", devices, "-o", asked / "study", "--table", tmp_path / "t.parquet")
    table = parquet.read_table(tmp_path / "t.parquet").to_pydict()
    assert table["number"] == list(range(1, 43))
    assert table["file"][9] == "device_10.csv"
    assert table["apart"] == [number == 5 for number in table["number"]]
    assert "drive_ripple" in table["causes"][4]
    offsets = np.array(table["offset.x_percent"])
    assert np.isnan(offsets[40:]).all()
    wanted = next(one for one in answer_in(asked)["factors"] if one["label"] == "offset x")
    assert np.median(offsets[:COUNT]) == pytest.approx(wanted["mean"], abs=0.5 * wanted["spread"])


def test_numbers_in_names_are_the_order(tmp_path: Path) -> None:
    names = ["a_10.csv", "a_9.csv", "a_1.csv", "b.csv", "a_01.csv"]
    paths = [tmp_path / name for name in names]
    assert [path.name for path in in_order(paths, "name")] == ["a_01.csv", "a_1.csv", "a_9.csv", "a_10.csv", "b.csv"]
    assert in_order(paths, "given") == paths


def test_a_column_is_the_order(tmp_path: Path) -> None:
    write(Plan(count=6, points=60), tmp_path / "d", seed=4)
    for place, path in enumerate(sorted((tmp_path / "d").iterdir())):
        head, *rows = path.read_text(encoding="utf-8").splitlines()
        stamped = [f"{row},{1000 - 100 * place + k}" for k, row in enumerate(rows)]
        path.write_text("\n".join([f"{head},time_s", *stamped]) + "\n", encoding="utf-8")
    halltwin(
        *("fleet", tmp_path / "d", "-o", tmp_path / "s", "--order", "time_s", "--explain", "none"),
        *("--report", tmp_path / "p.html"),
    )
    found = re.search(r'id="data">(.*?)</script>', (tmp_path / "p.html").read_text(encoding="utf-8"), re.S)
    assert found
    assert json.loads(found[1])["names"] == [f"device_{number}.csv" for number in (6, 5, 4, 3, 2, 1)]


def test_fail_on_is_about_what_was_found(devices: Path, asked: Path) -> None:
    ended = halltwin("fleet", devices, "-o", asked / "study", "--fail-on", "apart")
    assert ended.code == 1
    assert "found apart (1 device, device_5.csv the farthest)" in ended.err
    assert halltwin("fleet", devices, "-o", asked / "study", "--fail-on", "wobbly").code == 2


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--order", "size"), "--order size: expected name (numbers in the files' names), given"),
        (("--explain", "some"), "--explain some: expected apart, all or none"),
        (("--output-sense", "2"), "--output-sense is 2; expected 1 or -1"),
        (("--json", "answer.txt"), "answers end in .json"),
        (("--table", "t.csv"), "such tables end in .parquet"),
        (("--workers", "0"), "workers is 0; expected at least 1"),
    ],
)
def test_what_is_wrong_is_a_line(options: tuple[str, ...], said: str, devices: Path, tmp_path: Path) -> None:
    ended = halltwin("fleet", devices, "-o", tmp_path / "s", *options)
    assert ended.code == 2
    assert said in ended.err
    assert ended.err.count("\n") == 1
    assert not (tmp_path / "s").exists()


def test_too_few_files_are_a_line(devices: Path, tmp_path: Path) -> None:
    one = halltwin("fleet", devices / "device_1.csv", "-o", tmp_path / "s")
    assert one.code == 2
    assert "found 1 file; expected 2 to 200,000, one for each device" in one.err
    none = halltwin("fleet", tmp_path, "-o", tmp_path / "s")
    assert none.code == 2
    assert "no sweep in this folder" in none.err
    (tmp_path / "a.csv").write_text("x\n1\n")
    (tmp_path / "b.csv").write_text("x\n1\n")
    bad = halltwin("fleet", tmp_path, "-o", tmp_path / "s")
    assert bad.code == 2
    assert "and none of the other 1 files can be used" in bad.err
    assert not (tmp_path / "s").exists()


def test_nothing_of_anybodys_is_replaced(devices: Path, asked: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.json").write_text("{}", encoding="utf-8")
    ended = halltwin("fleet", devices, "-o", asked / "study", "--json", tmp_path / "mine.json")
    assert ended.code == 2
    assert "was not written by halltwin" in ended.err
    own = tmp_path / "own.json"
    for _ in range(2):
        assert halltwin("fleet", devices, "-o", asked / "study", "--json", own).code == 1
    assert (tmp_path / "mine.json").read_text(encoding="utf-8") == "{}"
