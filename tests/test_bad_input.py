"""Input that cannot be used: exit code 2 and one line that says where, what was found and what was expected."""

from __future__ import annotations

import gzip
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from twin.errors import SweepError, UserError
from twin.files import SCHEMA
from twin.sweep import Sweep

from .command_line import Array, csv_text, halltwin, sweep_angles

DATA = Path(__file__).parents[1] / "scenarios/data"
TURN = np.arange(0.0, 360.0, 2.0)
READ = sweep_angles(TURN)
TABLE = {"reference_deg": TURN, "measured_deg": READ}
LINES = csv_text(TABLE).splitlines()
HEADER, ROWS = LINES[0], LINES[1:]


def text(*lines: str) -> bytes:
    """Lines as a file."""
    return "\n".join([*lines, ""]).encode()


def with_row(row: str) -> bytes:
    """A good sweep with this row as line 12."""
    return text(HEADER, *ROWS[:10], row, *ROWS[10:])


def columns(**given: Array) -> bytes:
    """A good sweep with columns replaced or added."""
    return csv_text({**TABLE, **given}).encode()


def only(**given: Array) -> bytes:
    """A sweep of these columns."""
    return csv_text(given).encode()


def unwrapped_turns_in_radians() -> bytes:
    reference = np.arange(0.0, 4 * 360.0, 2.0)
    measured = np.unwrap(sweep_angles(reference), period=360.0)
    return only(reference_deg=np.radians(reference), measured_deg=np.radians(measured))


def noise(seed: int, scale: float) -> Array:
    return scale * np.random.default_rng(seed).random(TURN.size)


CIRCLE_X, CIRCLE_Y = np.cos(np.radians(READ)), np.sin(np.radians(READ))

