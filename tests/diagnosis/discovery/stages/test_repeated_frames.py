"""Repeated frames: found, named and kept out of the fits; asked again after a search, they are not named twice."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis import explain
from diagnosis.discovery.finding import Finding
from diagnosis.discovery.marks.row_masks import scaled, without_rows
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.repeated_frames import repeated_frames
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.claims import claiming, with_effects
from tests.diagnosis.discovery.sweeps import Made, before, noise, planted_of, with_residual
from twin.angles import TAU
from twin.estimated_motion import EstimatedMotion
from twin.link.stale_frames import STALE_FRAMES, marks
from twin.motion import Motion

LIMIT = DiscoverySettings().footprint_log_p
STALE, GLITCH = "stale_frames", "bus_glitch"
MADE = Made(causes=((STALE, 0.05),), turns=2)
CLEAN = Made(turns=2)


def rows_hit(made: Made, name: str) -> tuple[int, ...]:
    """The rows that the generator has touched."""
    hidden = {one.name: one for one in planted_of(made)}[name].hidden
    return tuple(int(row) for row in hidden["rows"])


@pytest.mark.parametrize(
    "made",
    [
        MADE,
        Made(causes=((STALE, 0.05),), points=90, turns=2, back=True, bits=12),
        # A step of the shaft of six sigma: repeats that stand out too little to be masked by themselves.
        Made(causes=((STALE, 0.1),), points=360, noise_deg=0.16),
    ],
)
def test_every_repeated_frame_is_named_and_masked(made: Made) -> None:
    state = before(repeated_frames, made)
    after = repeated_frames(state)
    rows = rows_hit(made, STALE)
    (cause,) = after.findings
    assert cause.keys == (STALE,)
    assert cause.rows == rows
    # Five effects are looked for in the sequence.
    assert cause.family_log_p == pytest.approx(cause.log_p + np.log(5.0))
    assert cause.family_log_p < LIMIT
    assert tuple(np.flatnonzero(after.touched)) == rows
    assert set(rows) <= set(np.flatnonzero(~after.fit.observations.usable))
    assert repeated_frames(after) is after


def test_long_runs_pull_the_fit_until_they_are_masked() -> None:
    """Ten frames again at steps of two degrees: against the fit to all readings the first of a run looks sound."""
    shaft = np.arange(0.0, 360.0, 2.0)
    read = shaft + 0.4 * np.sin(np.radians(shaft)) + 0.02 * np.random.default_rng(5).standard_normal(shaft.size)
    held = np.zeros(shaft.size, dtype=bool)
    for first, times in ((20, 4), (63, 7), (113, 11), (132, 4)):
        held[first : first + times], read[first : first + times] = True, read[first - 1]
    (cause,) = explain({"reference_deg": shaft, "measured_deg": np.round(read % 360.0, 3)}).to_dict()["causes"]
    assert cause["name"] == STALE
    assert cause["parameters"]["fraction_percent"]["value"] == pytest.approx(100.0 * np.mean(held), abs=1e-4)


def test_a_repeat_that_the_expected_reading_repeats_is_none() -> None:
    """A cause may hold the reading where the shaft moves on: then the error is its own, not a step of the shaft."""
    motion = Motion.from_angle(np.radians(np.arange(0.0, 360.0, 1.0)))
    noise = np.radians(0.02) * np.random.default_rng(0).standard_normal(360)
    measured = motion.shaft_rad + noise
    measured[200] = measured[199]
    stale = np.where(np.arange(360) == 200, -np.radians(1.0), noise)
    assert STALE_FRAMES.marks is not None
    touched, log_p = STALE_FRAMES.marks(measured, stale, np.radians(0.02), 0.0, motion)
    assert np.flatnonzero(touched).tolist() == [200]
    assert log_p < -100.0
    touched, log_p = STALE_FRAMES.marks(measured, noise, np.radians(0.02), 0.0, motion)
    assert not touched.any()
    assert log_p == 0.0


def test_two_counts_of_a_coarse_reference_may_be_a_movement_of_one() -> None:
    """In hundredths of a radian: an equal word where the reference went on by two of them is no frame sent again."""
    motion = Motion.from_angle(np.round(np.mod(np.arange(700) * 0.0123, TAU), 2))
    (two, *_) = np.flatnonzero(np.diff(motion.shaft_rad) > 0.015) + 1
    measured = motion.shaft_rad + 0.004
    measured[two] = measured[two - 1]
    off = np.where(np.arange(700) == two, 0.012, 0.0)
    assert not marks(measured, off, 1e-3, 0.01, motion)[0].any()
    # Of a reference that reads exactly it would be one.
    exact = Motion.from_angle(motion.shaft_rad + 1e-5 * np.random.default_rng(1).standard_normal(700))
    assert np.flatnonzero(marks(measured, off, 1e-3, 0.01, exact)[0]).tolist() == [two]


def test_loud_noise_may_cancel_the_movement() -> None:
    """Two readings alike, two degrees apart: among readings of 1 deg by chance, among those of 0.02 deg hardly ever."""
    state = before(repeated_frames, CLEAN)
    angle = state.fit.linear.angle
    loud = np.where(np.arange(angle.size) < 60, 50.0, 1.0)
    residual = loud * noise(angle.size)
    residual[50] = residual[49] + angle[49] - angle[50]
    alike = with_residual(state, residual)
    assert repeated_frames(alike) is not alike
    weighed = alike.with_(scaled(alike.fit, loud**2))
    assert repeated_frames(weighed) is weighed


def test_without_them_the_fit_is_that_of_the_other_readings() -> None:
    """An order of the turn that the repeats would pull at, in standard deviations of the fit."""
    after = repeated_frames(before(repeated_frames, MADE)).fit
    clean = before(repeated_frames, CLEAN).fit
    names = [(free.key, free.name) for free in clean.free]
    moved = [float(after.chain.values[key][name]) - float(clean.chain.values[key][name]) for key, name in names]
    # The same noise on all rows but those masked, three in a hundred: estimates differ by sqrt(0.03) of a deviation.
    assert np.max(np.abs(moved) / np.sqrt(np.diag(clean.covariance()))) < 5.0 * np.sqrt(0.03)


@dataclass(frozen=True, kw_only=True)
class Case:
    """A claim to some rows with some probability by chance, and whether it is believed."""

    log_p: float
    named: bool
    rows: tuple[int, ...] = (40, 90)
    early: bool = True
    family: int = 1


CASES = {
    "just improbable enough": Case(log_p=LIMIT - 0.1, named=True),
    "just too probable": Case(log_p=LIMIT + 0.1, named=False),
    "one of three, just improbable enough": Case(log_p=LIMIT - np.log(3.0) - 0.1, family=3, named=True),
    "one of three, just too probable": Case(log_p=LIMIT - np.log(3.0) + 0.1, family=3, named=False),
    "no row": Case(log_p=-50.0, rows=(), named=False),
    "an effect that is not looked for first": Case(log_p=-50.0, early=False, named=False),
}


def test_the_limit_is_a_quarter_of_the_policy() -> None:
    """Causes show in four places, and the probability of a false alarm is that of all together."""
    assert pytest.approx(np.log(0.01 / 4.0)) == LIMIT


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_claim_is_believed_by_its_probability(case: Case) -> None:
    silent = [claiming("bus_glitch", (), 0.0, early=False) for _ in range(case.family - 1)]
    claim = claiming(STALE, case.rows, case.log_p, early=case.early)
    state = with_effects(before(repeated_frames, CLEAN), claim, *silent)
    after = repeated_frames(state)
    assert (after is state) == (not case.named)
    assert len(after.findings) == int(case.named)
    assert tuple(np.flatnonzero(after.touched)) == (case.rows if case.named else ())


def test_readings_that_the_fit_has_come_to_tell_are_given_back() -> None:
    """A claim that bears no marks any more against what was found since; its rows are in the fit again."""
    claim = claiming(STALE, (40, 90), -50.0, early=True)
    state = with_effects(before(repeated_frames, CLEAN), claim)
    state = state.with_(touched=np.isin(np.arange(len(state.sweep)), (7,)))
    after = repeated_frames(state)
    assert tuple(np.flatnonzero(after.touched)) == (7, 40, 90)
    back = repeated_frames(with_effects(after, claiming(STALE, (), 0.0, early=True)))
    assert back.findings == ()
    assert tuple(np.flatnonzero(back.touched)) == (7,)
    assert back.fit.observations.usable[[40, 90]].all()


def test_a_reading_that_another_finding_claims_too_stays_with_that() -> None:
    state = repeated_frames(with_effects(before(repeated_frames, CLEAN), claiming(STALE, (40, 90), -50.0, early=True)))
    other = Finding((GLITCH,), -50.0, 100.0, -50.0, rows=(90, 120))
    touched = np.isin(np.arange(len(state.sweep)), (40, 90, 120))
    state = state.with_(without_rows(state.fit, touched), touched=touched, findings=(*state.findings, other))
    back = repeated_frames(with_effects(state, claiming(STALE, (), 0.0, early=True)))
    assert back.findings == (other,)
    assert tuple(np.flatnonzero(back.touched)) == (90, 120)
    assert tuple(np.flatnonzero(~back.fit.observations.usable)) == (90, 120)


def test_rows_of_an_earlier_claim_stay_touched() -> None:
    state: State = with_effects(before(repeated_frames, CLEAN), claiming(STALE, (40,), -50.0, early=True))
    state = state.with_(touched=np.isin(np.arange(len(state.sweep)), (7, 8)))
    after = repeated_frames(state)
    assert tuple(np.flatnonzero(after.touched)) == (7, 8, 40)
    assert tuple(np.flatnonzero(~after.fit.observations.usable)) == (7, 8, 40)


@pytest.mark.parametrize("made", [CLEAN, Made(turns=2, bits=10), Made(points=90, repeats=4)])
def test_on_a_clean_sweep_there_is_nothing_to_say(made: Made) -> None:
    """Also where the shaft moves by less than a step of the grid, or stands still."""
    state = before(repeated_frames, made)
    assert repeated_frames(state) is state


def standing(rows: int = 400) -> tuple[np.ndarray, Motion]:
    """A spin of 20 steps of the word a reading whose shaft a torque holds for some readings, ten times a record.

    The readings [rad] and the motion as it is estimated, the even one, a little behind them.
    """
    even = 20.0 * np.arange(rows)
    held = even + 20.0 * 40.0 / TAU * np.sin(TAU * np.arange(rows) / 40.0) + 30.0
    step = TAU / 2.0**14
    estimated = EstimatedMotion(
        stretch=np.zeros(rows, dtype=np.int64), knee_rad=np.full(rows, 1e-3), noise_rad=step, torques=()
    )
    motion = Motion.from_angle(step * even)
    return step * np.round(held), replace(motion, estimated=estimated)


def test_without_a_reference_a_shaft_that_a_torque_holds_sends_no_frame_again() -> None:
    measured, motion = standing()
    step = TAU / 2.0**14
    away = measured - motion.shaft_rad
    mask, log_p = marks(measured, away, step, step, motion)
    assert not mask.any()
    assert log_p == 0.0
    # Against a reference that turns on meanwhile they would be.
    assert marks(measured, away, step, step, replace(motion, estimated=None))[0].any()


def test_without_a_reference_a_frame_that_is_sent_again_is_told_by_the_one_after_it() -> None:
    _, motion = standing()
    step, again = TAU / 2.0**14, np.arange(20, 400, 40)
    measured = motion.shaft_rad.copy()
    measured[again] = measured[again - 1]
    measured[again[::2] + 1] = measured[again[::2] - 1]
    mask, log_p = marks(measured, measured - motion.shaft_rad, step, step, motion)
    assert np.array_equal(np.flatnonzero(mask), np.sort(np.concatenate([again, again[::2] + 1])))
    assert log_p < LIMIT
