"""What ``halltwin diagnose`` prints: all that its JSON says, in lines that fit the terminal, one name a factor."""

from __future__ import annotations

import functools
import re

import numpy as np
import pytest

from diagnosis import Diagnoses, diagnose_many
from diagnosis.report.diagnose_text import text
from diagnosis.report.factor_names import LABELS, SCALES
from diagnosis.report.wording import figure
from twin.chain import Chain
from twin.motion import Motion

OLD_NAMES = re.compile(r"V[xy]/A[xy]|V[xy]_over_A[xy]|\bbeta\b|\bquad\b|_percent")


@functools.cache
def sweeps() -> Diagnoses:
    """Three sweeps of one sensor, one of them with two gross errors."""
    sensor = (
        Chain()
        .with_effect("offset", x_percent=0.8, y_percent=-0.5)
        .with_effect("gain_mismatch", ratio=1.01)
        .with_effect("noise", rms_deg=0.02)
    )
    made = [sensor.simulate(Motion.from_angle(np.radians(np.arange(0.0, 360.0, 3.0))), seed=seed) for seed in range(3)]
    made[0].measured_deg[[10, 50]] += 90.0
    return diagnose_many(made)


@pytest.mark.parametrize("width", [40, 72, 80, 100, 160])
def test_one_sweep_fits_the_terminal_and_says_what_the_json_says(width: int) -> None:
    one = sweeps()[0]
    answer = one.to_dict()["sweeps"][0]
    shown = one.summary(width)
    assert max(map(len, shown.splitlines())) <= width
    words = " ".join(shown.split())
    assert "120 readings; 2 gross errors set aside (rows 11, 51); 118 fitted" in words
    for key, label in LABELS.items():
        value, _ = figure(answer["parameters"][key], SCALES[key])
        assert f"{label} {value} " in words
    for sentence in answer["sentences"]:
        assert " ".join(sentence.split()) in words
    assert not OLD_NAMES.search(words)


@pytest.mark.parametrize(("width", "intervals"), [(80, False), (160, True)])
def test_many_sweeps_have_a_line_each_with_intervals_where_there_is_room(width: int, intervals: bool) -> None:
    lines = sweeps().summary(width).splitlines()
    assert [line.split()[0] for line in lines[2:5]] == ["simulated"] * 3
    assert "2 gross errors in simulated" in " ".join(" ".join(lines[5:]).split())
    assert max(map(len, lines)) <= width
    assert lines[0].split() == ["sweep", "rows", "offset", "offset", "gain", "phase", "quadratic", "RMS", "before"]
    assert lines[1].split() == ["x,", "%", "y,", "%", "ratio", "deg", "term,", "%", "deg", "deg"]
    assert not OLD_NAMES.search(lines[0])
    for line, sweep in zip(lines[2:5], sweeps().to_dict()["sweeps"], strict=True):
        for key in list(LABELS)[:5]:
            value, half = figure(sweep["parameters"][key], SCALES[key])
            assert f" {value}" in line
            assert (half in line) == intervals


def test_a_long_name_keeps_its_end() -> None:
    answer = sweeps().to_dict()
    for number, sweep in enumerate(answer["sweeps"]):
        sweep["sweep"] = f"a_recording_of_a_device_in_the_oven_{number:03d}.csv"
    lines = text(answer, width=80).splitlines()
    assert max(map(len, lines)) <= 80
    assert [re.match(r"…\S*_(\d+)\.csv ", line)[1] for line in lines[2:5]] == ["000", "001", "002"]  # type: ignore[index]


def test_an_open_end_of_an_interval_is_said_to_be_open() -> None:
    answer = sweeps()[1].to_dict()
    answer["sweeps"][0]["parameters"]["quad"] |= {"low": None, "high": None}
    shown = text(answer, width=80)
    assert "open .. open" in shown
    assert "None" not in shown
    assert "nan" not in shown
