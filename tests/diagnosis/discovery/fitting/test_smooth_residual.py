"""Residuals that are smooth from row to row, as the baseline leaves them of a part of a turn: an answer follows."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import explain
from twin.chain import Chain
from twin.motion import Motion


@pytest.mark.parametrize("span_deg", [90.0, 180.0, 270.0])
def test_a_part_of_a_turn_in_hardly_any_noise_is_answered(span_deg: float) -> None:
    """The deviation from the neighbours' median is nearly zero there, and says nothing of the noise."""
    motion = Motion.from_angle(np.radians(np.linspace(0.0, span_deg, 181)))
    device = Chain().with_effect("saturation", k_percent=2.0).with_effect("noise", rms_deg=0.002)
    for seed in range(2):
        answer = explain(device.simulate(motion, seed=seed)).to_dict()
        assert np.isfinite(answer["twin"]["effects"]["noise"]["rms_deg"])
