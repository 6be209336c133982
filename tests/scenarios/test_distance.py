"""The least non-linear distance of a magnet, as ``halltwin design`` answers it."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from scenarios.studies.design.distance import Distance, distance_csv, distances, only_with_field
from scenarios.studies.design.options import demand_of, space_of
from scenarios.studies.design.space import AXES
from scenarios.studies.design.study import DesignStudy
from tests.command_line import halltwin
from twin.chain import Chain
from twin.concentrator.disk import Disk
from twin.files import to_dict
from twin.magnet.assembly import Assembly
from twin.magnet.placement import Placement

ASSEMBLY = Assembly(placement=Placement(air_gap_mm=2.5))
BARE = replace(Chain(), magnet=ASSEMBLY)
"""No effect, and the magnet that the effects' parameters are stated at."""
SATURATION_PERCENT, LAG_DEG = 0.5, 0.05
BENT = BARE.with_effect("saturation", k_percent=SATURATION_PERCENT).with_effect("hysteresis", lag_deg=LAG_DEG)


def study(chain: Chain, *, diameter: str = "6", height: str = "2.5", gaps: str = "0.5:8:0.5") -> DesignStudy:
    axes = dict.fromkeys(AXES, "0") | {"diameter_mm": diameter, "height_mm": height, "air_gap_mm": gaps}
    space = space_of(axes, shape="cylinder", grades=("N35H",), bore_mm=2.0, sampling="grid", count=1, seed=0)
    demand = demand_of(max_error_deg=0.5, window="30:90", temperature="25", tolerance="", mountings=1, min_yield=0.5)
    return DesignStudy(twin=to_dict(chain), space=space, demand=demand, chunk=16, seed=0)


def found(chain: Chain, **axes: str) -> tuple[Distance, ...]:
    chosen = study(chain, **axes)
    table, grades = chosen.space.table()
    return distances(chosen, table, grades.astype(int))


def test_the_least_is_where_saturation_and_hysteresis_balance() -> None:
    """Saturation errs by a b^2, a = k/4, hysteresis by l / b, with b the field against the stated one.

    Both ways their sum is largest where they add up; it is least at b^3 = l / 2a. To 2 %: a is the leading term, and
    the distances are 0.019 mm apart.
    """
    (one,) = found(BENT)
    amplitude_deg = np.degrees(0.01 * SATURATION_PERCENT / 4.0)
    b = np.cbrt(LAG_DEG / (2.0 * amplitude_deg))
    assert one.field_mT[one.least] == pytest.approx(b * ASSEMBLY.nominal_mT, rel=0.02)
    assert one.error_deg[one.least] == pytest.approx(amplitude_deg * b**2 + LAG_DEG / b, rel=0.02)
    assert one.at_end is None
    low, high = one.near_mm
    assert low < one.air_gap_mm[one.least] < high
    near = (one.air_gap_mm >= low) & (one.air_gap_mm <= high)
    assert np.array_equal(near, one.error_deg <= 1.1 * one.error_deg.min())


def test_another_magnet_has_another_distance_for_the_same_field() -> None:
    small, large = found(BENT, diameter="5,8")
    assert large.air_gap_mm[large.least] > small.air_gap_mm[small.least] + 0.3
    # The distances are a step of 0.019 mm apart, over which the field changes by less than 1.5 %.
    assert large.field_mT[large.least] == pytest.approx(small.field_mT[small.least], rel=0.03)


def test_what_does_not_depend_on_the_field_counts_for_nothing() -> None:
    much = BENT.with_effect("gain_mismatch", ratio=1.1).with_effect("phase", beta_deg=2.0)
    much = much.with_effect("adc_quantisation", bits=8).with_effect("noise", rms_deg=0.5)
    assert set(only_with_field(much).values) == {"saturation", "hysteresis"}
    (plain,), (loaded,) = found(BENT), found(much)
    np.testing.assert_array_equal(plain.error_deg, loaded.error_deg)
    assert set(loaded.causes_deg) == {"saturation", "hysteresis"}