UNUSABLE: dict[str, tuple[bytes, tuple[str, ...]]] = {
    "empty": (b"", ("empty", "header line")),
    "blank lines": (b"\n\n   \n", ("empty", "header line")),
    "comments only": (b"# a\n# b\n", ("empty", "header line")),
    "header only": (text(HEADER), ("line 1", "no row")),
    "no header": (text(*ROWS), ("line 1", "header", "reference_deg")),
    "no header under a comment": (text("# measured today", *ROWS), ("line 2", "header")),
    "missing column": (text("reference_deg,angle", *ROWS), ("line 1", "measured_deg is missing", "angle", "rename")),
    "spaces between cells": (text(*(line.replace(",", " ") for line in LINES)), ("line 1", "is missing")),
    "words": (with_row("20.0,banana"), ("line 12", "measured_deg", "'banana'", "not a number")),
    "escape codes in a cell": (with_row("20.0,\x1b[31mred"), ("line 12", "measured_deg", "not a number")),
    "a very long cell": (with_row("20.0," + "x" * 200_000), ("line 12", "measured_deg", "not a number")),
    "an open quote": (with_row('"20.0,5'), ("line 12", "1 cells", "expected 2")),
    "underscored number": (with_row("20.0,1_0"), ("line 12", "'1_0'", "not a number")),
    "short row": (with_row("20.0"), ("line 12", "1 cells", "expected 2")),
    "long row": (with_row("20.0,1,2,3"), ("line 12", "4 cells", "expected 2")),
    "words as turn": (columns(turn=TURN).replace(b",0.000000\n", b",first\n"), ("line 2", "turn", "'first'")),
    "three rows": (text(HEADER, *ROWS[:3]), ("3 usable rows", "at least 8")),
    "no measured cell at all": (
        only(reference_deg=TURN, measured_deg=np.nan * TURN),
        ("0 usable rows", "180 rejected"),
    ),
    "one single angle": (only(reference_deg=0 * TURN + 30.0, measured_deg=READ), ("reference_deg", "30", "different")),
    "one angle with jitter": (
        only(reference_deg=(noise(1, 0.02) - 0.01) % 360.0, measured_deg=33.0 + noise(2, 0.1)),
        ("reference_deg", "different angles"),
    ),
    "five angles": (
        only(reference_deg=np.repeat(np.arange(5) * 72.0, 10), measured_deg=np.repeat(np.arange(5) * 72.0, 10) + 5.0),
        ("reference_deg", "5 different angles", "at least 8"),
    ),
    "radians": (only(reference_deg=np.radians(TURN), measured_deg=np.radians(READ)), ("radians", "expected degrees")),
    "four turns in radians": (unwrapped_turns_in_radians(), ("radians", "expected degrees")),
    "reference in radians": (columns(reference_deg=np.radians(TURN)), ("reference_deg", "radians", "expected degrees")),
    "sensor in radians": (
        columns(measured_deg=np.radians((READ + 180.0) % 360.0 - 180.0)),
        ("measured_deg", "radians", "expected degrees"),
    ),
    "turns": (only(reference_deg=TURN / 360.0, measured_deg=READ / 360.0), ("radians or turns", "expected degrees")),
    "unrelated columns": (columns(measured_deg=noise(3, 360.0)), ("measured_deg does not follow reference_deg",)),
    "two pole pairs": (columns(measured_deg=2 * READ % 360.0), ("2 times as fast", "divide")),
    "constant sensor": (columns(measured_deg=0 * TURN + 77.0), ("measured_deg", "every row is 77", "follows")),
    "stuck sensor with noise": (columns(measured_deg=77.0 + noise(4, 0.1)), ("measured_deg does not follow",)),
    "stuck sensor over a quarter turn": (
        only(reference_deg=TURN / 4.0, measured_deg=77.0 + noise(4, 0.1)),
        ("measured_deg does not follow",),
    ),
    "one channel of two": (columns(vx=CIRCLE_X), ("vx stands without vy", "both")),
    "one channel empty": (columns(vx=np.nan * TURN, vy=CIRCLE_Y), ("vy stands without vx", "both")),
    "constant channels": (columns(vx=0 * TURN + 0.5, vy=0 * TURN + 0.5), ("vx", "every row is 0.5")),
    "unrelated channels": (columns(vx=noise(5, 1.0) - 0.5, vy=noise(6, 1.0) - 0.5), ("vx, vy", "measured_deg")),
    "channels in codes": (columns(vx=2048 + 900 * CIRCLE_X, vy=2048 + 900 * CIRCLE_Y), ("vx, vy", "2048", "take that")),
    "duplicate header": (text("reference_deg,measured_deg,measured_deg", "1,2,3"), ("measured_deg stands 2 times",)),
    "1e300": (with_row("20.0,1e300"), ("row 11", "measured_deg", "1e+300", "expected")),
    "1e300 s": (columns(time_s=np.where(TURN == 8.0, 1e300, TURN)), ("row 5", "time_s", "1e+300")),
    "colder than absolute zero": (columns(temperature_c=0 * TURN - 999.0), ("row 1", "temperature_c", "-999")),
    "direction of 0 and 1": (columns(direction=TURN % 4.0 / 2.0), ("row 1", "direction", "found 0", "+1 or -1")),
    "half a turn": (columns(turn=TURN / 360.0), ("row 2", "turn", "whole number")),
    "binary": (bytes(range(256)), ("line 1", "no text file")),
    "zeros": (b"\0" * 500, ("line 1", "no text file")),
    "PNG": (b"\x89PNG\r\n\x1a\n" + bytes(100), ("no text file",)),
    "workbook": (b"PK\x03\x04" + bytes(300), ("no text file", "CSV")),
    "a million columns": (text(",".join(["x"] * 1_000_000), *ROWS), ("line 1 is longer than 1,000,000 bytes",)),
    "a line without end": (text(HEADER, *ROWS[:10], "1" * 1_500_000, *ROWS[10:]), ("line 12 is longer",)),
    "eight readings": (text(HEADER, *ROWS[::23]), ("8 readings", "at least 16", "halltwin diagnose")),
    "65 readings at thirteen angles": (
        only(reference_deg=np.repeat(TURN[::14], 5), measured_deg=np.repeat(READ[::14], 5)),
        ("65 readings at 13 angles", "at least 16", "counts once"),
    ),
    "channels without size": (columns(vx=1e-13 * CIRCLE_X, vy=1e-13 * CIRCLE_Y), ("vx", "expected a signal")),
    "cut gzip": (gzip.compress(text(*LINES))[:500], ("cannot be read", "gzip")),
}


