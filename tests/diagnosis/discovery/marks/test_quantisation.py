"""The grid that all readings lie on, and the finite set that holds them: a case on each side of every limit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.marks.quantisation import finite_set, grid_bits
from diagnosis.discovery.settings import DiscoverySettings
from twin.angles import TAU, Array
from twin.cordic.cordic_truncation import CORDIC_TRUNCATION, attainable
from twin.effect import Effect
from twin.link.output_quantisation import OUTPUT_QUANTISATION
from twin.motion import Motion
from twin.words import decimal_step

LIMITS = DiscoverySettings()
CELLS = 1024
STEP = TAU / CELLS


@dataclass(frozen=True, kw_only=True)
class Grid:
    """A word of so many bits, written with so many decimals of a degree; what is seen of it."""

    bits: int
    seen: float | None
    decimals: int = 9
    off_deg: float = 0.0
    words: int = 200


GRIDS = {
    "the shortest": Grid(bits=6, seen=6, words=64),
    "shorter than any": Grid(bits=5, seen=None, words=32),
    "usual": Grid(bits=12, seen=12),
    "the longest": Grid(bits=20, seen=20),
    "longer than any": Grid(bits=21, seen=None),
    "six decimals": Grid(bits=14, seen=14, decimals=6),
    "three decimals": Grid(bits=14, seen=14, decimals=3),
    # The last digit is as coarse as a twelfth of the step: anything would lie on such a grid.
    "three decimals of a fine word": Grid(bits=18, seen=np.log2(360_000.0), decimals=3),
    "two decimals": Grid(bits=12, seen=12, decimals=2),
    "two decimals of a fine word": Grid(bits=16, seen=np.log2(36_000.0), decimals=2),
    "one decimal": Grid(bits=12, seen=np.log2(3600.0), decimals=1),
    "no decimal": Grid(bits=12, seen=np.log2(360.0), decimals=0, words=2000),
    "one reading off": Grid(bits=12, seen=None, off_deg=0.01),
}


@pytest.mark.parametrize("case", GRIDS.values(), ids=GRIDS)
def test_the_word_length_is_that_of_the_coarsest_grid_that_holds_all(case: Grid) -> None:
    rng = np.random.default_rng(4)
    words = rng.choice(2**case.bits, size=case.words, replace=False)
    measured_deg = np.round(words * 360.0 / 2**case.bits, case.decimals)
    measured_deg[17] += case.off_deg
    found = grid_bits(np.radians(measured_deg), LIMITS)
    assert found == (None if case.seen is None else pytest.approx(case.seen, rel=1e-12))


def test_hundredths_of_a_radian_are_a_grid_from_each_turns_zero() -> None:
    turned = np.round(np.mod(np.random.default_rng(4).uniform(0.0, 30.0, 300), TAU), 2)
    assert grid_bits(turned, LIMITS) == pytest.approx(np.log2(TAU / 0.01), rel=1e-12)
    read = OUTPUT_QUANTISATION.forward(turned + TAU, Motion.from_angle(turned), {"bits": np.log2(TAU / 0.01)}, None)
    np.testing.assert_allclose(read, turned + TAU, rtol=0.0, atol=1e-12)
    angles = OUTPUT_QUANTISATION.attainable
    assert angles is not None
    # 628 steps and a part of one; of 0.1 rad 6.3 is read just below the end of the turn.
    assert angles({"bits": np.log2(TAU / 0.01)}).size == 629
    assert angles({"bits": np.log2(TAU / 0.1)})[-1] == pytest.approx(6.3)
    np.testing.assert_allclose(np.degrees(angles({"bits": np.log2(3600.0)})), np.arange(-1800, 1800) / 10.0)


@pytest.mark.parametrize("step_deg", [0.5, 0.25, 0.02, 1.0])
def test_the_coarsest_step_of_the_decimals_is_told(step_deg: float) -> None:
    read = np.radians(np.random.default_rng(4).choice(round(360.0 / step_deg), size=200) * step_deg)
    assert decimal_step(read) == pytest.approx(np.radians(step_deg), rel=1e-12)


@pytest.mark.parametrize("decimals", [1, 2, 3, 4])
def test_the_last_decimal_of_a_radian_may_lie_beyond_the_turn(decimals: int) -> None:
    read = np.round(np.append(np.random.default_rng(4).uniform(0.0, TAU, 300), TAU - 1e-5), decimals)
    assert decimal_step(read) == pytest.approx(10.0**-decimals, rel=1e-12)


def holding(share: float) -> Effect:
    """An effect whose attainable angles are this share of the cells, the first ones; any level, the same angles."""
    angles = np.arange(round(share * CELLS)) * STEP
    return replace(CORDIC_TRUNCATION, attainable=lambda values: angles)


def readings(inside: int, outside: int, share: float) -> Array:
    """Different words [rad], so many in the first cells and so many a cell or more behind them."""
    first = round(share * CELLS) + 1
    return np.concatenate([np.arange(inside), first + np.arange(outside)]) * STEP


@dataclass(frozen=True, kw_only=True)
class Set:
    """A set that leaves out a share of the cells, and readings inside and outside of it."""

    share: float
    inside: int
    outside: int = 0
    found: bool = True


SETS = {
    "half of the words": Set(share=0.5, inside=100),
    "nearly all words": Set(share=0.85, inside=100),
    "all but a few words": Set(share=0.95, inside=100, found=False),
    "as many outside as may be": Set(share=0.5, inside=96, outside=4),
    "one outside more": Set(share=0.5, inside=95, outside=5, found=False),
    # 24 readings inside speak for this set by 3.1 nats, one outside against it by 3.2.
    "too few to outweigh the one outside": Set(share=0.88, inside=24, outside=1, found=False),
}


@pytest.mark.parametrize("case", SETS.values(), ids=SETS)
def test_chance_is_the_share_of_the_words_to_the_power_of_the_readings(case: Set) -> None:
    """Four of a hundred may lie outside; each of these speaks against the set as an error of one in 25."""
    measured = readings(case.inside, case.outside, case.share)
    values, log_p = finite_set(measured, holding(case.share), [{"iterations": 7.0}], step=STEP, settings=LIMITS)
    share = round(case.share * CELLS) / CELLS
    # The set is tried as it is, and with a cell to either side.
    expected = case.inside * np.log(share) - np.log(0.04) * case.outside + np.log(2.0)
    assert values == ({"iterations": 7.0} if case.found else {})
    assert log_p == (pytest.approx(expected) if case.found else 0.0)


def test_readings_of_one_word_count_once() -> None:
    measured = np.repeat(readings(30, 0, 0.5), 10)
    _, log_p = finite_set(measured, holding(0.5), [{"iterations": 7.0}], step=STEP, settings=LIMITS)
    assert log_p == pytest.approx(30 * np.log(0.5) + np.log(2.0))


@pytest.mark.parametrize("iterations", [6, 9, 12])
def test_the_fewest_iterations_that_hold_all_readings_are_told(iterations: int) -> None:
    """Sets of more iterations leave out fewer words, those of fewer iterations readings."""
    rng = np.random.default_rng(iterations)
    measured = rng.choice(attainable({"iterations": iterations}), size=100)
    tried = CORDIC_TRUNCATION.shapes(Motion.from_angle(np.zeros(2)))
    values, _ = finite_set(measured, CORDIC_TRUNCATION, tried, step=0.0, settings=LIMITS)
    assert values == {"iterations": iterations}


@pytest.mark.parametrize("angle_bits", [14, 18])
def test_a_register_of_whole_words_makes_a_set_of_its_own(angle_bits: int) -> None:
    """Each rotation is off by up to half a word, so that a sum of seven is off by words."""
    rng = np.random.default_rng(angle_bits)
    made = {"iterations": 7.0, "angle_bits": float(angle_bits)}
    measured = rng.choice(attainable(made), size=100)
    tried = CORDIC_TRUNCATION.shapes(Motion.from_angle(np.zeros(2)))
    values, _ = finite_set(measured, CORDIC_TRUNCATION, tried, step=TAU / 2**18, settings=LIMITS)
    assert values == made


def test_words_cut_off_to_the_grid_lie_a_cell_beside_the_set() -> None:
    rng = np.random.default_rng(5)
    step = TAU / 2**16
    measured = np.floor(rng.choice(attainable({"iterations": 7.0}), size=100) / step) * step
    tried = [{"iterations": float(count)} for count in range(5, 10)]
    values, log_p = finite_set(measured, CORDIC_TRUNCATION, tried, step=step, settings=LIMITS)
    assert values == {"iterations": 7.0}
    assert log_p < -300.0
