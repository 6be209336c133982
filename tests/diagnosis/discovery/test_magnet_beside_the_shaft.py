"""A magnet beside the shaft: its harmonics change the size of the field with its direction."""

from __future__ import annotations

from pathlib import Path

import pytest

from diagnosis import explain
from diagnosis.discovery.search.falling_lines import as_lines_of_a_body
from tests.hidden.physics.generator import draw

OF_A_FIELD = {"cardan_coupling", "magnet_misalignment", "magnet_harmonic"}
"""Order 2 of the angle alone, beside gain and phase, is what a third harmonic of the magnet does."""


@pytest.mark.parametrize("seed", [2, 2031927089])
def test_a_wave_of_the_radius_that_belongs_to_a_line_of_the_angle_is_the_magnets(seed: int, tmp_path: Path) -> None:
    """Radius and angle of a ring's fifth harmonic are waves of order 4 and of one size; a shaft turns no radius."""
    path = tmp_path / "ring.csv"
    draw("ring_beside_shaft", seed=seed).write_csv(path)
    causes = explain(str(path)).to_dict()["causes"]
    (line,) = (cause for cause in causes if cause["name"] == "magnet_harmonic")
    assert {cause["name"] for cause in causes} <= OF_A_FIELD
    assert line["parameters"]["order"]["value"] == 4.0
    # A cardan coupling in the third harmonic's place leaves a part of order 4, of its square.
    assert line["parameters"]["radius_ratio"]["value"] == pytest.approx(1.0, abs=0.3)
    assert "mechanics" not in line["indistinguishable_from"]


def test_how_large_order_3_is_the_usual_quadratic_term_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Orders 3 to 6 of a rim: beside a quadratic term of any size that of order 3 is not told, nor whose they are."""
    path = tmp_path / "rim.csv"
    draw("falling_harmonics", seed=518912401).write_csv(path)
    assert {cause["name"] for cause in explain(str(path)).to_dict()["causes"]} == {"magnet_harmonic"}
    monkeypatch.setattr(f"{as_lines_of_a_body.__module__}.with_usual_factors", lambda fit: fit)
    assert {cause["name"] for cause in explain(str(path)).to_dict()["causes"]} == {"magnet_harmonic", "multipole"}
