"""Input that is odd but usable: exit code 0, an honest answer, and nothing that is no JSON in it."""

from __future__ import annotations

import gzip
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.chain import Chain
from twin.errors import SweepError
from twin.motion import Motion
from twin.sweep import Sweep
from twin.sweep_text import parse_csv

from .command_line import Array, csv_text, explained, sweep_angles

TWO_TURNS = np.arange(0.0, 720.0, 2.5)
READ = sweep_angles(TWO_TURNS)
TABLE = {"reference_deg": TWO_TURNS % 360.0, "measured_deg": READ}
PLAIN = csv_text(TABLE)
TIME = 0.4 * np.arange(TWO_TURNS.size)


def columns(**given: Array) -> str:
    """The plain sweep with columns replaced or added."""
    return csv_text({**TABLE, **given})


def with_comments() -> str:
    lines = PLAIN.splitlines()
    for place, line in ((200, "   # again, with, commas"), (100, "# pause"), (50, ""), (0, "# bench 3, 20 °C")):
        lines.insert(place, line)
    return "\n".join([*lines, ""])


def with_notes() -> str:
    header, *rows = PLAIN.splitlines()
    return "\n".join([f"note,{header},note", *(f"good,{row}," for row in rows), ""])


def quoted() -> str:
    return "\n".join(['"' + line.replace(",", '","') + '"' for line in PLAIN.splitlines()])


SAME_SWEEP: dict[str, bytes] = {
    "byte order mark": b"\xef\xbb\xbf" + PLAIN.encode(),
    "UTF-16": PLAIN.encode("utf-16"),
    "line ends of Windows": PLAIN.replace("\n", "\r\n").encode(),
    "line ends of old": PLAIN.replace("\n", "\r").encode(),
    "no line end at the end": PLAIN.rstrip("\n").encode(),
    "comments in the middle": with_comments().encode(),
    "comments in Latin-1": with_comments().encode("latin-1"),
    "tabs": PLAIN.replace(",", "\t").encode(),
    "tabs and decimal commas": PLAIN.replace(",", "\t").replace(".", ",").encode(),
    "semicolons": PLAIN.replace(",", ";").encode(),
    "semicolons and decimal commas": PLAIN.replace(",", ";").replace(".", ",").encode(),
    "quotes": quoted().encode(),
    "quoted header": PLAIN.replace("reference_deg,measured_deg", '"reference_deg", "measured_deg"').encode(),
    "blanks round the cells": PLAIN.replace(",", " , ").encode(),
    "unknown columns twice": with_notes().encode(),
    "gzip": gzip.compress(PLAIN.encode()),
    "empty columns": columns(temperature_c=np.nan * TIME, vx=np.nan * TIME, vy=np.nan * TIME).encode(),
}
"""The plain sweep in other clothes."""

SAME_READINGS: dict[str, dict[str, Array]] = {
    "reference unwrapped": {"reference_deg": TWO_TURNS},
    "reference after many turns": {"reference_deg": TWO_TURNS + 360.0 * 50_000},
    "reference signed": {"reference_deg": (TWO_TURNS + 180.0) % 360.0 - 180.0},
    "sensor unwrapped": {"measured_deg": np.unwrap(READ, period=360.0)},
    "sensor signed": {"measured_deg": (READ + 180.0) % 360.0 - 180.0},
    "another zero": {"reference_deg": (TWO_TURNS + 123.0) % 360.0},
    "sensor the other way round": {"measured_deg": -READ % 360.0},
    "time backwards": {"time_s": TIME[::-1]},
    "fast time backwards": {"time_s": 0.01 * TIME[::-1]},
    "time jumps back": {"time_s": 0.01 * TIME - 2.0 * (TIME > 60.0)},
    "time stands still": {"time_s": 0.0 * TIME},
    "time of the day in s": {"time_s": 1.75e9 + TIME},
    "speed of zero": {"time_s": TIME, "speed_rpm": 0.0 * TIME},
    "one turn for all": {"turn": 0.0 * TIME + 5.0},
    "temperature with gaps": {"temperature_c": np.where(np.arange(TIME.size) % 3 == 0, np.nan, 24.0)},
}
"""The same readings, told differently: the answer may not depend on it."""


def figures(value: Any) -> list[Any]:
    """All plain values in an answer."""
    if isinstance(value, dict):
        return [item for inner in value.values() for item in figures(inner)]
    if isinstance(value, list):
        return [item for inner in value for item in figures(inner)]
    return [value]


def ask(tmp_path: Path, content: str | bytes, *options: str | Path) -> dict[str, Any]:
    """The answer to a file's content, held against what every answer must be."""
    path = tmp_path / "sweep.csv"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    answer = explained(path, *options)
    assert all(np.isfinite(value) for value in figures(answer) if isinstance(value, float | int))
    assert answer["sweep"]["rows"] == answer["sweep"]["used"] + answer["sweep"]["rejected"]
    # The command names the folder, and with it the mark is another.
    del answer["command"], answer["written_by"]
    return answer


