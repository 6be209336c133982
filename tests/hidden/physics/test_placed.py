"""Magnets and sensors out of place, channels recorded: nothing is assumed beside what a magnet out of place does.

The devices have nothing but that: what has to be assumed beside it, a reference or a coupling that errs or a further
harmonic, may be among what cannot be told apart, and is not what is named.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from ..study import DEFAULT_ANSWERER, load
from .generator import draw


@pytest.mark.parametrize(
    ("label", "seed"),
    [("uneven_disc_raw", 1868968460), ("uneven_disc_raw", 409010842), ("block_raw", 1929401729)],
)
def test_a_magnet_out_of_place_is_named_before_what_needs_more(label: str, seed: int, tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    draw(label, seed=seed).write_csv(path)
    causes = load(DEFAULT_ANSWERER)(str(path))["causes"]
    assert {cause["name"] for cause in causes} == {"magnet_misalignment"}
    told = {name for cause in causes for name in cause["indistinguishable_from"]}
    assert told & {"reference_eccentricity", "cardan_coupling"}