def refused(*arguments: str | Path) -> str:
    """The one line that a command refuses with."""
    ended = halltwin(*arguments)
    assert ended.code == 2
    assert ended.err.startswith("halltwin: ")
    assert ended.err.count("\n") == 1
    assert ended.err.endswith("\n")
    assert ended.err.rstrip("\n").isprintable()
    assert len(ended.err) < 1500
    return ended.err


@pytest.mark.parametrize("case", UNUSABLE)
def test_unusable_sweep(case: str, tmp_path: Path) -> None:
    content, words = UNUSABLE[case]
    path = tmp_path / ("bad.csv.gz" if "gzip" in case else "bad.csv")
    path.write_bytes(content)
    written = tmp_path / "answer.json"
    message = refused("explain", path, "--json", written)
    assert path.name in message
    for word in words:
        assert word in message
    assert not written.exists()


@pytest.mark.parametrize("damage", ["cut", "one byte changed", "empty"])
def test_damaged_gzip(damage: str, tmp_path: Path) -> None:
    packed = bytearray(gzip.compress(text(*LINES)))
    packed[200] ^= 255
    content = {"cut": bytes(packed[:500]), "one byte changed": bytes(packed), "empty": b""}[damage]
    (tmp_path / "bad.csv.gz").write_bytes(content)
    assert "bad.csv.gz" in refused("explain", tmp_path / "bad.csv.gz")


def test_no_such_file_and_a_folder(tmp_path: Path) -> None:
    assert "no such file" in refused("explain", tmp_path / "nothing.csv")
    assert "no sweep in this folder" in refused("explain", tmp_path)


def test_line_break_in_the_name_stays_one_line(tmp_path: Path) -> None:
    path = tmp_path / "two\nlines.csv"
    path.write_bytes(b"")
    assert "two lines.csv" in refused("explain", path)


def test_parquet_that_is_none(tmp_path: Path) -> None:
    path = tmp_path / "sweep.parquet"
    path.write_bytes(b"PAR1 no")
    assert "Parquet" in refused("explain", path)


BOMB = gzip.compress(text(HEADER, *ROWS) + b"\n" * 5_000_000)
"""Five megabytes of empty lines below a sweep, packed into a few kilobytes."""


def test_more_than_is_asked_for_is_not_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "bomb.csv"
    path.write_bytes(BOMB)
    assert len(Sweep.read(path)) == TURN.size
    with pytest.raises(SweepError, match=r"bomb\.csv: holds more than 5 MB after decompression; .*--max-size"):
        Sweep.read(path, max_bytes=5_000_000)


def test_what_never_ends_is_not_read_to_its_end() -> None:
    assert "no text file" in refused("explain", "/dev/zero")
    assert "holds more than 20 MB" in refused("explain", DATA / "bench_sweep.csv", "--twin", "/dev/zero")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="a system without named pipes")
