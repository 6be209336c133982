"""What has no name is told with the sign that the readings show, whichever way the sensor counts."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast
from unittest.mock import patch

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.fitting.joint_fit import Fit
from diagnosis.report.as_read import as_read, phase_at_first_row, values_as_read
from tests.diagnosis.discovery.test_forms import channels, sweep, turns
from twin.catalogue import find

HEIGHT_DEG, CENTRE_DEG, NOISE_DEG = 0.4, 137.0, 0.02


@pytest.mark.parametrize("sense", [1, -1])
def test_a_bump_of_the_error_is_a_bump(sense: int) -> None:
    """The channels tell that the output counts against their angle; the error's bump is up all the same.

    Ten readings lie on the bump: its height is known to about the noise over their root, of which three are allowed.
    """
    shaft = turns(200, 2)
    away = np.mod(np.degrees(shaft) - CENTRE_DEG + 180.0, 360.0) - 180.0
    turned = shaft + np.radians(HEIGHT_DEG * np.exp(-0.5 * (away / 5.0) ** 2))
    signal = channels(turned)
    frame = sweep(shaft, signal, 23)
    frame["vx"], frame["vy"] = signal[0], sense * signal[1]
    answer = explain(frame).to_dict()
    assert answer["senses"]["output"] == sense
    (cause,) = answer["causes"]
    assert cause["name"] == "unnamed"
    height = cause["parameters"]["height_deg"]
    assert height["value"] == pytest.approx(HEIGHT_DEG, abs=3.0 * NOISE_DEG / np.sqrt(10.0))
    assert height["low"] < height["value"] < height["high"]
    (structure,) = answer["unexplained"]["structure"]
    assert structure["height_deg"] == pytest.approx(height["value"], rel=1e-6)


def test_of_a_wave_the_phase_turns() -> None:
    wave = find("unnamed_order")
    figures = {
        "order": {"value": 11.0, "low": 11.0, "high": 11.0},
        "amplitude_deg": {"value": 0.2, "low": 0.1, "high": 0.3},
        "phase_deg": {"value": 30.0, "low": 20.0, "high": 45.0},
    }
    read = as_read(wave, figures, output_sense=-1)
    assert read["phase_deg"] == {"value": -150.0, "low": -160.0, "high": -135.0}
    assert {name: read[name] for name in ("order", "amplitude_deg")} == {
        name: figures[name] for name in ("order", "amplitude_deg")
    }
    assert as_read(wave, figures, output_sense=1) == figures


def test_what_acts_elsewhere_stays() -> None:
    """A harmonic of the magnet turns the field, which every chain counts with the shaft."""
    values = {"order": 4.0, "amplitude_deg": 0.2, "phase_deg": 30.0}
    assert values_as_read(find("magnet_harmonic"), values, output_sense=-1) == values


def test_the_interval_as_named_turns_with_the_figure() -> None:
    """Of a wave in time told at the first row, and of one that the output counts backwards."""
    figure = {"value": 100.0, "low": 80.0, "high": 120.0, "as_named": [95.0, 105.0]}
    fit = SimpleNamespace(observations=SimpleNamespace(motion=SimpleNamespace(time_s=np.array([0.0, 2.0]))))
    with patch("diagnosis.report.as_read.quantile_95", return_value=2.0):
        told = phase_at_first_row(cast("Fit", fit), figure, frequency_Hz=0.1, deviation_Hz=0.01)
    # Half of the record lies 36 deg behind; the frequency's own part is 360 deg/s x 1 s x 2 x 0.01.
    assert told["value"] == pytest.approx(64.0)
    assert told["as_named"] == pytest.approx([64.0 - np.hypot(5.0, 7.2), 64.0 + np.hypot(5.0, 7.2)])
    assert [told["low"], told["high"]] == pytest.approx([64.0 - np.hypot(20.0, 7.2), 64.0 + np.hypot(20.0, 7.2)])
    own = {"value": 30.0, "low": 20.0, "high": 45.0, "as_named": [25.0, 35.0]}
    wave = {"order": {"value": 11.0, "low": 11.0, "high": 11.0}, "amplitude_deg": {**own, "value": 0.2}}
    backwards = as_read(find("unnamed_order"), {**wave, "phase_deg": own}, output_sense=-1)
    assert backwards["phase_deg"]["as_named"] == [-155.0, -145.0]
