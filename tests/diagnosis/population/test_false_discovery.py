"""Which of many tests may be believed."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.population.false_discovery import believed, threshold

P = np.array([0.0001, 0.004, 0.019, 0.0095, 0.201, 0.278, 0.0344, 0.0459, 0.324, 0.4262, 0.5719, 0.6528, 0.759, 1.0])
"""Fourteen of the fifteen p values of Benjamini and Hochberg's own example, and one more."""


@pytest.mark.parametrize(
    ("share", "independent", "count"),
    # By hand: 0.004 <= 2/14 * 0.05 = 0.0071, 0.0095 <= 3/14 * 0.05 = 0.0107, 0.019 > 4/14 * 0.05 = 0.0179; with the sum
    # of 1/k up to 14, 3.2516, only 0.0001 <= 0.05 / 14 / 3.2516 = 0.0011 is left.
    [(0.05, True, 3), (0.05, False, 1), (1e-4, True, 0)],
)
def test_worked_example(share: float, independent: bool, count: int) -> None:
    limit = threshold(np.log(P), share, independent=independent)
    assert np.count_nonzero(np.log(P) <= limit) == count


def test_what_was_not_tested_counts_not() -> None:
    log_p = np.log(P)
    padded = np.concatenate([log_p, np.full(100, np.nan)])
    assert threshold(padded, 0.05) == threshold(log_p, 0.05)
    assert believed(padded, 0.05).sum() == believed(log_p, 0.05).sum() == 1


def test_nothing_is_believed_of_nothing() -> None:
    assert threshold(np.full(3, np.nan), 0.01) == -np.inf
    assert not believed(np.log(np.full(5, 0.5)), 0.01).any()