def test_a_pipe_is_read_like_a_file(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with subprocess.Popen(["dd", f"of={pipe}", "status=none"], stdin=subprocess.PIPE) as writer:
        assert writer.stdin is not None
        writer.stdin.write(gzip.compress(text(*LINES)))
        writer.stdin.close()
        assert np.array_equal(Sweep.read(pipe).reference_deg, TURN)


HEAD = f'schema = "{SCHEMA}"\n'
BAD_TWINS = {
    "no TOML": ("this is { no toml", ("is no TOML", "line 1")),
    "a sweep": ("reference_deg,measured_deg\n1,2\n", ("is no TOML",)),
    "empty": ("", ("schema is None", SCHEMA)),
    "another schema": ('schema = "halltwin.twin/9"\n', ("halltwin.twin/9", SCHEMA)),
    "unknown effect": (HEAD + "[effects.flux]\nx = 1\n", ("effects.flux", "named 'flux'", "--effects FILE.py")),
    "unknown parameter": (HEAD + "[effects.offset]\nz_percent = 1\n", ("effects.offset", "z_percent", "x_percent")),
    "out of range": (HEAD + "[effects.offset]\nx_percent = 1e9\n", ("x_percent", "between", "1000000000")),
    "not a number": (HEAD + "[effects.offset]\nx_percent = nan\n", ("x_percent", "between", "nan")),
    "infinite": (HEAD + "[effects.offset]\nx_percent = inf\n", ("x_percent", "between", "inf")),
    "a word": (HEAD + '[effects.offset]\nx_percent = "much"\n', ("x_percent", "'much'", "a number")),
    "a truth value": (HEAD + "[effects.offset]\nx_percent = true\n", ("x_percent", "True", "a number")),
    "a list": (HEAD + "[effects.offset]\nx_percent = [1, 2]\n", ("x_percent", "[1, 2]", "a number")),
    "a table": (HEAD + "[effects.offset.x_percent]\na = 1\n", ("x_percent", "a number")),
    "more digits than a number has": (HEAD + f"[effects.offset]\nx_percent = {'9' * 400}\n", ("x_percent", "999...")),
    "more digits than Python reads": (HEAD + f"[effects.offset]\nx_percent = {'9' * 5000}\n", ("is no TOML",)),
    "a whole number of many digits": (
        HEAD + f"[effects.cordic_truncation]\niterations = {'9' * 400}\n",
        ("iterations", "between"),
    ),
    "lists in lists": (HEAD + f"x = {'[' * 5000}", ("too deep",)),
    "a fraction of a step": (HEAD + "[effects.cordic_truncation]\niterations = 7.5\n", ("7.5", "whole number")),
    "an effect that is a number": (HEAD + "[effects]\noffset = 3\n", ("effects.offset", "found 3", "table")),
    "effects as a list": (HEAD + "effects = [1]\n", ("effects", "[1]", "tables")),
    "a misspelt table": (HEAD + "[efects.offset]\nx_percent = 1\n", ("'efects'", "effects")),
    "a sense of 2": (HEAD + "sensor_sense = 2\n", ("sensor_sense", "2", "1 or -1")),
    "a magnet that is a number": (HEAD + "magnet = 3\n", ("magnet", "3", "table")),
    "a word for the magnet": (HEAD + '[magnet]\nshape = "blob"\n', ("magnet", "blob")),
    "a size of another shape": (HEAD + f"[magnet]\nlength_mm = {'9' * 400}\n", ("length_mm", "from 0.1 to 200 mm")),
    "a number as a word": (HEAD + '[magnet]\nwidth_mm = "5"\n', ("width_mm is '5'", "expected a number")),
    "no bore": (HEAD + "[magnet]\nbore_mm = nan\n", ("bore_mm is nan", "from 0 to 200 mm")),
    "an unknown part of the magnet": (HEAD + "[magnet]\nfoo = 3\n", ("magnet", "foo")),
}


@pytest.fixture
def good(tmp_path: Path) -> Path:
    path = tmp_path / "good.csv"
    path.write_bytes(text(*LINES))
    return path


@pytest.mark.parametrize("case", BAD_TWINS)
def test_unusable_twin(case: str, good: Path) -> None:
    content, words = BAD_TWINS[case]
    twin = good.parent / "bad.toml"
    twin.write_text(content, encoding="utf-8")
    message = refused("explain", good, "--twin", twin)
    for word in ("bad.toml", *words):
        assert word in message


def test_twin_that_is_no_file(good: Path) -> None:
    assert "nothing.toml" in refused("explain", good, "--twin", good.parent / "nothing.toml")
    assert "is a folder" in refused("explain", good, "--twin", good.parent)
    (good.parent / "binary.toml").write_bytes(bytes(range(256)))
    assert "is no TOML" in refused("explain", good, "--twin", good.parent / "binary.toml")


@pytest.mark.parametrize("option", ["--json", "--extended", "--report"])
def test_output_that_cannot_be_written(option: str, good: Path) -> None:
    """Said before the work is done, and no other output is written either."""
    other = "--extended" if option == "--json" else "--json"
    fine = good.parent / f"fine.{'toml' if option == '--json' else 'json'}"
    before = sorted(good.parent.iterdir())
    places: dict[Path, str] = {
        good.parent / "nowhere" / "out": "no folder",
        good.parent: "is a folder",
        good / "out": "no folder",
        good: "read or written already",
        fine: "read or written already",
    }
    for place, words in places.items():
        assert words in refused("explain", good, other, fine, option, place)
    assert sorted(good.parent.iterdir()) == before


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="the superuser may write everywhere")
def test_folder_without_permission(good: Path) -> None:
    closed = good.parent / "closed"
    closed.mkdir(mode=0o500)
    assert "permission" in refused("explain", good, "--json", closed / "answer.json")