def names(answer: dict[str, Any]) -> list[str]:
    return [cause["name"] for cause in answer["causes"]]


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    answer = ask(tmp_path_factory.mktemp("plain"), PLAIN)
    assert names(answer) == ["saturation"]
    return answer


@pytest.mark.parametrize("case", SAME_SWEEP)
def test_format_does_not_matter(case: str, tmp_path: Path) -> None:
    """What is read is the same sweep, bit for bit; all else follows from it."""
    read = []
    for folder, content in (("plain", PLAIN.encode()), ("odd", SAME_SWEEP[case])):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "sweep.csv").write_bytes(content)
        read.append(Sweep.read(tmp_path / folder / "sweep.csv"))
    plain, odd = ({one.name: getattr(sweep, one.name) for one in fields(Sweep)} for sweep in read)
    np.testing.assert_equal(odd, plain)


@pytest.mark.parametrize("case", ["gzip", "unknown columns twice", "empty columns"])
def test_nor_does_it_for_the_answer(case: str, tmp_path: Path, plain: dict[str, Any]) -> None:
    assert ask(tmp_path, SAME_SWEEP[case]) == plain


@pytest.mark.parametrize("name", ["sweep.csv.gz", "sweep.parquet", "sweep"])
def test_the_content_says_what_a_file_is(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(PLAIN, encoding="utf-8")
    assert np.array_equal(Sweep.read(tmp_path / name).reference_deg, TABLE["reference_deg"])


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_lines_are_whole_wherever_a_block_ends(line_end: str, encoding: str) -> None:
    """Of blocks of every size the columns and the lines' numbers are those of the whole."""
    content = csv_text({name: values[:12] for name, values in TABLE.items()}, line_end=line_end).encode(encoding)
    for size in (1, 2, 3, 7, 64, len(content)):
        blocks = [content[k : k + size] for k in range(0, len(content), size)]
        found = parse_csv(blocks, name="sweep.csv")
        assert np.allclose(found["reference_deg"], TABLE["reference_deg"][:12])
        broken = [content.replace("7.5".encode(encoding)[-6:], "x.5".encode(encoding)[-6:])]
        with pytest.raises(SweepError, match="line 5, column reference_deg: 'x"):
            parse_csv([broken[0][k : k + size] for k in range(0, len(broken[0]), size)], name="sweep.csv")


@pytest.mark.parametrize("case", SAME_READINGS)
def test_same_readings_same_answer(case: str, tmp_path: Path, plain: dict[str, Any]) -> None:
    answer = ask(tmp_path, columns(**SAME_READINGS[case]))
    assert names(answer) == names(plain)
    assert answer["extended"]["rms_deg"] == pytest.approx(plain["extended"]["rms_deg"], rel=0.02)


def test_missing_and_infinite_cells_are_rejected_and_counted(tmp_path: Path, plain: dict[str, Any]) -> None:
    lines = PLAIN.splitlines()
    lines[5] = lines[5].split(",")[0] + ","
    lines[50] = lines[50].split(",")[0] + ",inf"
    lines[77] = "nan," + lines[77].split(",")[1]
    lines[90] = "12.5,1e400"
    answer = ask(tmp_path, "\n".join(lines))
    assert answer["sweep"]["rejected"] == 4
    assert sorted(map(int, answer["sweep"]["rejected_rows"])) == [5, 50, 77, 90]
    assert names(answer) == names(plain)


def test_rejected_rows_alone_leave_adequate(tmp_path: Path) -> None:
    angle = np.radians(TWO_TURNS)
    measured = TWO_TURNS + 0.3 * np.sin(angle) + 0.02 * np.random.default_rng(8).standard_normal(angle.size)
    measured[::20] = np.nan
    answer = ask(tmp_path, columns(measured_deg=measured))
    assert answer["sweep"]["rejected"] == 15
    assert answer["verdict"] == "adequate"


@pytest.mark.parametrize("rows", [17, 19, 91])
@pytest.mark.parametrize("span_deg", [90.0, 315.0])
def test_few_rows_and_a_quarter_turn_name_nothing(rows: int, span_deg: float, tmp_path: Path) -> None:
    """Too little to part causes: nothing is claimed, least of all from as many parameters as readings."""
    reference = np.linspace(0.0, span_deg, rows)
    measured = reference + 33.0 + 0.02 * np.random.default_rng(rows).standard_normal(rows)
    answer = ask(tmp_path, csv_text({"reference_deg": reference, "measured_deg": measured}))
    assert answer["verdict"] == "adequate"
    assert answer["causes"] == []
    for parameter in answer["baseline"]["parameters"].values():
        assert parameter["low"] is None or parameter["low"] <= parameter["value"] <= parameter["high"]


@pytest.mark.parametrize(
    "seed",
    [
        17,
        18,
        19,
        20,
        21,
    ],
)
def test_ten_readings_at_each_of_17_angles(seed: int, tmp_path: Path) -> None:
    """Angles count, not readings, so that no cause is named; but ten readings know that more than noise is left.

    Each angle is off by ten times what its readings scatter by: beside that every one of them is a lack of fit.
    """
    rng = np.random.default_rng(seed)
    angles = np.repeat(np.linspace(-180.0, 180.0, 17), 10)
    placing = np.repeat(0.05 * rng.standard_normal(17), 10)
    measured = (angles + placing + 0.005 * rng.standard_normal(170)) % 360.0
    answer = ask(tmp_path, csv_text({"reference_deg": angles, "measured_deg": measured}))
    assert answer["causes"] == []
    assert answer["verdict"] == "unnamed"
    assert answer["noise_floor_deg"] == pytest.approx(0.005, rel=0.3)


@pytest.mark.parametrize("times", [1, 3])
def test_noiseless_perfect_sensor(times: int, tmp_path: Path) -> None:
    """Nothing is wrong, to the last digit of the file."""
    reference = np.tile(np.arange(0.0, 360.0, 2.5), times)
    answer = ask(tmp_path, csv_text({"reference_deg": reference, "measured_deg": (reference + 33.0) % 360.0}))
    assert answer["verdict"] == "adequate"


def noiseless(effects: dict[str, dict[str, float]]) -> Sweep:
    """Two turns of a twin without noise, as exact as numbers are."""
    chain = Chain()
    for name, params in effects.items():
        chain = chain.with_effect(name, **params)
    return chain.simulate(Motion.from_angle(np.radians(TWO_TURNS)))


BASELINE = {
    "offset": {"x_percent": 0.5, "y_percent": -0.4},
    "gain_mismatch": {"ratio": 1.01},
    "phase": {"beta_deg": 0.3},
    "quadratic_nonlinearity": {"q_percent": 0.2},
}


def test_noiseless_baseline_is_adequate(tmp_path: Path) -> None:
    sweep = noiseless(BASELINE)
    sweep.write(tmp_path / "exact.csv")
    answer = explained(tmp_path / "exact.csv")
    assert answer["verdict"] == "adequate"
    found = {name: entry["value"] for name, entry in answer["baseline"]["parameters"].items()}
    assert found["Vx_over_Ax"] == pytest.approx(0.005, abs=1e-6)
    assert found["gain_ratio"] == pytest.approx(1.01, abs=1e-6)
    assert found["beta_deg"] == pytest.approx(0.3, abs=1e-4)


@pytest.mark.parametrize(
    "k_percent",
    [
        0.3,
        0.8,
        1.3,
    ],
)
def test_noiseless_saturation_is_named(k_percent: float, tmp_path: Path) -> None:
    """And nothing else: what the file's last digit adds is no cause."""
    sweep = noiseless({**BASELINE, "saturation": {"k_percent": k_percent}})
    sweep.write(tmp_path / "exact.csv")
    answer = explained(tmp_path / "exact.csv")
    assert names(answer) == ["saturation"]
    assert answer["causes"][0]["parameters"]["k_percent"]["value"] == pytest.approx(k_percent, rel=1e-3)
    assert answer["extended"]["gain"] > 1000.0


def test_dead_channel_row_does_not_stop_the_answer(tmp_path: Path) -> None:
    x, y = np.cos(np.radians(READ)), np.sin(np.radians(READ))
    x[4] = y[4] = 0.0
    assert ask(tmp_path, columns(vx=2000.0 * x, vy=2000.0 * y))["sweep"]["rejected"] == 0


def test_hundred_thousand_rows_are_read_quickly_and_alike(tmp_path: Path) -> None:
    """Reading alone: missing temperature cells and quotes take the slow road, and give the same figures."""
    reference = 0.036 * np.arange(100_000)
    table = {"reference_deg": reference, "measured_deg": sweep_angles(reference), "temperature_c": 25.0 + 0 * reference}
    gaps = {**table, "temperature_c": np.where(np.arange(reference.size) % 50 == 0, np.nan, 25.0)}
    (tmp_path / "whole.csv").write_text(csv_text(table), encoding="utf-8")
    (tmp_path / "gaps.csv").write_text(csv_text(gaps), encoding="utf-8")
    whole, gappy = Sweep.read(tmp_path / "whole.csv"), Sweep.read(tmp_path / "gaps.csv")
    assert len(whole) == len(gappy) == 100_000
    assert np.array_equal(whole.measured_deg, gappy.measured_deg)
    assert gappy.temperature_c is not None
    assert np.isnan(gappy.temperature_c).sum() == 2000


@pytest.mark.parametrize("unit", [1.0, 1.75e9])
def test_written_and_read_back(unit: float, tmp_path: Path) -> None:
    """Clock times and angles over many turns keep their last digits."""
    sweep = Sweep.from_columns(
        {
            **TABLE,
            "reference_deg": TWO_TURNS + 360.0 * (unit > 1.0) * 50_000,
            "time_s": unit + 0.001 * np.arange(TIME.size),
            "turn": np.floor(TWO_TURNS / 360.0),
        }
    )
    for name in ("again.csv", "again.csv.gz"):
        sweep.write(tmp_path / name)
        again = Sweep.read(tmp_path / name)
        assert list(again.columns) == list(sweep.columns)
        for column, values in sweep.columns.items():
            assert np.allclose(again.columns[column], values, rtol=0.0, atol=2e-6), column
