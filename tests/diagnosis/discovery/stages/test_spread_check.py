"""Spread check: a noise that is louder at some angles stays named only where the proven causes leave it so."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from diagnosis import explain
from diagnosis.discovery.stages.spread import spread
from diagnosis.discovery.stages.spread_check import spread_check
from tests.diagnosis.discovery.spreads import Loud, handed
from tests.diagnosis.discovery.sweeps import noise, with_residual
from tests.hidden.physics.generator import draw

JITTER = "reference_jitter"


def test_what_the_readings_bear_out_stays() -> None:
    state = spread(handed(spread, Loud(jitter_percent=0.05)))
    assert [finding.keys for finding in state.findings] == [(JITTER,)]
    assert spread_check(state) is state


def test_what_the_proven_causes_do_not_leave_goes_and_the_rows_are_alike() -> None:
    """As where it was judged beside causes that the proof has taken out since."""
    state = spread(handed(spread, Loud(jitter_percent=0.05)))
    even = with_residual(state, noise(len(state.sweep)))
    assert np.ptp(even.fit.observations.scale) > 0.0
    after = spread_check(even)
    assert after.findings == ()
    assert JITTER not in after.fit.chain.values
    assert np.ptp(after.fit.observations.scale / after.fit.observations.level) == 0.0


def test_nothing_named_is_nothing_to_judge() -> None:
    state = handed(spread, Loud(jitter_percent=0.05))
    assert spread_check(state) is state


def test_beside_lines_that_the_proof_takes_out_again(tmp_path: Path) -> None:
    """Two plates whose sensitivities fall with the heat, by powers; a search takes up lines that no proof keeps."""
    path = tmp_path / "oven.csv"
    draw("mobility", seed=198423631).write_csv(path)
    assert [cause["name"] for cause in explain(str(path)).to_dict()["causes"]] == ["gain_drift"]
