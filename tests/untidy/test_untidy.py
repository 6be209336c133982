"""Untidy logs of one known sweep: each is read to it, or refused with the reason and the option that mends it."""

from __future__ import annotations

import builtins
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.pages import GUIDE, block, lines
from tests.untidy.__main__ import outcome
from tests.untidy.generator import COS, MEASURED_DEG, REFERENCE_DEG, ROWS, SIN, Way, counts, files, table, ways
from tests.untidy.mixed import drawn_geared
from twin.errors import SweepError, UserError
from twin.logs.read import Log, read_log
from twin.logs.statement import parsed, text_of
from twin.logs.units import UNITS
from twin.sweep import Sweep
from twin.sweep_columns import COLUMNS

WAYS = ways()
READ = [name for name, way in WAYS.items() if not way.refused]
REFUSED = [name for name, way in WAYS.items() if way.refused]
FILES = ("workbook", "MAT", "NPZ", "HDF5", "Parquet")
LIBRARIES = {"workbook": "openpyxl", "HDF5": "h5py", "Parquet": "pyarrow"}
OPTION = re.compile(r'--columns "([^"]*)"')


def written(way: Way, folder: Path) -> Path:
    path = folder / f"log{way.ending}"
    path.write_bytes(way.content)
    return path


def check_same(columns: Any, way: Way) -> None:
    """The columns are the sweep's, to the resolution that the way keeps."""
    expected = {"reference_deg": REFERENCE_DEG, "measured_deg": MEASURED_DEG, **way.others}
    for name, values in expected.items():
        off = columns[name] - values
        if name in ("reference_deg", "measured_deg"):
            off = (off + 180.0) % 360.0 - 180.0
        assert np.max(np.abs(off)) <= way.resolution.get(name, 1e-5), name
    assert set(columns) == set(expected)


def told(log: Log) -> str:
    return "; ".join([*log.guess.unused, *log.table.left])


def test_there_are_thirty_ways_and_more() -> None:
    assert len(WAYS) >= 30


@pytest.mark.parametrize("name", READ)
def test_an_untidy_log_is_read_to_the_same_sweep(name: str, tmp_path: Path) -> None:
    way = WAYS[name]
    log = read_log(written(way, tmp_path))
    check_same(log.columns, way)
    for word in way.unused:
        assert word in told(log)


def test_lines_that_end_with_the_separator_have_no_further_column(tmp_path: Path) -> None:
    assert told(read_log(written(WAYS["lines that end with the separator"], tmp_path))) == ""


@pytest.mark.parametrize("name", READ)
def test_the_printed_guess_reads_the_same(name: str, tmp_path: Path) -> None:
    """By ``--columns`` in any command the file is the very sweep that was guessed, bit for bit."""
    path = written(WAYS[name], tmp_path)
    log = read_log(path)
    assert parsed(log.guess.text) == log.guess.columns
    again = Sweep.read(path, columns=log.guess.text)
    for column, values in log.columns.items():
        assert np.array_equal(again.columns[column], values), column


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_certain_is_refused_with_the_reason_and_what_mends_it(name: str, tmp_path: Path) -> None:
    way = WAYS[name]
    path = written(way, tmp_path)
    ended = halltwin("import", path, "-o", tmp_path / "sweep.csv")
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    for word in way.refused:
        assert word in ended.err
    assert not (tmp_path / "sweep.csv").exists()
    if way.resolution:
        check_same(read_log(path, columns=OPTION.findall(ended.err)[0]).columns, way)


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_another_program_is_read_to_the_same_sweep(name: str, tmp_path: Path) -> None:
    pytest.importorskip(LIBRARIES.get(name, "numpy"))
    way = files(name)
    path = written(way, tmp_path)
    log = read_log(path)
    check_same(log.columns, way)
    assert dict.fromkeys(log.columns, "").keys() == Sweep.read(path, columns=log.guess.text).columns.keys()
    for word in way.unused:
        assert word in told(log) + " ".join(log.table.notes)


