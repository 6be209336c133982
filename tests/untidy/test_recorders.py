"""Files of measurement systems and of buses, written by their own libraries, are read to the same sweep."""

from __future__ import annotations

import builtins
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.untidy.generator import MEASURED_DEG, REFERENCE_DEG, ROWS, TEMPERATURE_C, TIME_S
from tests.untidy.recorders import LATE_S, bus, mdf, tdms
from twin.errors import SweepError
from twin.logs.clocks import Channel, on_one_clock
from twin.logs.read import read_log
from twin.sweep import Sweep

FILES: dict[str, tuple[Callable[[Path], None], str, str, str]] = {
    "MDF": (mdf, ".mf4", "asammdf", "mdf"),
    "TDMS": (partial(tdms, clock=True), ".tdms", "nptdms", "formats"),
    "TDMS without clocks": (partial(tdms, clock=False), ".tdms", "nptdms", "formats"),
    "BLF": (bus, ".blf", "can", "bench"),
    "ASC": (bus, ".asc", "can", "bench"),
    "TRC": (bus, ".trc", "can", "bench"),
    "candump": (bus, ".log", "can", "bench"),
}
BUSES = ("BLF", "ASC", "TRC", "candump")
SPEED_DEG_S = 50.0


def written(name: str, folder: Path) -> Path:
    make, ending, library, _ = FILES[name]
    pytest.importorskip(library)
    path = folder / f"log{ending}"
    make(path)
    return path


def off_deg(found: np.ndarray, true: np.ndarray) -> float:
    return float(np.nanmax(np.abs((found - true + 180.0) % 360.0 - 180.0)))


@pytest.mark.parametrize("name", ["MDF", "TDMS", "TDMS without clocks"])
def test_a_measurement_is_read_to_the_same_sweep(name: str, tmp_path: Path) -> None:
    path = written(name, tmp_path)
    log = read_log(path)
    assert off_deg(log.columns["reference_deg"], REFERENCE_DEG) < 1e-9
    assert off_deg(log.columns["measured_deg"], MEASURED_DEG) < 1e-9
    if name != "TDMS without clocks":
        np.testing.assert_allclose(log.columns["time_s"], TIME_S, atol=1e-9)
    assert ("remark" in " ".join(log.table.left)) == name.startswith("TDMS")
    again = Sweep.read(path, columns=log.guess.text)
    assert all(np.array_equal(again.columns[key], values) for key, values in log.columns.items())


@pytest.mark.parametrize("name", BUSES)
def test_a_bus_log_is_read_by_the_dbc_beside_it(name: str, tmp_path: Path) -> None:
    """At the times of the bench's frames, the sensor between its own: to a count, and to its error over one step."""
    path = written(name, tmp_path)
    log = read_log(path)
    sensor_at_bench = MEASURED_DEG - SPEED_DEG_S * LATE_S
    assert off_deg(log.columns["reference_deg"], REFERENCE_DEG) < 6e-4
    assert off_deg(log.columns["measured_deg"], sensor_at_bench) < 0.01
    assert np.nanmax(np.abs(log.columns["temperature_c"] - TEMPERATURE_C)) < 0.02
    np.testing.assert_allclose(np.diff(log.columns["time_s"]), 0.05, atol=2e-4)
    assert "interpolated to the times of Bench.stage_angle [deg]" in "; ".join(log.table.notes)
    assert "frames 0x7ab (not in log.dbc)" in log.table.left
    # The first row lies before the sensor's first frame, three where its angle begins anew.
    assert len(Sweep.read(path, columns=log.guess.text)) == ROWS - 1 - int(np.sum(np.diff(MEASURED_DEG) < 0.0))


def test_channels_of_two_clocks_are_brought_to_one(tmp_path: Path) -> None:
    pytest.importorskip("asammdf")
    mdf(tmp_path / "log.mf4", late_s=0.02)
    log = read_log(tmp_path / "log.mf4")
    turned = SPEED_DEG_S * 0.02
    # The sensor's error, of 0.8 deg, is not the same a degree later.
    assert off_deg(log.columns["measured_deg"], MEASURED_DEG - turned) < 0.8 * np.radians(turned) + 1e-4
    assert "hall_angle [rad], die_temperature [°C]: interpolated" in log.table.notes[0]


