"""Killed in the middle: the run goes on from the last complete angle."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import can
import pytest

from scenarios.bench import journal
from scenarios.bench.command import Options, run
from scenarios.bench.hidden import hidden_encoder
from scenarios.bench.journal import SCHEMA, finished_path, running_path
from scenarios.bench.plan import Plan
from scenarios.bench.sealed_lines import sealed
from scenarios.bench.sequence import Patience
from scenarios.commands.file_lock import alone
from tests.command_line import halltwin
from tests.scenarios.bench.rig import PLAN, assert_same_readings, quiet_encoder, run_bench
from twin.errors import UserError
from twin.files import write_twin


def test_a_killed_run_goes_on(tmp_path: Path, undisturbed: tuple[Path, Path]) -> None:
    twin, sweep = tmp_path / "quiet.toml", tmp_path / "sweep.csv"
    write_twin(twin, quiet_encoder())
    options = ["--twin", str(twin), "--points", "64", "--both-directions", "-o", str(sweep)]
    # The encoder falls silent after its 200th frame, the 100th reading: time enough to be killed in the middle.
    options += ["--fault", "silent:hall=20"]
    command = [sys.executable, "-m", "scenarios.cli.main", "bench", *options, "--attempts", "200"]
    process = subprocess.Popen(command)
    journal = running_path(sweep)
    end = time.monotonic() + 30.0
    while time.monotonic() < end and not (journal.exists() and journal.read_bytes().count(b"\n") > 100):
        time.sleep(0.005)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not sweep.exists()
    kept = journal.read_bytes().count(b'"reading"')
    assert 100 <= kept < 128
    # The line that the kill cut off.
    with journal.open("a") as file:
        file.write('{"reading": {"index": 9')
    run(Options(output=sweep, twin=str(twin), points=64, both_directions=True, faults=["silent:hall=20"]))
    assert_same_readings(sweep, undisturbed[0])
    assert not journal.exists()
    assert all(json.loads(line) for line in finished_path(sweep).read_text().splitlines())


@pytest.mark.parametrize("kept", [1, 30, 60, 61, 66, 119])
def test_a_run_that_goes_on_behind_a_reversal_finds_the_field_as_it_was(tmp_path: Path, kept: int) -> None:
    """The concentrator remembers 20 deg; a reversal that the run-in left out would show by 0.9 deg."""
    twin = tmp_path / "lagging.toml"
    write_twin(twin, quiet_encoder().with_effect("hysteresis", lag_deg=0.6, memory_deg=20.0))
    whole, broken = (
        Options(output=tmp_path / name, twin=str(twin), points=60, both_directions=True)
        for name in ("whole.csv", "broken.csv")
    )
    run(whole)
    lines = finished_path(whole.output).read_text().splitlines(keepends=True)
    running_path(broken.output).write_text("".join(lines[: kept + 1]))
    run(broken)
    assert_same_readings(broken.output, whole.output)


def test_a_journal_of_another_plan_is_not_continued(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.csv"
    with pytest.raises(UserError):
        run_bench(sweep, faults=["gone:hall=40"], patience=Patience(timeout_s=0.05, attempts=10))
    with pytest.raises(UserError, match="was begun with --points 64, now 45; --both-directions on, now off; give"):
        run_bench(sweep, plan=Plan(points=45))
    with pytest.raises(UserError, match="a log would lack them"):
        run_bench(sweep, record=tmp_path / "bus.log")


HEAD = {"schema": SCHEMA, "settings": {"plan": asdict(PLAN)}}
READING = {
    "index": 0,
    "time_s": 1.0,
    "reference_deg": 0.0,
    "measured_deg": 0.1,
    "direction": 1,
    "speed_rpm": 0.0,
    "turn": 0,
    "temperature_c": 25.0,
    "vx": 1.0,
    "vy": 0.0,
    "index_seen": True,
    "corrected": False,
}
NEXT = {**READING, "index": 1}


def lines(*entries: dict[str, Any]) -> list[bytes]:
    """A journal that begins well."""
    made: list[bytes] = []
    seal = ""
    for entry in (HEAD, {"reading": READING}, *entries):
        line, seal = sealed(entry, seal)
        made.append(line)
    return made


WELL = lines({"reading": NEXT}, {"event": {"kind": "late", "message": "HallAngle", "index": 1}})
DIGITS = b"1" + b"0" * 400


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ([b"not a journal\n"], "is no journal of the bench"),
        ([b"not a journal"], "is no journal of the bench"),
        ([b"\xff\xfe"], "is no journal of the bench"),
        ([*WELL[:2], b"{garbage\n", WELL[2]], "line 3 is damaged: bears no checksum"),
        ([*WELL[:2], b"\xff\n"], "line 3 is damaged: bears no checksum"),
        ([*WELL[:2], b"[" * 100_000 + b"]" * 100_000 + b"\n"], "line 3 is damaged: bears no checksum"),
        ([WELL[0], WELL[1].replace(b": 0.1,", b": 0.2,"), WELL[2]], "line 2 is damaged: is not as it was written"),
        ([WELL[0], WELL[1].replace(b": 0.1,", b": 1e308,"), WELL[2]], "line 2 is damaged: is not as it was written"),
        ([WELL[0], WELL[1].replace(b": 0.1,", b": NaN,"), WELL[2]], "line 2 is damaged: is not as it was written"),
        ([WELL[0], WELL[1].replace(b": 0.1,", b": " + DIGITS + b",")], "line 2 is damaged: is not as it was written"),
        ([*WELL[:3], WELL[2]], "line 4 is damaged: is not as it was written, or not in its place"),
        ([WELL[0], WELL[2], WELL[1]], "line 2 is damaged: is not as it was written, or not in its place"),
        ([WELL[0], WELL[1], WELL[3]], "line 3 is damaged: is not as it was written, or not in its place"),
        (lines({"reading": 7}), "line 3 is damaged: a reading has not the entries of one"),
        (lines({"reading": {**NEXT, "index": "1"}}), "line 3 is damaged: index is no such value"),
        (lines({"reading": {**NEXT, "index": 1.5}}), "line 3 is damaged: index is no such value"),
        (lines({"reading": {**NEXT, "index": 2}}), "line 3 is damaged: expected the reading of place 1"),
        (lines({"reading": READING}), "line 3 is damaged: expected the reading of place 1"),
        (
            lines({"reading": {**NEXT, "measured_deg": float("nan")}}),
            "line 3 is damaged: measured_deg is no such value",
        ),
        (lines({"reading": {**NEXT, "measured_deg": int(DIGITS)}}), "line 3 is damaged: measured_deg is no such value"),
        (lines({"reading": {**NEXT, "measured_deg": None}}), "line 3 is damaged: measured_deg is no such value"),
        (lines({"reading": {**NEXT, "index_seen": 1}}), "line 3 is damaged: index_seen is no such value"),
    ],
)
def test_a_damaged_journal_is_one_line_and_stays(tmp_path: Path, content: list[bytes], said: str) -> None:
    sweep = tmp_path / "sweep.csv"
    running_path(sweep).write_bytes(b"".join(content))
    with pytest.raises(UserError) as refused:
        run_bench(sweep)
    assert said in str(refused.value)
    assert "move" in str(refused.value)
    assert {item.name: item.read_bytes() for item in tmp_path.iterdir()} == {
        running_path(sweep).name: b"".join(content)
    }


@pytest.mark.parametrize("length", [0, 10, len(lines()[0])])
def test_a_journal_without_a_reading_blocks_nothing(
    tmp_path: Path, undisturbed: tuple[Path, Path], length: int
) -> None:
    sweep = tmp_path / "sweep.csv"
    other, _ = sealed({**HEAD, "settings": {"twin": "another encoder, mistyped"}}, "")
    running_path(sweep).write_bytes(other[:length])
    run_bench(sweep)
    assert_same_readings(sweep, undisturbed[0])


@pytest.mark.parametrize("given", ["--restart", "--force"])
def test_what_is_no_journal_is_never_removed(tmp_path: Path, given: str) -> None:
    sweep, mine, journal = (tmp_path / name for name in ("sweep.csv", "mine.txt", "sweep.csv.journal.jsonl"))
    mine.write_text("my notes")
    plants: dict[str, Callable[[], None]] = {
        "is no journal of the bench": lambda: journal.write_text("my notes"),
        "expected a plain file": lambda: journal.symlink_to(mine),
        "a link, a folder": lambda: journal.symlink_to(tmp_path / "nowhere"),
        "a pipe": lambda: os.mkfifo(journal),
        "or a device": lambda: journal.symlink_to("/dev/zero"),
    }
    for said, plant in plants.items():
        plant()
        before = (journal.lstat().st_ino, journal.lstat().st_mode)
        ended = halltwin("bench", "-o", sweep, "--points", "12", given)
        assert (ended.code, ended.err.count("\n")) == (2, 1), ended
        assert said in ended.err
        assert (journal.lstat().st_ino, journal.lstat().st_mode) == before
        journal.unlink()
    assert [item.name for item in tmp_path.iterdir()] == ["mine.txt"]
    assert mine.read_text() == "my notes"


@pytest.fixture
def broken_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, ...]:
    """A command that has been broken off in the middle of its measurement of m.csv, in the working folder."""
    monkeypatch.chdir(tmp_path)
    write_twin("own.toml", hidden_encoder(None, ()))
    command = ("bench", "-o", "m.csv", "--twin", "own.toml", "--points", "36", "--fault", "gone:hall=60")
    assert "readings are kept" in halltwin(*command, "--attempts", "2", "--timeout", "0.05").err
    return command


def with_other(command: tuple[str, ...], *options: str) -> tuple[str, ...]:
    """The command with these options, in place of what it gives itself for one that may not be repeated."""
    own = list(command)
    for name in ({*options} & {*own}) - {"--fault"}:
        del own[own.index(name) : own.index(name) + 2]
    return (*own, *options)


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (("--no-channels",), "begun with --channels on, now off;"),
        (("--no-chamber",), "begun with --chamber on, now off;"),
        (("--points", "40"), "begun with --points 36, now 40;"),
        (("--settle", "0.5", "--seed", "3"), "begun with --settle 0.3, now 0.5; --seed 0, now 3;"),
        (("--speed-rpm", "0", "--speed-rpm", "60"), "begun with --speed-rpm 0.0, now 0.0,60.0;"),
        (("--fault", "wild=0.01"), "begun with --fault gone:hall=60, now gone:hall=60,wild:hall=0.01;"),
        (("--hide", "saturation:k_percent=2"), "the twin's effects.saturation.k_percent none, now 2;"),
        (("--twin", "paper-encoder"), ""),
    ],
    ids=str,
)
def test_other_options_are_refused_by_name(broken_off: tuple[str, ...], other: tuple[str, ...], said: str) -> None:
    before = Path("m.csv.journal.jsonl").read_bytes()
    ended = halltwin(*with_other(broken_off, *other))
    if not said:
        # A twin is what it holds, whatever its file is called.
        assert ended.code == 0
        return
    assert (ended.code, ended.err.count("\n")) == (2, 1), ended
    assert said in ended.err
    assert "--restart" in ended.err
    assert Path("m.csv.journal.jsonl").read_bytes() == before


def test_a_twin_or_effect_edited_under_its_name_is_another(broken_off: tuple[str, ...]) -> None:
    twin = Path("own.toml")
    text = twin.read_text()
    (noise,) = [line for line in text.splitlines() if line.startswith("rms_deg")]
    twin.write_text(text.replace(noise, "rms_deg = 0.5"))
    assert f"the twin's effects.noise.{noise.replace(' =', '')}, now 0.5;" in halltwin(*broken_off).err
    twin.write_text(text)
    assert halltwin("new-effect", "wobble").code == 0
    assert "--effects none, now wobble.py (SHA-256 " in halltwin(*broken_off, "--effects", "wobble.py").err


def test_only_what_the_run_itself_wrote_is_replaced_unasked(broken_off: tuple[str, ...]) -> None:
    sweep, log = Path("m.csv"), Path("m.csv.log.jsonl")
    for foreign in (sweep, log):
        foreign.write_text("somebody's own")
        ended = halltwin(*broken_off)
        assert (ended.code, ended.err.count("\n")) == (2, 1), ended
        assert f"{foreign}: is there already" in ended.err
        assert foreign.read_text() == "somebody's own"
        foreign.unlink()
    assert halltwin(*broken_off).code == 0
    # As if it had been killed when the sweep was written and the journal was not yet its log.
    log.rename("m.csv.journal.jsonl")
    written = sweep.read_bytes()
    assert halltwin(*broken_off).code == 0
    assert sweep.read_bytes() == written
    # What the journal says of a sweep does not give another one away that lies in its place.
    log.rename("m.csv.journal.jsonl")
    sweep.write_text("somebody's own")
    assert "m.csv: is there already" in halltwin(*broken_off).err
    assert sweep.read_text() == "somebody's own"


@pytest.mark.parametrize("planted", [b"", sealed(HEAD, "")[0]], ids=["empty", "begun"])
def test_a_journal_that_says_nothing_of_a_sweep_does_not_give_it_away(
    broken_off: tuple[str, ...], planted: bytes
) -> None:
    assert halltwin(*broken_off).code == 0
    kept = {name: Path(name).read_bytes() for name in ("m.csv", "m.csv.log.jsonl")}
    Path("m.csv.journal.jsonl").write_bytes(planted)
    for more in ((), ("--points", "40", "--seed", "9"), ("--restart",)):
        assert "m.csv: is there already" in halltwin(*with_other(broken_off, *more)).err
    assert {name: Path(name).read_bytes() for name in kept} == kept


@pytest.mark.parametrize(
    "options",
    [
        ("--hide", "foo"),
        ("--hide", "saturation:k_percent=much"),
        ("--twin", "nope"),
        ("--fault", "lost:nobody"),
        ("--points", "3"),
        ("--timeout", "nan"),
        ("--temperatures", "warm"),
        ("--interface", "nope"),
        ("--interface", "udp_multicast", "--hide", "hysteresis:lag_deg=1"),
    ],
    ids=" ".join,
)
def test_a_mistake_in_an_option_is_one_line_and_leaves_nothing(tmp_path: Path, options: tuple[str, ...]) -> None:
    ended = halltwin("bench", "-o", tmp_path / "sweep.csv", *options)
    assert ended.code == 2
    assert ended.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_one_line_and_room_lets_it_go_on(
    tmp_path: Path, undisturbed: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep = tmp_path / "sweep.csv"
    with monkeypatch.context() as full:
        full.setattr(journal, "_opened", on_a_disk_of(10_000))
        with pytest.raises(
            UserError, match=r"journal\.jsonl: cannot be written \(No space left .* of 128 readings are kept"
        ):
            run_bench(sweep)
    kept = running_path(sweep).read_bytes()
    assert 0 < kept.count(b'"reading"') < 128
    assert kept.endswith(b"}\n")
    run_bench(sweep)
    assert_same_readings(sweep, undisturbed[0])


def on_a_disk_of(size: int) -> Callable[[Path], Any]:
    """Opens a journal that takes so many bytes, the last of them in half a line."""
    whole = journal._opened

    class Full:
        def __init__(self, file: Any) -> None:
            self._file, self._left = file, size

        def __getattr__(self, name: str) -> Any:
            return getattr(self._file, name)

        def write(self, line: bytes) -> int:
            part = line[: self._left]
            self._left -= len(part)
            return int(self._file.write(part))

    return lambda path: Full(whole(path))


def test_a_second_bench_for_the_same_sweep_is_refused(tmp_path: Path) -> None:
    sweep = tmp_path / "sweep.csv"
    with alone(tmp_path / "sweep.csv.lock", busy="the test's own"):
        ended = subprocess.run(
            [sys.executable, "-m", "scenarios.cli.main", "bench", "-o", str(sweep)],
            capture_output=True,
            text=True,
            check=False,
        )
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
    assert "another halltwin measures into it" in ended.stderr
    assert not list(tmp_path.iterdir())


def test_a_bus_log_that_its_own_thread_cannot_write_is_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(can.SqliteWriter, "_create_db", lambda *_: sqlite3.connect(":memory:"))
    before = threading.excepthook
    with pytest.raises(UserError, match=r"bus\.db: cannot be written \(no such table: messages\)"):
        run_bench(tmp_path / "sweep.csv", record=tmp_path / "bus.db")
    assert threading.excepthook is before
