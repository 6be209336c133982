"""Held-out proof: no fit sees the rows that it is judged on, and every part of the turn is held out in some turn."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import Fit, evaluate
from diagnosis.discovery.proof.cross_validation import folds, held_out_residuals, rms_deg, scattered
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from tests.diagnosis.discovery.sweeps import Made, before

NOISE_DEG = 0.02
MADE = Made(causes=(("saturation", 0.1), ("hysteresis", 0.1)), points=72, back=True)
KEYS = ("saturation", "hysteresis")


@functools.cache
def fitted() -> Fit:
    state = before(held_out_selection, MADE)
    assert set(state.keys) == set(KEYS)
    return state.fit


def changed(fit: Fit, rows: list[int], wild_rad: float) -> Fit:
    """The fit of a sweep that reads otherwise in these rows, not yet fitted to them."""
    measured = fit.observations.measured.copy()
    measured[rows] += wild_rad
    return evaluate(fit.chain, fit.free, replace(fit.observations, measured=measured), fit.weighting)


@pytest.mark.parametrize("wild_rad", [1.0, -2.5])
@pytest.mark.parametrize("number", [0, 2])
def test_a_wild_value_in_a_held_out_fold_moves_no_other_reading_of_it(number: int, wild_rad: float) -> None:
    """To the last bit: the fit that is judged on this fold has not seen it."""
    fit = fitted()
    fold = folds(fit)
    mine = np.flatnonzero(fold == number)
    others = mine[1:]
    plain = held_out_residuals(fit, KEYS, fold)
    wild = held_out_residuals(changed(fit, [int(mine[0])], wild_rad), KEYS, fold)
    assert len(plain) == len(KEYS) + 1
    for now, then in zip(wild, plain, strict=True):
        assert np.array_equal(now[others], then[others])
        assert now[mine[0]] == pytest.approx(then[mine[0]] + wild_rad)
        # The other folds' fits have seen it.
        assert not np.any(now[fold != number] == then[fold != number])


def test_each_cause_in_turn_leaves_less_until_the_noise_is_left() -> None:
    """Strengths of 0.1 deg have an RMS of 0.07 each; n readings tell theirs to 1/sqrt(2n), five of these."""
    fit = fitted()
    figures = [rms_deg(residual, fit.observations.usable) for residual in held_out_residuals(fit, KEYS, folds(fit))]
    assert figures[0] > figures[1] > figures[2]
    # The fits see three quarters of the readings: nine parameters of theirs add a twelfth of the variance.
    assert figures[2] == pytest.approx(NOISE_DEG, rel=5.0 / np.sqrt(2.0 * fit.rows) + 0.05)
    assert figures[1] > np.hypot(NOISE_DEG, 0.05)


def test_masked_rows_count_neither_for_the_fits_nor_for_the_figure() -> None:
    fit = fitted()
    usable = np.ones(len(fit.observations), dtype=bool)
    usable[[3, 50, 100]] = False
    kept = evaluate(fit.chain, fit.free, fit.observations.masked(usable), fit.weighting)
    fold = folds(fit)
    plain = held_out_residuals(kept, KEYS, fold)[-1]
    wild = held_out_residuals(changed(kept, [3, 50, 100], 2.0), KEYS, fold)[-1]
    assert np.array_equal(wild[usable], plain[usable])
    assert rms_deg(wild, usable) == rms_deg(plain, usable)
    assert rms_deg(wild, np.ones_like(usable)) > 1.0


@dataclass(frozen=True, kw_only=True)
class Case:
    """A motion, and how long (rows) the blocks are."""

    made: Made
    block: int


CASES = {
    # Twelve blocks, since three a turn would be too few for four folds.
    "one turn": Case(made=Made(points=72), block=6),
    "two turns": Case(made=Made(points=72, turns=2), block=12),
    # A third of a turn each from eight blocks on.
    "three turns": Case(made=Made(points=72, turns=3), block=24),
    "eight turns": Case(made=Made(points=72, turns=8), block=24),
    "there and back": Case(made=Made(points=72, turns=2, back=True), block=24),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_blocks_are_dealt_out_in_turn(case: Case) -> None:
    fit = before(held_out_selection, case.made).fit
    fold = folds(fit)
    assert sorted(set(fold)) == [0, 1, 2, 3]
    assert np.bincount(fold).min() >= 0.6 * len(fold) / 4
    ends = np.flatnonzero(np.diff(fold)) + 1
    lengths = np.diff([0, *ends, len(fold)])
    # Stops lie a thousandth of a degree off: a row may fall into the next block.
    assert np.all(np.abs(lengths[1:-1] - case.block) <= 1)
    if fit.observations.motion.turns > 4.5:
        third = np.floor(fit.observations.motion.shaft_rad / (2.0 * np.pi) * 3.0 + 1e-6).astype(int) % 3
        assert {(int(a), int(b)) for a, b in zip(third, fold, strict=True)} >= {
            (a, b) for a in range(3) for b in range(4)
        }


def test_scattered_folds_part_neighbours() -> None:
    fold = scattered(fitted())
    assert np.all(np.diff(fold) != 0)
    assert np.bincount(fold).tolist() == [36] * 4


def test_a_fold_is_not_held_out_where_too_few_rows_are_left() -> None:
    fit = fitted()
    fold = folds(fit)
    usable = (fold == 0) | (np.cumsum(fold != 0) <= 7)
    few = evaluate(fit.chain, fit.free, fit.observations.masked(usable), fit.weighting)
    held = held_out_residuals(few, KEYS, fold)[0]
    assert np.all(np.isnan(held[fold == 0]))
    assert np.all(np.isfinite(held[(fold == 1) & usable]))
    assert np.isnan(rms_deg(held, fold == 0))