def test_a_saturating_disk_counts_and_its_shift_does_not() -> None:
    """A disk with the saturation that an amplitude of 60 mT loses half a percent by, beside the effect that says so.

    The next term of its curve is two fifths of a percent of the first at 60 mT, and goes with the fourth power.
    """
    level = ASSEMBLY.nominal_mT / np.sqrt(3.0 * 0.01 * SATURATION_PERCENT)
    bent = BARE.with_effect("hysteresis", lag_deg=LAG_DEG)
    disk = Disk(saturation_mT=float(level))
    (said,) = found(BENT)
    (plain,) = found(replace(bent, parts=replace(bent.parts, disk=disk)))
    (shifted,) = found(replace(bent, parts=replace(bent.parts, disk=replace(disk, shift_x_um=3.0, shift_y_um=2.0))))
    assert plain.field_mT[plain.least] == pytest.approx(said.field_mT[said.least], rel=0.03)
    assert plain.error_deg[plain.least] == pytest.approx(said.error_deg[said.least], rel=0.03)
    np.testing.assert_allclose(shifted.error_deg, plain.error_deg, rtol=1e-9)
    assert set(plain.causes_deg) == {"disk", "hysteresis"}


def test_a_displaced_sensor_has_the_distance_of_a_centred_one() -> None:
    aside = replace(BENT, magnet=Assembly(placement=Placement(air_gap_mm=2.5, sensor_x_mm=0.5)))
    (plain,), (moved,) = found(BENT), found(aside)
    np.testing.assert_allclose(plain.error_deg, moved.error_deg, rtol=1e-9)


def test_each_magnet_is_asked_about_once_and_a_twin_without_such_effects_has_none() -> None:
    assert [one.name for one in found(BENT, diameter="5,8", gaps="1,2,3")] == ["N35H 5 x 2.5 mm", "N35H 8 x 2.5 mm"]
    assert found(BARE.with_effect("phase", beta_deg=1.0)) == ()


def test_an_end_of_the_distances_is_said_to_be_one() -> None:
    (one,) = found(BARE.with_effect("saturation", k_percent=0.5))
    assert one.at_end == "farthest"
    assert "the farthest distance asked, beyond it may be less" in one.words()
    (one,) = found(BARE.with_effect("hysteresis", lag_deg=0.1), gaps="2")
    assert (one.at_end, one.air_gap_mm[0], one.air_gap_mm[-1]) == ("nearest", 1.0, 4.0)


def test_the_table_holds_every_magnet_and_cause() -> None:
    rows = list(csv.DictReader(distance_csv(found(BENT, diameter="5,8")).splitlines()))
    assert len(rows) == 2 * 401
    for row in rows[::50]:
        parts = [float(row[f"error_deg.{name}"]) for name in ("saturation", "hysteresis")]
        assert float(row["error_deg"]) == pytest.approx(sum(parts), rel=0.02)


def test_the_command_answers_in_words_json_table_and_picture(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    options = ("--diameter", "6,8", "--air-gap", "1:4:1", "--mountings", "4", "--workers", "1")
    ended = halltwin("design", *options, "-o", tmp_path / "study")
    assert ended.code == 0
    assert "least non-linear distance" in ended.out
    answer = json.loads((tmp_path / "study/best.json").read_text())["least_nonlinear"]
    assert {one["diameter_mm"] for one in answer} == {6.0, 8.0}
    for one in answer:
        assert 1.0 <= one["near_mm"][0] <= one["air_gap_mm"] <= one["near_mm"][1] <= 4.0
        said = f"{one['diameter_mm']:g} x 2.5 mm: {one['air_gap_mm']:.2f} mm ({one['field_mT']:.0f} mT)"
        assert said in " ".join(ended.out.split())
    for name in ("distance.csv", "distance.png", "distance.svg"):
        assert (tmp_path / "study" / name).stat().st_size > 1_000