@pytest.mark.parametrize(("name", "module"), LIBRARIES.items())
def test_a_missing_library_is_named_with_its_extra(
    name: str, module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip(module)
    path, own = written(files(name), tmp_path), builtins.__import__

    def lacking(wanted: str, *rest: Any, **named: Any) -> Any:
        if wanted.split(".")[0] == module:
            raise ImportError(f"No module named {module!r}", name=module)
        return own(wanted, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", lacking)
    ended = halltwin("import", path)
    assert ended.code == 2
    assert f"needs {module}; pip install '.[formats]' in the checkout" in ended.err
    assert ended.err.count("\n") == 1


@pytest.mark.parametrize("name", FILES)
def test_a_damaged_file_is_one_line(name: str, tmp_path: Path) -> None:
    pytest.importorskip(LIBRARIES.get(name, "numpy"))
    path = tmp_path / "log"
    path.write_bytes(files(name).content[:700])
    ended = halltwin("import", path)
    assert ended.code == 2
    assert ended.err.startswith("halltwin: log: ")
    assert ended.err.count("\n") == 1


# ---- the command ----------------------------------------------------------------------------------------------------


def test_import_writes_the_sweep_and_says_what_it_read(tmp_path: Path) -> None:
    path = written(WAYS["counts of an encoder"], tmp_path)
    sweep = tmp_path / "sweep.csv"
    ended = halltwin("import", path, "-o", sweep)
    assert ended.code == 0
    assert "read as: --columns \"reference_deg=enc_counts*360/40000, measured_deg='angle [rad]':rad\"" in ended.err
    assert "not used: nothing is left" in ended.err
    assert ended.out.splitlines() == [f"wrote {sweep}"]
    again, log = Sweep.read(sweep), read_log(path)
    assert np.allclose(again.measured_deg, log.columns["measured_deg"], rtol=1e-8)
    assert len(again) == ROWS


def test_the_page_shows_what_import_says(tmp_path: Path) -> None:
    columns = {
        "sample": np.arange(ROWS) + 1.0,
        "time_ms": 50.0 * np.arange(ROWS),
        "enc_counts": counts(REFERENCE_DEG, 40_000, wrapped=False),
        "Angle [rad]": np.radians(MEASURED_DEG),
    }
    (tmp_path / "log.csv").write_text(table(columns, sep=";", decimal=","))
    said = halltwin("import", tmp_path / "log.csv").err
    assert said.splitlines() == lines(block(GUIDE / "logs.md", "import"))


def test_a_sweep_of_the_projects_own_is_imported_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "own.csv").write_text(table({"reference_deg": REFERENCE_DEG, "measured_deg": MEASURED_DEG}))
    assert halltwin("import", tmp_path / "own.csv", "-o", tmp_path / "sweep.csv").code == 0
    own, again = Sweep.read(tmp_path / "own.csv"), Sweep.read(tmp_path / "sweep.csv")
    assert np.array_equal(own.measured_deg, again.measured_deg)
    assert np.array_equal(own.reference_deg, again.reference_deg)


def test_rows_keep_their_numbers(tmp_path: Path) -> None:
    """A missing cell stays missing in the sweep, so that a rejected row is that of the log."""
    rows = table({"ref": REFERENCE_DEG, "sensor": MEASURED_DEG}).splitlines()
    rows[5] = rows[5].split(",")[0] + ","
    (tmp_path / "log.csv").write_text("\n".join(rows))
    ended = halltwin("import", tmp_path / "log.csv", "-o", tmp_path / "sweep.csv")
    assert "360 rows, 1 of them with missing cells" in ended.err
    assert list(Sweep.read(tmp_path / "sweep.csv").rejected) == [5]


@pytest.mark.parametrize("command", ["explain", "diagnose", "compensate", "monitor"])
def test_a_log_that_is_refused_is_told_how_it_would_be_read(command: str, tmp_path: Path) -> None:
    ended = halltwin(command, written(WAYS["counts of the sensor"], tmp_path))
    assert ended.code == 2
    assert OPTION.findall(ended.err) == ["reference_deg=ref_deg, measured_deg='AS5600 raw'*360/4096"]


def test_diagnose_reads_a_log_by_columns(tmp_path: Path) -> None:
    """And finds in it what it finds in the sweep that import writes of it."""
    path = written(WAYS["counts of the sensor"], tmp_path)
    assert halltwin("import", path, "-o", tmp_path / "log2.csv").code == 0
    option = "reference_deg=ref_deg, measured_deg='AS5600 raw'*360/4096"
    asked = halltwin("diagnose", path, "--columns", option)
    assert asked.code == 0
    assert asked.out.split()[1:] == halltwin("diagnose", tmp_path / "log2.csv").out.split()[1:]


@pytest.mark.parametrize("name", ["NPZ", "workbook", "Parquet"])
def test_a_file_that_grows_beyond_the_limit_is_refused_before_it_is_unpacked(name: str, tmp_path: Path) -> None:
    """A hundred thousand times the same number take a few bytes in the file, and 800 kB a column once they are read."""
    pytest.importorskip(LIBRARIES.get(name, "numpy"))
    path, same = tmp_path / "log", np.full(100_000, 7.0)
    if name == "NPZ":
        np.savez_compressed(path.with_suffix(".npz"), ref_deg=same, sensor_deg=same)
        path = path.with_suffix(".npz")
    elif name == "Parquet":
        from pyarrow import parquet
        from pyarrow import table as columns

        parquet.write_table(columns({"ref_deg": same, "sensor_deg": same}), path)
    else:
        path.write_bytes(files(name).content)
    with pytest.raises(SweepError, match=r"MB after decompression; expected at most 0\.02[0-9]* MB; --max-size"):
        read_log(path, max_bytes=max(path.stat().st_size, 20_000))


# ---- what --columns says --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "reference_deg=enc_counts*360/40000, measured_deg=angle:rad",
        "time_s=#1:ms, reference_deg=#2, measured_deg=#3/1.5-20",
        "reference_deg='a, b (=c)':rev, measured_deg=atan2('sin, (V)'-2048, cos-2047.5)",
        "reference_deg=angle.mech*-1, measured_deg=Winkel_ä:mrad, vx=a-2048, vy=b*1e-3+0.5",
    ],
)
def test_a_statement_is_read_as_it_is_printed(text: str) -> None:
    assert parsed(text_of(parsed(text))) == parsed(text)
    assert text_of(parsed(text_of(parsed(text)))) == text_of(parsed(text))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "reference_deg is missing"),
        ("reference_deg=a", "measured_deg is missing"),
        ("reference_deg=a, measured_deg", "expected COLUMN=NAME"),
        ("reference_deg=a, measured_deg=b, measured_deg=c", "said 2 times"),
        ("reference_deg=a, measured_deg=b, flux=c", "'flux' is no column of a sweep"),
        ("reference_deg=a, measured_deg=b*0", "0 is no factor"),
        ("reference_deg=a, measured_deg=b/1e999", "is no factor"),
        ("reference_deg=a, measured_deg=b:furlong", "expected one of deg, rad"),
        ("reference_deg=a, measured_deg=b:s", "expected one of deg, rad"),
        ("reference_deg=a, measured_deg=b, vx=c:rad", "vx has no unit"),
        ("reference_deg=a, measured_deg=__import__('os').system('x')", "expected"),
        ("reference_deg=a, measured_deg=b**2", "expected"),
        ("reference_deg=a, measured_deg=atan2(b)", "expected two channels"),
        ("reference_deg=a, measured_deg=atan2(b, c, d)", "expected two channels"),
        ("reference_deg=a, measured_deg=(b", "expected"),
        ("reference_deg=a, measured_deg=nothing", "no column 'nothing'; found 'a', 'b'"),
        ("reference_deg=a, measured_deg=#3", "no column '#3'"),
    ],
)
def test_a_statement_that_is_none_is_refused_in_one_line(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"a": REFERENCE_DEG, "b": MEASURED_DEG}))
    with pytest.raises(UserError) as caught:
        Sweep.read(path, columns=text)
    assert words in str(caught.value)
    assert len(str(caught.value)) < 500


