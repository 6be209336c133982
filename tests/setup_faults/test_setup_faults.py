"""A few logs of each fault of the set-up: named; clean ones: nothing is said; the study draws more of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.setup_faults.__main__ import trial
from tests.setup_faults.faults import CLEAN, FAULTS

DRAWS, CLEAN_DRAWS = 3, 40


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_is_named(name: str, tmp_path: Path) -> None:
    """Where 95 in 100 are named, two of three are in 993 of 1,000 cases; these draws are fixed."""
    place = sorted([*FAULTS, "clean"]).index(name)
    found = [trial(FAULTS[name], np.random.default_rng([21, place, draw]), tmp_path)[1] for draw in range(DRAWS)]
    assert sum(any(kind in FAULTS[name].named for kind in kinds) for kinds in found) >= 2, found


def test_of_clean_logs_nothing_is_said(tmp_path: Path) -> None:
    """Of 40 fixed draws none, where one in a hundred may be."""
    found = [trial(CLEAN, np.random.default_rng([21, 999, draw]), tmp_path)[1] for draw in range(CLEAN_DRAWS)]
    assert [kinds for kinds in found if kinds] == []
