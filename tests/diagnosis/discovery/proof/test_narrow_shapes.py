"""The held-out proof of what is narrower than a block."""

from __future__ import annotations

from pathlib import Path

from diagnosis import explain
from tests.hidden.generator import draw


def test_a_bump_that_one_block_holds_is_proven_on_scattered_readings(tmp_path: Path) -> None:
    """One turn, white noise of 0.02 deg, a bump of 27 sigma: held out as a whole its place would be anyone's guess."""
    hidden = draw([], seed=177007036, bench="easy", structure="local_bump")
    path = tmp_path / "sweep.csv"
    hidden.write_csv(path)
    found = explain(path).discovery
    assert [cause.name for cause in found.causes] == ["unnamed"]
    assert found.causes[0].keys == ("unnamed_bump",)
    # What is left on unseen readings is the noise: its RMS is known to 1/sqrt(2n), five of these.
    noise = float(hidden.truth["floor_deg"])
    assert abs(found.extended_held_deg / noise - 1.0) < 5.0 / (2.0 * len(found.sweep)) ** 0.5
    assert found.baseline_held_deg > 1.2 * found.extended_held_deg