def test_a_name_that_stands_twice_goes_by_its_place(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(
        table({"ref": REFERENCE_DEG, "angle": MEASURED_DEG, "x": 0 * COS}).replace("ref,angle,x", "ref,a,a")
    )
    with pytest.raises(SweepError, match="column 'a' stands 2 times; say which: #2 or #3"):
        Sweep.read(path, columns="reference_deg=ref, measured_deg=a")
    assert len(Sweep.read(path, columns="reference_deg=ref, measured_deg=#2")) == ROWS


# ---- the guess ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(12))
def test_counts_a_turn_are_found_or_asked_for(seed: int, tmp_path: Path) -> None:
    """Of encoders and sensors of any size; a number that no encoder has is never taken for one that some have."""
    rng = np.random.default_rng(seed)
    a_turn = int(rng.choice([1024, 2000, 2400, 4096, 8192, 10_000, 16_384, 36_000, 40_000]))
    odd = bool(seed % 3 == 0)
    actual = round(a_turn * float(rng.uniform(1.03, 1.07))) if odd else a_turn
    shaft = np.linspace(0.0, float(rng.uniform(400.0, 1500.0)), 300)
    error = rng.uniform(0.05, 1.5) * np.sin(np.radians(shaft + rng.uniform(0.0, 360.0)))
    sense = float(rng.choice([-1.0, 1.0]))
    log = {"enc_counts": counts(shaft, actual, wrapped=False), "angle_deg": (sense * shaft + error) % 360.0}
    path = tmp_path / "log.csv"
    path.write_text(table(log))
    if odd:
        with pytest.raises(SweepError, match=r"no two columns|values fit"):
            read_log(path)
    else:
        assert f"enc_counts*360/{a_turn}," in read_log(path).guess.text


U = np.degrees(np.unwrap(np.radians(MEASURED_DEG)))
ODD = {
    "counts": (
        {"enc_counts": counts(REFERENCE_DEG, 4301, wrapped=False), "angle_deg": MEASURED_DEG},
        "4301 counts",
        4e-3,
    ),
    "a gear at the sensor": ({"encoder_deg": REFERENCE_DEG, "hall_deg": 3.5 * U % 360.0}, "3.5 times", 4e-3),
    "a gear at the reference": ({"encoder_deg": 2.25 * REFERENCE_DEG, "hall_deg": MEASURED_DEG}, "2.25 times", 4e-3),
}


@pytest.mark.parametrize("name", ODD)
def test_an_odd_factor_is_told_roughly_and_asked_back(name: str, tmp_path: Path) -> None:
    """To a share of the turn that errors of order 1, of 0.8 deg, make in two and a half turns."""
    columns, words, share = ODD[name]
    path = tmp_path / "log.csv"
    path.write_text(table(columns))
    refused = halltwin("import", path)
    assert refused.code == 2
    assert "about" in refused.err
    (statement,) = OPTION.findall(refused.err)
    found = Sweep.read(path, columns=statement)
    for angle, true in ((found.reference_deg, REFERENCE_DEG), (found.measured_deg, MEASURED_DEG)):
        turned = np.degrees(np.unwrap(np.radians(angle)))
        assert np.ptp(turned) == pytest.approx(np.ptp(np.degrees(np.unwrap(np.radians(true)))), rel=share)
    value, unit = words.split()
    told = re.search(rf"about ([\d.]+) {unit}", refused.err)
    assert told
    assert float(told[1]) == pytest.approx(float(value), rel=share)


def test_channels_in_codes_lose_the_middle_of_their_range(tmp_path: Path) -> None:
    adc = {"sin": np.round(2048 + 900 * SIN), "cos": np.round(2048 + 900 * COS)}
    (tmp_path / "log.csv").write_text(table({"ref": REFERENCE_DEG, "sensor": MEASURED_DEG, **adc}))
    log = read_log(tmp_path / "log.csv")
    assert "vx=cos-2048, vy=sin-2048" in log.guess.text
    assert any("middle of the converter" in note for note in log.guess.notes)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_direction_of_0_and_1_is_told_by_the_reference(sense: float, tmp_path: Path) -> None:
    there = np.concatenate([REFERENCE_DEG, REFERENCE_DEG[::-1]])
    forward = np.repeat([1.0, 0.0] if sense > 0 else [0.0, 1.0], ROWS)
    both = np.concatenate([MEASURED_DEG, MEASURED_DEG[::-1]])
    (tmp_path / "log.csv").write_text(table({"ref": there, "sensor": both, "dir": forward}))
    found = read_log(tmp_path / "log.csv").columns["direction"]
    assert np.array_equal(found, np.repeat([1.0, -1.0], ROWS))


def test_every_column_of_a_sweep_can_be_said() -> None:
    text = ", ".join(f"{name}={name}" for name in COLUMNS)
    assert [column.target for column in parsed(text)] == list(COLUMNS)


@pytest.mark.parametrize("name", [name for name, unit in UNITS.items() if unit.quantity == "angle"])
def test_every_unit_of_an_angle_that_a_header_names_is_read(name: str, tmp_path: Path) -> None:
    rows = zip(REFERENCE_DEG / UNITS[name].factor, MEASURED_DEG, strict=True)
    path = tmp_path / "log.csv"
    path.write_text(f"ref [{name}];sensor [deg]\n" + "\n".join(f"{a:.9g};{b:.6f}" for a, b in rows))
    columns = read_log(path).columns
    np.testing.assert_allclose(columns["reference_deg"], REFERENCE_DEG, atol=1e-5)
    np.testing.assert_allclose(columns["measured_deg"], MEASURED_DEG, atol=1e-5)


def test_of_geared_logs_drawn_at_random_none_is_misread(tmp_path: Path) -> None:
    """Of 60; of one in twenty counts that may make a turn are asked back, as many of large steps are refused."""
    found = [outcome(seed, tmp_path, drawn_geared) for seed in range(60)]
    assert found.count("wrong") == 0
    assert found.count("asked back") <= 3
    assert found.count("right") >= 51


def test_electrical_degrees_are_read_and_said(tmp_path: Path) -> None:
    """An electrical angle of seven pole pairs, wrapped and in radians; its errors are those of the shaft."""
    path = tmp_path / "log.csv"
    electrical = np.radians(7.0 * MEASURED_DEG % 360.0)
    path.write_text(table({"encoder_deg": REFERENCE_DEG, "theta_e [rad]": electrical}))
    log = read_log(path)
    assert log.guess.text == "reference_deg=encoder_deg, measured_deg=unwrap('theta_e [rad]':rad)/7"
    assert log.guess.notes == ("measured_deg turns 7 times in a turn of the shaft: pole pairs, or a gear",)
    off = log.columns["measured_deg"] - MEASURED_DEG
    assert np.max(np.abs((off - off[0] + 180.0) % 360.0 - 180.0)) < 1e-4


def test_a_missing_cell_of_an_electrical_angle_stays_one(tmp_path: Path) -> None:
    """And ends nothing: the rows behind it are followed from the row before it."""
    path = tmp_path / "log.csv"
    rows = table({"encoder_deg": REFERENCE_DEG, "theta_e_deg": 7.0 * MEASURED_DEG % 360.0}).splitlines()
    rows[9] = rows[9].split(",")[0] + ","
    path.write_text("\n".join(rows))
    log = read_log(path)
    assert list(np.flatnonzero(np.isnan(log.columns["measured_deg"]))) == [8]
    assert log.guess.text == "reference_deg=encoder_deg, measured_deg=unwrap(theta_e_deg)/7"


def test_geared_radians_or_degrees_of_a_short_span_are_asked_for(tmp_path: Path) -> None:
    """Two angles that span 47 and tell no unit, both alike in degrees and, over seven turns, in radians."""
    path = tmp_path / "log.csv"
    shaft = np.linspace(0.0, 7.5 * 360.0, 400)
    path.write_text(table({"ref": np.radians(shaft), "sensor": np.radians(shaft + 30.0 + np.sin(np.radians(shaft)))}))
    with pytest.raises(SweepError, match=r"two guesses fit.*measured_deg=sensor:rad"):
        read_log(path)


def test_own_names_are_told_how_an_electrical_angle_is_read(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table({"reference_deg": REFERENCE_DEG, "measured_deg": 4.0 * MEASURED_DEG % 360.0}))
    refused = halltwin("diagnose", path).err
    assert "turns 4 times as fast" in refused
    assert OPTION.findall(refused) == ["reference_deg=reference_deg, measured_deg=unwrap(measured_deg)/4"]


def test_of_logs_drawn_at_random_none_is_misread(tmp_path: Path) -> None:
    """Of 60; one in ten may be asked back, as on a single turn 4000 and 4096 counts are hardly told apart."""
    found = [outcome(seed, tmp_path) for seed in range(60)]
    assert found.count("wrong") == 0
    assert found.count("right") >= 54
