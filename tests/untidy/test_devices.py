"""Logs of drives with columns of their own names: VESC Tool's and ODrive's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.untidy.generator import MEASURED_DEG, REFERENCE_DEG, ROWS, TIME_S, table
from twin.logs.read import read_log
from twin.sweep import Sweep

VESC = (
    "ms_today;input_voltage;temp_mos_max;temp_motor;current_motor;current_in;erpm;duty_cycle;tachometer;tachometer_abs;"
    "encoder_position;fault_code;vesc_id;roll;pitch;yaw"
)


def off_deg(found: np.ndarray, true: np.ndarray) -> float:
    """The largest difference, up to a zero."""
    off = (found - true + 180.0) % 360.0 - 180.0
    return float(np.max(np.abs((off - np.median(off) + 180.0) % 360.0 - 180.0)))


@pytest.mark.parametrize("pairs", [4, 7, 15])
def test_a_log_of_vesc_tool_is_read(pairs: int, tmp_path: Path) -> None:
    """Lines end with the separator; the tachometer counts six steps in each turn of the field."""
    tachometer = np.floor(REFERENCE_DEG * 6 * pairs / 360.0)
    rows = [
        f"{80_000_000 + 50 * k};55.3;24;26.9;{0.1 * k:.1f};0;0;0;{tachometer[k]:.0f};{tachometer[k] + 9e4:.0f};"
        f"{MEASURED_DEG[k]:.2f};0;1;0;0;{k % 90};"
        for k in range(ROWS)
    ]
    path = tmp_path / "log.csv"
    path.write_text("\n".join([f"{VESC};", *rows, ""]))
    log = read_log(path)
    assert f"reference_deg=tachometer*360/{6 * pairs}, measured_deg=encoder_position," in log.guess.text
    assert off_deg(log.columns["reference_deg"], REFERENCE_DEG) <= 60.0 / pairs
    assert off_deg(log.columns["measured_deg"], MEASURED_DEG) <= 0.011
    np.testing.assert_allclose(np.diff(log.columns["time_s"]), 0.05, atol=1e-6)
    assert "tachometer_abs" in log.guess.unused


def test_a_log_of_odrive_is_read(tmp_path: Path) -> None:
    """Positions in turns; the encoder's counts are the sensor, the set point the reference."""
    columns = {
        "time": TIME_S,
        "axis0.controller.pos_setpoint": REFERENCE_DEG / 360.0,
        "axis0.encoder.count_in_cpr": np.round(MEASURED_DEG * 8192 / 360.0) % 8192,
        "axis0.encoder.vel_estimate": 0.1 + 0.0 * TIME_S,
    }
    path = tmp_path / "log.csv"
    path.write_text(table(columns, digits=7))
    log = read_log(path)
    assert "axis0.controller.pos_setpoint:rev" in log.guess.text
    assert "axis0.encoder.count_in_cpr*360/8192" in log.guess.text
    assert off_deg(log.columns["reference_deg"], REFERENCE_DEG) < 1e-4
    assert off_deg(log.columns["measured_deg"], MEASURED_DEG) <= 0.05
    assert len(Sweep.read(path, columns=log.guess.text)) == ROWS


def test_the_phase_of_odrive_is_an_electrical_angle(tmp_path: Path) -> None:
    phase = (np.radians(7.0 * MEASURED_DEG) + np.pi) % (2.0 * np.pi) - np.pi
    columns = {"axis0.encoder.phase": phase, "axis1.encoder.pos_estimate": REFERENCE_DEG / 360.0}
    path = tmp_path / "log.csv"
    path.write_text(table(columns, digits=7))
    # Which of both is the sensor is said: the statement for the other way round is told with it.
    text = "reference_deg=axis1.encoder.pos_estimate:rev, measured_deg=unwrap(axis0.encoder.phase:rad)/7"
    assert off_deg(Sweep.read(path, columns=text).measured_deg, MEASURED_DEG) < 1e-4