def test_in_a_gap_and_where_an_angle_begins_anew_nothing_is_made_up() -> None:
    slow = Channel("ref [deg]", np.arange(10.0), 10.0 * np.arange(10.0))
    fine_s = np.concatenate([np.arange(0.05, 4.0, 0.1), np.arange(6.05, 9.5, 0.1)])
    fine = Channel("sensor [deg]", fine_s, (20.0 + 40.0 * fine_s) % 360.0)
    table = on_one_clock([slow, fine], file="log")
    assert table.names == ("time [s]", "ref [deg]", "sensor [deg]")
    missing = np.isnan(table.values[2])
    # Before the first sample at 0, and in the gap at 4 (after 3.95) to 6; it begins anew between 8.45 and 8.55.
    assert list(np.flatnonzero(missing)) == [0, 4, 5, 6]
    np.testing.assert_allclose(table.values[2][~missing], (20.0 + 40.0 * np.arange(10.0)[~missing]) % 360.0, atol=1e-9)


def test_where_an_angle_begins_anew_the_cell_is_missing() -> None:
    slow = Channel("ref [deg]", np.arange(0.0, 9.0, 0.7), 40.0 * np.arange(0.0, 9.0, 0.7))
    fine_s = np.arange(0.05, 9.0, 0.1)
    fine = Channel("sensor [deg]", fine_s, (20.0 + 40.0 * fine_s + 4.0) % 360.0)
    # It begins anew at 8.4, between its samples at 8.35 and 8.45, where the reference has its last sample.
    found = on_one_clock([slow, fine], file="log").values[2]
    assert list(np.flatnonzero(np.isnan(found))) == [0, 12]


def test_frames_that_cannot_be_read_are_told(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """In the line of what is not used, and not by the library on standard error."""
    path = written("TRC", tmp_path)
    lines = path.read_text().splitlines()
    broken = [k for k, line in enumerate(lines) if " 0101 " in line][40:43]
    for k in broken:
        lines[k] = lines[k].partition(" 0101 ")[0]
    path.write_text("\n".join(lines))
    capfd.readouterr()
    left = read_log(path).table.left
    assert any(one.startswith("3 places of the file (") for one in left)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("number", [0, 2])
def test_a_bus_log_without_its_dbc_says_what_is_missing(number: int, tmp_path: Path) -> None:
    path = written("ASC", tmp_path)
    dbc = path.with_suffix(".dbc")
    for k in range(number):
        (tmp_path / f"other{k}.dbc").write_text(dbc.read_text())
    dbc.unlink()
    ended = halltwin("import", path)
    assert ended.code == 2
    assert f"holds frames of a bus, and {number} .dbc files lie beside it" in ended.err
    assert "put it there as log.dbc" in ended.err


def test_the_only_dbc_of_the_folder_is_taken(tmp_path: Path) -> None:
    path = written("candump", tmp_path)
    path.with_suffix(".dbc").rename(tmp_path / "bench.dbc")
    assert "measured_deg" in read_log(path).columns


def test_a_dbc_of_another_bus_is_refused(tmp_path: Path) -> None:
    path = written("candump", tmp_path)
    dbc = path.with_suffix(".dbc")
    dbc.write_text(dbc.read_text().replace("BO_ 256", "BO_ 512").replace("BO_ 257", "BO_ 513"))
    with pytest.raises(SweepError, match=r"log\.dbc knows none of its frames"):
        read_log(path)


@pytest.mark.parametrize("name", ["MDF", "TDMS", "BLF", "ASC"])
def test_a_missing_library_is_named_with_its_extra(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, own = written(name, tmp_path), builtins.__import__
    _, _, library, extra = FILES[name]

    def lacking(wanted: str, *rest: Any, **named: Any) -> Any:
        if wanted.split(".")[0] == library:
            raise ImportError(f"No module named {library!r}", name=library)
        return own(wanted, *rest, **named)

    monkeypatch.setattr(builtins, "__import__", lacking)
    ended = halltwin("import", path)
    assert ended.code == 2
    assert f"needs {library}; pip install '.[{extra}]' in the checkout" in ended.err
    assert ended.err.count("\n") == 1


@pytest.mark.filterwarnings("error::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("name", ["MDF", "TDMS", "BLF"])
def test_a_damaged_file_is_one_line(name: str, tmp_path: Path) -> None:
    path = written(name, tmp_path)
    path.write_bytes(path.read_bytes()[:200])
    ended = halltwin("import", path)
    assert ended.code == 2
    assert ended.err.count("\n") == 1
