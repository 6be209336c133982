"""The picture over the air gap: its points are the sweeps' factors, its curve runs where the fit expects them."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import Mounting, diagnose_many
from diagnosis.factors.gap_model import ROWS
from tests.diagnosis.factors.gap_sweeps import CASES
from twin.baseline import FACTORS


def test_curves_run_where_the_fit_expects_the_factors() -> None:
    """Between its 61 points the curve is drawn straight, which is off by less than 2e-3 of its range."""
    pytest.importorskip("matplotlib")
    rng, gaps = np.random.default_rng(0), (1.0, 2.0, 3.0)
    truth = CASES["sensor and tilted magnet"][0]
    found = diagnose_many([truth.sweep(gap, rng) for gap in gaps], output_sense=1, mounting=Mounting(air_gap_mm=gaps))
    fit = found.air_gap_fit
    assert fit is not None
    axes = [axis for axis in found.plot().axes if axis.get_xlabel() == "air gap [mm]"]
    assert [axis.get_ylabel().split(" [")[0] for axis in axes] == [FACTORS[row].label for row in ROWS]
    for k, (axis, row) in enumerate(zip(axes, ROWS, strict=True)):
        scale = FACTORS[row].per_coordinate
        points, curve = axis.lines[0], axis.lines[-1]
        measured = scale * np.array([one.findings.fit.point[row] for one in found])
        np.testing.assert_allclose(points.get_ydata(), measured)
        drawn = np.interp(fit.told.gap_mm, curve.get_xdata(), curve.get_ydata())
        expected = measured - scale * fit.told.differences[:, k]
        np.testing.assert_allclose(drawn, expected, atol=2e-3 * float(np.ptp(curve.get_ydata())))
        assert "sensor, magnet tilt" in curve.get_label()


def test_one_gap_has_no_such_picture() -> None:
    pytest.importorskip("matplotlib")
    sweep = CASES["sensor"][0].sweep(1.0, np.random.default_rng(0))
    axes = diagnose_many([sweep, sweep], mounting=Mounting()).plot().axes
    assert not [axis for axis in axes if axis.get_xlabel() == "air gap [mm]"]
