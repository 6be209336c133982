"""Millimetres and millitesla belong to the user's own magnet, at the gap that is stated or that amplitudes tell."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis import Mounting, diagnose, diagnose_many
from tests.diagnosis.factors.gap_sweeps import Truth
from twin.chain import Chain
from twin.errors import UserError
from twin.magnet.assembly import Assembly
from twin.magnet.magnet import Magnet
from twin.magnet.placement import Placement

WIDE = Magnet(diameter_mm=12.0, height_mm=4.0, remanence_T=1.21)


def test_field_and_gaps_are_those_of_magpylib() -> None:
    truth = Truth(diameter_mm=12.0, height_mm=4.0)
    gaps = np.array([2.0, 1.0, 3.5])
    strength = np.array([truth.field_mT(np.zeros(1), gap)[0, 0] for gap in gaps])
    mounting = Mounting(magnet=WIDE, air_gap_mm=(2.0,))
    np.testing.assert_allclose(mounting.field_mT(gaps), strength, rtol=1e-6)
    np.testing.assert_allclose(mounting.gaps_by_amplitude(list(7.0 * strength)), gaps, atol=1e-3)


@pytest.mark.parametrize("how", ["mounting", "twin"])
def test_equivalents_are_counted_for_the_magnet_given(how: str) -> None:
    """A sensor 0.5 mm off the axis of a magnet of 12 mm: of one of 6 mm it would be another displacement."""
    truth = Truth(sensor=0.5 * np.exp(1j * np.radians(30.0)), stray=0.4 - 0.2j, diameter_mm=12.0, height_mm=4.0)
    columns = truth.sweep(2.0, np.random.default_rng(0))
    assembly = Assembly(magnet=WIDE, placement=Placement(air_gap_mm=2.0))
    known = (
        {"mounting": Mounting(magnet=WIDE, air_gap_mm=(2.0,))}
        if how == "mounting"
        else {"twin": Chain(magnet=assembly)}
    )
    found = diagnose(columns, **known).findings.mechanical  # type: ignore[arg-type]
    assert found.off_axis_low_mm is not None
    assert found.off_axis_high_mm is not None
    assert found.off_axis_low_mm < 0.5 < found.off_axis_high_mm
    assert found.off_axis_high_mm - found.off_axis_low_mm < 0.1
    assert found.off_axis_direction_deg == pytest.approx(30.0, abs=2.0)
    assert found.stray_x_mT == pytest.approx(0.4, abs=2.0 * found.stray_x_half_mT)
    assert found.stray_y_mT == pytest.approx(-0.2, abs=2.0 * found.stray_y_half_mT)
    assert found.magnet == "a cylinder of 12 mm x 4 mm"
    assert not found.assumed
    other = diagnose(columns).findings.mechanical
    assert other.assumed
    assert other.off_axis_mm is not None
    assert abs(other.off_axis_mm - 0.5) > 0.1


def test_the_interval_of_a_displacement_holds_what_the_gap_leaves_open() -> None:
    """The same sweep, with the gap stated 0.1 mm off, which is twice its stated uncertainty or half of a larger one."""
    columns = Truth(sensor=0.6 + 0.3j).sweep(1.0, np.random.default_rng(0))
    true = abs(0.6 + 0.3j)
    narrow, wide = (
        diagnose(columns, mounting=Mounting(air_gap_mm=(1.1,), gap_error_mm=error)).findings.mechanical
        for error in (0.001, 0.2)
    )
    assert narrow.off_axis_high_mm is not None
    assert narrow.off_axis_high_mm < true
    assert wide.off_axis_low_mm is not None
    assert wide.off_axis_low_mm < true < (wide.off_axis_high_mm or np.inf)


def test_each_sweep_is_counted_at_its_own_gap() -> None:
    rng = np.random.default_rng(0)
    sweeps = [Truth(sensor=0.6 + 0.3j).sweep(gap, rng) for gap in (1.0, 2.5)]
    told = diagnose_many(sweeps, mounting=Mounting(air_gap_mm=(1.0,)))
    stated = diagnose_many(sweeps, mounting=Mounting(air_gap_mm=(1.0, 2.5)))
    for found in (told, stated):
        assert found[1].findings.mechanical.air_gap_mm == pytest.approx(2.5, abs=0.05)
        assert found[1].findings.mechanical.off_axis_mm == pytest.approx(abs(0.6 + 0.3j), abs=0.03)


def test_what_cannot_be_a_mounting_is_refused() -> None:
    with pytest.raises(UserError, match="found no air gap"):
        Mounting(air_gap_mm=())
    with pytest.raises(UserError, match="gap_error_mm is 2 mm"):
        Mounting(air_gap_mm=(1.0,), gap_error_mm=2.0)
    with pytest.raises(UserError, match="air_gap_mm is 0 mm"):
        Mounting(air_gap_mm=(1.0, 0.0))
