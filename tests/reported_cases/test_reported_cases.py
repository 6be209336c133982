"""A sweep of each kind that people report, and those draws that a mechanism of the search is there for."""

from __future__ import annotations

import pytest

from tests.reported_cases.kinds import KINDS
from tests.reported_cases.trial import trial

SEED = 7
HARD = (
    ("seam", 6),  # The seam's two sides are off like a loud stretch.
    ("slips", 16),  # Ahead of the first slip lies a quarter of a turn.
    ("slips", 37),  # The reference's jump is one of its speed, too.
    ("slips", 46),  # What lies ahead of the first slip is held out as a whole.
    ("table_of_firmware", 4),  # 32 even angles are among those of a CORDIC.
)


@pytest.mark.parametrize("kind", KINDS)
def test_a_sweep_of_the_kind_is_answered_rightly(kind: str) -> None:
    """Of fixed draws; the study says how many of all are: ``python -m tests.reported_cases``."""
    told = trial((kind, SEED, 0))
    assert told.right, told


@pytest.mark.parametrize(("kind", "number"), HARD)
def test_a_draw_that_was_hard_is_answered_rightly(kind: str, number: int) -> None:
    told = trial((kind, SEED, number))
    assert told.right, told