def test_existing_output_survives_a_refusal(good: Path, tmp_path: Path) -> None:
    answer = tmp_path / "answer.json"
    answer.write_text("from yesterday")
    (tmp_path / "bad.csv").write_bytes(with_row("20.0,banana"))
    refused("explain", tmp_path / "bad.csv", "--json", answer)
    assert answer.read_text() == "from yesterday"


@pytest.mark.parametrize("arguments", [["explain"], ["explain", "a.csv", "--seed", "x"], ["explain", "a.csv", "--no"]])
def test_misuse_of_the_command_line(arguments: list[str]) -> None:
    assert halltwin(*arguments).code == 2


def test_negative_seed(good: Path) -> None:
    assert halltwin("explain", good, "--seed", "-1").code == 2


@pytest.mark.parametrize("command", ["diagnose", "monitor", "compensate"])
def test_other_commands_refuse_alike(command: str, tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_bytes(with_row("20.0,banana"))
    message = refused(command, tmp_path / "bad.csv")
    assert "bad.csv" in message
    assert "banana" in message


def test_from_outside() -> None:
    """As a person runs it: exit code and one line, no traceback."""
    root = Path(__file__).parents[1]
    ended = subprocess.run(
        [sys.executable, "-m", "scenarios.cli.main", "explain", "nothing.csv"], cwd=root, capture_output=True, text=True
    )
    assert ended.returncode == 2
    assert ended.stdout == ""
    assert ended.stderr.splitlines() == ["halltwin: nothing.csv: no such file; give the path of a sweep (CSV)"]


def test_part_of_a_turn_is_not_taken_for_radians() -> None:
    """Structure in a short sweep looks periodic easily; none of 60 draws is refused."""
    for seed in range(60):
        rng = np.random.default_rng(seed)
        reference = rng.uniform(-180.0, 180.0) + np.linspace(0.0, rng.uniform(13.0, 340.0), int(rng.integers(20, 400)))
        ripple = rng.uniform(0.02, 1.0) * np.sin(np.radians(rng.uniform(1.0, 20.0) * reference))
        measured = sweep_angles(reference, seed=seed) + ripple
        assert len(Sweep.from_columns({"reference_deg": reference, "measured_deg": measured})) == reference.size


@pytest.mark.parametrize("command", ["spinning", "hardware"])
def test_output_folder_that_cannot_be_made(command: str, good: Path) -> None:
    assert "good.csv" in refused(command, "-o", good / "folder")


@pytest.mark.parametrize("most", [-1, 0, 1.5, float("nan"), float("inf"), "2GB", None, True, 10**400])
def test_a_limit_of_bytes_that_is_none_is_refused(most: object) -> None:
    with pytest.raises(UserError, match=r"^max_bytes is .{1,50}; expected a whole number of bytes") as caught:
        Sweep.read(DATA / "bench_sweep.csv", max_bytes=most)  # type: ignore[arg-type]
    assert len(str(caught.value)) < 150
