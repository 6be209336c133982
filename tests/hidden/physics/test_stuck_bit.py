"""A bit stuck inside a successive approximation: the interval of its weight holds the true one.

Its edges tell the weight to a ten-thousandth, so that an edge drawn too smooth or too sharp shows in the interval.
"""

from __future__ import annotations

from pathlib import Path

from scipy.stats import chi2

from tests.answerer import explain_file

from ..coverage import held
from .generator import draw

SEEDS = range(500, 508)


def test_the_weight_of_a_stuck_bit_is_within_its_interval(tmp_path: Path) -> None:
    squares = []
    for seed in SEEDS:
        hidden = draw("stuck_in_sar", seed=seed)
        path = tmp_path / f"{seed}.csv"
        hidden.write_csv(path)
        interval = held(explain_file(str(path)), hidden.truth)["adc_stuck_bit.step_percent"]
        squares.append((1.96 * (interval.value - interval.truth) / interval.half_width) ** 2)
    # once in a thousand sets of intervals that are right
    assert sum(squares) < chi2.ppf(0.999, len(squares)), squares
