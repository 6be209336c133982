"""A bit stuck inside a successive approximation: the interval of its weight holds the true one.

Its edges tell the weight to a ten-thousandth, so that an edge drawn too smooth or too sharp shows in the interval.
"""

from __future__ import annotations

from pathlib import Path

from ..coverage import held
from ..study import DEFAULT_ANSWERER, load
from .generator import draw

SEEDS = range(500, 508)
LARGEST = 26.12
"""Sum of the squares of eight standard normal deviations that is passed once in a thousand."""


def test_the_weight_of_a_stuck_bit_is_within_its_interval(tmp_path: Path) -> None:
    squares = []
    for seed in SEEDS:
        hidden = draw("stuck_in_sar", seed=seed)
        path = tmp_path / f"{seed}.csv"
        hidden.write_csv(path)
        interval = held(load(DEFAULT_ANSWERER)(str(path)), hidden.truth)["adc_stuck_bit.step_percent"]
        squares.append((1.96 * (interval.value - interval.truth) / interval.half_width) ** 2)
    assert sum(squares) < LARGEST, squares
