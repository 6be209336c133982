"""Effects that may stand beside the causes unseen: what a cause that is there does most of."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np

from diagnosis import explain
from twin.chain import Chain
from twin.motion import Motion

AMPLITUDE, PHASE = 0.3, 40.0
BENCH = Path(__file__).parents[4] / "scenarios" / "data" / "bench_sweep.csv"


@functools.cache
def told(order: int) -> dict[str, Any]:
    """The answer to a harmonic of this order beside a saturation of 1 %."""
    sensor = Chain().with_effect("offset", x_percent=2.0, y_percent=1.0).with_effect("phase", beta_deg=0.8)
    sensor = sensor.with_effect("magnet_harmonic", order=order, amplitude_deg=AMPLITUDE, phase_deg=PHASE)
    sensor = sensor.with_effect("saturation", k_percent=1.0).with_effect("noise", rms_deg=0.02)
    return explain(sensor.simulate(Motion.from_angle(np.radians(np.arange(0.0, 1440.0, 2.0))), seed=1)).to_dict()


def test_a_harmonic_of_order_4_hides_a_saturation_and_its_figures_hold_both() -> None:
    """Alone it takes the saturation's order 4 with its own, which is a third larger then."""
    answer = told(4)
    assert [cause["name"] for cause in answer["causes"]] == ["magnet_harmonic"]
    amplitude = answer["causes"][0]["parameters"]["amplitude_deg"]
    assert amplitude["as_named"][0] > 0.4 > amplitude["low"]
    assert amplitude["low"] < AMPLITUDE < amplitude["high"]
    for name, true in {"Vx_over_Ax": 0.02, "Vy_over_Ay": 0.01, "beta_deg": 0.8}.items():
        factor = answer["extended"]["parameters"][name]
        assert factor["low"] < true < factor["high"], name
    assert answer["extended"]["parameters"]["Vx_over_Ax"]["open_by"] == ["saturation"]


def test_a_harmonic_of_another_order_hides_none() -> None:
    answer = told(5)
    assert {cause["name"] for cause in answer["causes"]} == {"magnet_harmonic", "saturation"}
    assert "as_named" not in answer["causes"][0]["parameters"]["amplitude_deg"]


def test_what_is_improbable_beside_a_cause_widens_its_interval_by_little() -> None:
    """A play of the coupling beside a hysteresis would show by 0.008 deg where it may be 0.12: odds of 1 to 15.

    Of a sum of two normal scatters that share so, the one 7 times as wide, 95 % lie within 1.7 times the narrow one's
    own interval.
    """
    lag = explain(BENCH).to_dict()["causes"][0]["parameters"]["lag_deg"]
    named = lag["as_named"]
    assert 1.2 < (lag["high"] - lag["low"]) / (named[1] - named[0]) < 2.5
