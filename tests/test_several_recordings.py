"""Three recordings of one device part what a single sweep cannot: a small part of the study beside this file."""

from __future__ import annotations

import pytest

from diagnosis import explain
from tests.several_recordings import KINDS, devices, judged


@pytest.mark.parametrize("kind", ["eccentric reference", "magnet's fourth harmonic"])
def test_what_one_sweep_leaves_open_is_parted(kind: str) -> None:
    """By the sensor's turn beside another gap; by the gap: a saturation grows where a harmonic dies away."""
    truth, sweeps = next((truth, sweeps) for _, name, truth, sweeps in devices(1, seed=11) if name == kind)
    assert truth == KINDS[kind][0]
    assert judged(explain(sweeps), truth) == "right"
