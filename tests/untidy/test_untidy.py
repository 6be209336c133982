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
from tests.untidy.generator import COS, MEASURED_DEG, REFERENCE_DEG, ROWS, Way, counts, files, table, ways
from twin.errors import SweepError, UserError
from twin.logs.read import Log, read_log
from twin.logs.statement import parsed, text_of
from twin.sweep import Sweep

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


def test_a_last_column_that_nobody_filled_in_is_told(tmp_path: Path) -> None:
    rows = "".join(f"{shaft};{shaft + 0.1:.1f};\n" for shaft in range(360))
    log = tmp_path / "log.csv"
    log.write_text(f"Test bench 4;;\nshaft [deg];sensor [deg];remark\n{rows}")
    found = read_log(log)
    assert "column 'remark' is empty" in found.table.notes
    np.testing.assert_allclose(found.columns["measured_deg"] - found.columns["reference_deg"], 0.1)


@pytest.mark.parametrize(("chip", "bits"), [("AS5600", 12), ("as5047p raw", 14), ("TLE5012B", 15)])
def test_a_parts_register_has_as_many_counts_as_its_data_sheet_says(chip: str, bits: int, tmp_path: Path) -> None:
    """Ten readings of a turn, of which the highest word may as well be of another number of counts."""
    shaft = np.arange(0.0, 350.0, 35.0)
    words = np.round(shaft / 360.0 * 2**bits).astype(int)
    log = tmp_path / "log.csv"
    log.write_text(f"protractor,{chip}\n" + "".join(f"{a:.0f},{b}\n" for a, b in zip(shaft, words, strict=True)))
    assert np.max(np.abs(read_log(log).columns["measured_deg"] - shaft)) <= 180.0 / 2**bits + 1e-9


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
