"""The radius has a scale of its own: it is worked out for the rows in use, not for every fit to them."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from tests.diagnosis.discovery.sweeps import Made, before


def test_it_is_worked_out_once_for_the_rows_in_use(monkeypatch: pytest.MonkeyPatch) -> None:
    fit = before(held_out_selection, Made(points=120, channels=True)).fit
    asked: list[int] = []
    plain = np.linalg.pinv
    monkeypatch.setattr(np.linalg, "pinv", lambda *given: asked.append(1) or plain(*given))
    other = fit.observations.masked(np.arange(len(fit.observations)) > 0)
    for _ in range(2):
        evaluate(fit.chain, fit.free, other, fit.weighting)
        assert len(asked) == 1
