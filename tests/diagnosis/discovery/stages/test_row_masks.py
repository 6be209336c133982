"""Row masks: readings that stand alone are kept out of the fits; structure, the grid's jumps and repeats are not.

The readings are made so that the fit leaves noise of a known robust deviation, with single rows put so many of these
away from their neighbours: one case on each side of every limit.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.fitting.joint_fit import evaluate
from diagnosis.discovery.marks.outliers import local_rms, robust_rms
from diagnosis.discovery.marks.row_masks import scaled
from diagnosis.discovery.stages.row_masks import row_masks
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.angles import Array

NEAR = 0.15
"""Share of a limit by which the cases stand on either side of it: what the fit itself takes up of a row is less.

In a short record the row itself adds as much to the scatter of its neighbours: twice the share.
"""
FINE = Made(points=180, bits=30)


@dataclass(frozen=True, kw_only=True)
class Case:
    """Rows put ``away`` from their neighbours (robust sigma, plus steps of the grid), and those that are masked."""

    made: Made = FINE
    rows: tuple[int, ...] = (40,)
    away: float = 7.0 * (1.0 + NEAR)
    steps: float = 0.0
    masked: tuple[int, ...] = ()
    touched: tuple[int, ...] = ()


def few(points: int) -> Made:
    """A turn of so few readings."""
    return replace(FINE, points=points)


_NEIGHBOURS = tuple(range(40, 45))
_THREE = Made(points=72, turns=3, bits=30)
_BACK = Made(points=72, turns=2, back=True, bits=30)
CASES = {
    "noise alone": Case(away=0.0),
    "nearer than the limit": Case(away=7.0 * (1.0 - NEAR)),
    "farther than the limit": Case(masked=(40,)),
    "below": Case(away=-7.0 * (1.0 + NEAR), masked=(40,)),
    "in a record just long enough": Case(made=few(60), away=10.0, masked=(40,)),
    "in a record just too short": Case(made=few(59), away=10.0),
    "nearer than the limit of a short record": Case(made=few(59), away=14.0 * (1.0 - NEAR)),
    "farther than the limit of a short record": Case(made=few(59), away=14.0 * (1.0 + 2.0 * NEAR), masked=(40,)),
    # Five degrees apart: of readings within a few degrees three that are off the same way pass for a narrow shape.
    "as many neighbours as may be": Case(made=few(72), rows=_NEIGHBOURS[:-1], away=20.0, masked=_NEIGHBOURS[:-1]),
    "one neighbour more": Case(made=few(72), rows=_NEIGHBOURS, away=20.0),
    "within a step of the grid": Case(made=replace(FINE, bits=10), steps=0.9, away=5.0),
    "beyond a step of the grid": Case(made=replace(FINE, bits=10), steps=1.0, away=9.0, masked=(40,)),
    "at one place of two turns": Case(made=_THREE, rows=(20, 92), away=15.0, masked=(20, 92)),
    "at one place of three turns": Case(made=_THREE, rows=(20, 92, 164), away=15.0),
    "at three places of three turns": Case(made=_THREE, rows=(20, 102, 194), away=15.0, masked=(20, 102, 194)),
    "at one place, twice up and once down": Case(made=_BACK, rows=(10, 82, 206), away=15.0, masked=(10, 82, 206)),
    "claimed by another effect": Case(away=0.0, touched=(7, 8), masked=(7, 8)),
}


def handed(case: Case) -> State:
    """The state that the stage is handed."""
    state = before(row_masks, case.made)
    plain = noise(len(state.sweep))
    sigma, residual = local_rms(plain), plain.copy()
    for row in case.rows:
        residual[row] = np.median(plain[row - 4 : row + 5]) + case.away * sigma + case.steps * state.step
    touched = np.isin(np.arange(len(state.sweep)), case.touched)
    return with_residual(state, residual).with_(touched=touched)


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_which_rows_are_masked(case: Case) -> None:
    state = row_masks(handed(case))
    assert tuple(np.flatnonzero(~state.fit.observations.usable)) == case.masked


def test_a_loud_row_stands_alone_among_rows_as_loud() -> None:
    """A twelfth of the rows is ten times as loud as the others: by their scatter many of them would be far out."""
    state = before(row_masks, FINE)
    loud = np.where(np.arange(len(state.sweep)) < 15, 10.0, 1.0)
    residual = loud * noise(loud.size)
    residual[5] = 60.0 * local_rms(noise(loud.size))
    plain = with_residual(state, residual)
    weighed = plain.with_(scaled(plain.fit, loud**2))
    assert np.count_nonzero(~row_masks(plain).fit.observations.usable) > 1
    assert row_masks(weighed).fit.observations.usable.all()
    far = with_residual(weighed, np.where(np.arange(loud.size) == 5, 2.0 * residual, residual))
    assert tuple(np.flatnonzero(~row_masks(far).fit.observations.usable)) == (5,)


@pytest.mark.parametrize("steepest", [0.5, 2.0, 4.0])
def test_structure_that_rises_by_more_than_the_noise_masks_no_row(steepest: float) -> None:
    """A row between two neighbours is their median, however loud it is; of 180 rows none lies beyond seven sigma."""
    state = before(row_masks, FINE)
    plain = noise(len(state.sweep))
    slope = steepest * robust_rms(plain) * np.sin(0.1 * np.arange(plain.size))
    left = row_masks(with_residual(state, plain + np.cumsum(slope)))
    assert left.fit.observations.usable.all()


def test_a_masked_row_moves_the_fit_no_more() -> None:
    """However far it is away: the fit is that of the others alone."""
    near, far = (row_masks(handed(Case(away=away))).fit for away in (20.0, 2000.0))
    assert np.allclose(near.linear.angle, far.linear.angle, rtol=0.0, atol=1e-9)


@dataclass(frozen=True, kw_only=True)
class Radius:
    """Rows whose channels are smaller by ``fallen`` (log), and those that are masked."""

    fallen: float
    rows: tuple[int, ...]
    masked: bool


_STRETCH = tuple(range(40, 50))
RADII = {
    "a stretch smaller than any cause makes it": Radius(fallen=0.2 * 1.1, rows=_STRETCH, masked=True),
    "a stretch that a cause might explain": Radius(fallen=0.2 * 0.9, rows=_STRETCH, masked=False),
    "a single reading": Radius(fallen=0.05, rows=(40,), masked=True),
}


@functools.cache
def recorded() -> State:
    return before(row_masks, replace(FINE, channels=True))


def with_radius(state: State, change: Array) -> State:
    """The state whose log radius differs by so much (n,)."""
    fit = state.fit
    assert fit.observations.log_radius is not None
    observations = replace(fit.observations, log_radius=fit.observations.log_radius + change)
    return state.with_(evaluate(fit.chain, fit.free, observations, fit.weighting))


@pytest.mark.parametrize("case", RADII.values(), ids=RADII)
def test_channels_that_fall_out_are_masked(case: Radius) -> None:
    change = np.zeros(len(recorded().sweep))
    change[list(case.rows)] = -case.fallen
    state = row_masks(with_radius(recorded(), change))
    assert tuple(np.flatnonzero(~state.fit.observations.usable)) == (case.rows if case.masked else ())


def test_what_most_readings_do_is_no_falling_out() -> None:
    """Channels whose amplitudes differ 20:1 are as they are; all of them set aside, nothing would be left to fit."""
    turn = np.radians(recorded().sweep.reference_deg)
    state = row_masks(with_radius(recorded(), 3.0 * np.cos(2.0 * turn)))
    assert np.mean(state.fit.observations.usable) > 0.9


def test_a_row_that_is_in_its_place_comes_back() -> None:
    """Its radius is held against the common scale of the others, here volts of half the amplitude."""
    in_volts = with_radius(recorded(), np.full(len(recorded().sweep), np.log(0.5)))
    out = np.arange(len(in_volts.sweep)) == 40
    fit = in_volts.fit
    masked = evaluate(fit.chain, fit.free, fit.observations.masked(~out), fit.weighting)
    assert row_masks(in_volts.with_(masked)).fit.observations.usable.all()
