"""What compensate and spinning print: what became of the readings, and figures to the digits that mean something."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

from diagnosis.correction.compensation import correction_of
from diagnosis.correction.cross_validation import BeforeAfter
from diagnosis.report.wording import decimals_of, rms_shown
from scenarios.commands.compensate_text import MadeOf, show
from scenarios.commands.spinning import _stated
from tests.command_line import halltwin
from twin.chain import Chain
from twin.motion import Motion
from twin.sweep import Sweep


def a_sweep() -> Sweep:
    """One turn of 120 readings, without channels."""
    sensor = Chain().with_effect("offset", x_percent=0.8).with_effect("noise", rms_deg=0.02)
    made = sensor.simulate(Motion.from_angle(np.radians(np.arange(0.0, 360.0, 3.0))), seed=1)
    return Sweep.from_columns({"reference_deg": made.reference_deg, "measured_deg": made.measured_deg})


@pytest.fixture
def with_garbage(tmp_path: Path) -> Path:
    """A sweep with two gross errors and a row that cannot be read."""
    sweep = a_sweep()
    sweep.measured_deg[[10, 50]] += 90.0
    path = tmp_path / "garbage.csv"
    sweep.write(path)
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[-1] = re.sub(",.*", ",", lines[-1])
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def table(path: Path, out: Path) -> np.ndarray:
    halltwin("compensate", path, "--table", out)
    return np.loadtxt(out, delimiter=",", skiprows=1)


def test_rows_set_aside_are_counted_and_the_table_is_made_without_them(with_garbage: Path, tmp_path: Path) -> None:
    ended = halltwin("compensate", with_garbage)
    words = " ".join(ended.out.split())
    assert "garbage.csv 120 readings; 1 rejected (row 120: measured_deg missing or not finite)" in words
    assert "2 gross errors set aside (rows 11, 51); 117 fitted" in words
    told = dict(re.findall(r"(on held-out blocks|without the 2 set aside) +\S+ -> (\S+) ", words))
    # Two of 119 readings are off by 90 deg: 90 sqrt(2/119) = 11.7 deg RMS; the others by their noise of 0.02 deg.
    assert float(told["on held-out blocks"]) == pytest.approx(11.7, rel=0.05)
    assert float(told["without the 2 set aside"]) < 0.03
    clean = tmp_path / "clean.csv"
    a_sweep().write(clean)
    assert "120 readings; all fitted" in halltwin("compensate", clean).out
    # Three readings fewer move a correction of noise 0.02 deg by about 0.02 sqrt(3)/sqrt(120), 0.003 deg.
    differ = table(with_garbage, tmp_path / "a.csv") - table(clean, tmp_path / "b.csv")
    assert np.max(np.abs(differ)) < 0.02


def test_rejected_rows_of_the_sweeps_that_it_is_checked_on_are_told(with_garbage: Path, tmp_path: Path) -> None:
    clean = tmp_path / "clean.csv"
    a_sweep().write(clean)
    ended = halltwin("compensate", clean, "--check", with_garbage)
    assert "garbage.csv: 120 readings; 1 rejected (row 120:" in " ".join(ended.out.split())


@pytest.mark.parametrize("width", [30, 40, 60, 80, 160])
def test_no_name_and_no_figure_is_cut(width: int) -> None:
    found = BeforeAfter(np.full(200, 0.01), np.full(200, 1e-4))
    out = io.StringIO()
    made_of = MadeOf("a_long_name_of_a_recording.csv", "200 readings; all fitted", 1e-3)
    rows = [("on a_long_name_of_another_recording.csv", found), ("  each turn's own zero taken out", found)]
    show(made_of, correction_of(Chain()), rows, Console(file=out, width=width, highlight=False))
    text = out.getvalue()
    assert max(map(len, text.splitlines())) <= width
    assert "…" not in text
    words = "".join(text.split())
    for part in ("ona_long_name_of_another_recording.csv", "0.573->0.00573", "0.5730->0.0057", "zerotakenout"):
        assert part in words


@pytest.mark.parametrize(("readings", "shown"), [(8, "0.12"), (49, "0.12"), (50, "0.123"), (10**6, "0.123")])
def test_an_rms_is_told_to_the_digits_that_so_many_readings_know(readings: int, shown: str) -> None:
    """To two digits of 1/sqrt(2 n) of itself, a tenth at fifty readings; at most the three that all commands tell."""
    assert rms_shown(0.12345, readings) == shown


@pytest.mark.parametrize(
    ("uncertainty", "decimals"), [(0.02, 3), (0.0999999, 2), (1.5e-3, 4), (3.0, 1), (40.0, 0), (500.0, 0), (0.0, 7)]
)
def test_decimals_are_those_of_two_digits_of_the_uncertainty(uncertainty: float, decimals: int) -> None:
    assert decimals_of(uncertainty) == decimals


def test_spinning_tells_two_digits_of_what_it_knows(tmp_path: Path) -> None:
    told = halltwin("spinning", "-o", tmp_path / "s").out
    # Of a plate of 1000 uV at 100 uV/mT, of which 2e-3 differ between the phases, and an amplifier of 500 uV.
    assert "offset before 15 mT, after 0.010 mT: 1500 times smaller" in told
    assert re.search(r"corner without spinning: \d+0 ±\d\d0 Hz", told)
    assert re.search(r"corner with spinning: below \d\d Hz", told)
    frequencies = np.array([97.0, 194.0])
    assert _stated(5084.7, 147.8, frequencies) == "5080 ±290 Hz"
    assert _stated(50847.0, 1478.0, frequencies) == "50800 ±2900 Hz"
    assert _stated(150.47, 1.478, frequencies) == "150.5 ±2.9 Hz"
    assert _stated(90.0, 1.0, frequencies) == "below 97 Hz"
