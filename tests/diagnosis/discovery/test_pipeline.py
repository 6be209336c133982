"""The pipeline: every stage does something to some answer, and may be left out, exchanged or added from outside.

Each case is a sweep on which one stage is needed, what the answer says of it with the whole pipeline, and what without
that stage.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.pipeline import PIPELINE, discover
from diagnosis.discovery.result import Discovery
from diagnosis.discovery.stages.answer import answer
from diagnosis.discovery.stages.final_fit import final_fit
from diagnosis.discovery.stages.flipped_bits import flipped_bits
from diagnosis.discovery.stages.further_measurements import further_measurements
from diagnosis.discovery.stages.grid_cause import grid_cause
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.stages.initial_fit import initial_fit
from diagnosis.discovery.stages.listed import listed
from diagnosis.discovery.stages.observe import observe
from diagnosis.discovery.stages.own_parameters import own_parameters
from diagnosis.discovery.stages.predictive_check import predictive_check
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.stages.repeated_frames import repeated_frames
from diagnosis.discovery.stages.row_masks import row_masks
from diagnosis.discovery.stages.sense_check import sense_check
from diagnosis.discovery.stages.spread import spread
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.stages.variance import variance
from diagnosis.discovery.state import Stage, State, until_still
from tests.diagnosis.discovery.sweeps import (
    LOOP,
    ONCE,
    Made,
    before,
    bench_of,
    noise,
    start_of,
    sweep_of,
    with_residual,
)
from twin.chain import Chain

SATURATED = Made(causes=(("saturation", 0.08),), points=96)


def without(left_out: Stage) -> tuple[Stage, ...]:
    """The pipeline without one stage, put together anew."""
    loop = until_still(*(stage for stage in LOOP if stage is not left_out))
    kept = [loop if stage is LOOP[0] else stage for stage in ONCE if stage is LOOP[0] or stage not in LOOP]
    return tuple(stage for stage in kept if stage is not left_out)


def names(found: Discovery) -> tuple[str, ...]:
    return tuple(cause.name for cause in found.causes)


def rows_in_use(found: Discovery) -> int:
    return found.fit.rows


def senses(found: Discovery) -> tuple[int, int]:
    return found.fit.chain.sensor_sense, found.fit.chain.output_sense


def held_out_beats_nothing(found: Discovery) -> bool:
    return found.extended_held_deg < found.baseline_held_deg


def slopes(found: Discovery) -> bool:
    return found.fit.weighting.slopes


def offered(found: Discovery) -> tuple[bool, ...]:
    return tuple(bool(cause.options) for cause in found.causes)


def checked(found: Discovery) -> bool:
    return found.likeness is not None


@dataclass(frozen=True, kw_only=True)
class Case:
    """A sweep, what is asked of the answer, and what it is with the stage and without it."""

    stage: Stage
    made: Made
    asked: Callable[[Discovery], Any] = names
    whole: Any
    left: Any


CASES = (
    Case(
        stage=quantisation,
        made=Made(causes=(("cordic_truncation", 0.1),), points=96),
        whole=("cordic_truncation",),
        left=(),
    ),
    # Repeats by a step of 6 sigma stand out too little to be masked: they weigh on the fits.
    Case(
        stage=repeated_frames,
        made=Made(causes=(("stale_frames", 0.1),), points=360, noise_deg=0.16),
        asked=rows_in_use,
        whole=353,
        left=357,
    ),
    Case(stage=stepwise, made=SATURATED, whole=("saturation",), left=()),
    Case(
        stage=sense_check,
        made=Made(points=180, quadratic=3e-4, start_sense=-1, start_output=-1),
        asked=senses,
        whole=(1, 1),
        left=(-1, -1),
    ),
    Case(
        stage=spread,
        made=Made(causes=(("reference_jitter", 0.08),), turns=2),
        whole=("reference_jitter",),
        left=(),
    ),
    Case(stage=held_out_selection, made=SATURATED, asked=held_out_beats_nothing, whole=True, left=False),
    Case(
        stage=flipped_bits,
        made=Made(causes=(("bus_glitch", 0.08),), turns=2),
        whole=("bus_glitch",),
        left=(),
    ),
    Case(
        stage=grid_cause,
        made=Made(causes=(("output_quantisation", 0.1),), points=120),
        whole=("output_quantisation",),
        left=(),
    ),
    Case(
        stage=final_fit,
        made=Made(causes=(("adc_stuck_bit", 0.08),), points=180, turns=2),
        asked=slopes,
        whole=True,
        left=False,
    ),
    Case(stage=answer, made=SATURATED, whole=("saturation",), left=()),
    Case(stage=further_measurements, made=SATURATED, asked=offered, whole=(True,), left=(False,)),
    Case(stage=predictive_check, made=SATURATED, asked=checked, whole=True, left=False),
)


@functools.cache
def whole(made: Made) -> Discovery:
    """What the whole pipeline finds."""
    return discover(start_of(made))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.stage.__name__)
def test_without_a_stage_the_answer_is_another(case: Case) -> None:
    assert case.asked(whole(case.made)) == case.whole
    assert case.asked(discover(start_of(case.made), without(case.stage))) == case.left


def test_what_the_answer_lists_is_held_against_its_own_figures() -> None:
    assert PIPELINE[PIPELINE.index(answer) + 1] is listed


def test_without_observations_there_is_nothing_to_do() -> None:
    with pytest.raises(RuntimeError, match="expected `observe` first in the pipeline"):
        discover(start_of(SATURATED), without(observe))


def misplaced(made: Made, off_deg: float) -> State:
    """What the first stage is handed where the error model is known but for its zero."""
    true = bench_of(made).baseline
    chain = (
        Chain()
        .with_effect("zero", zero_deg=true.zero_deg + off_deg)
        .with_effect("offset", x_percent=100.0 * true.offset_x, y_percent=100.0 * true.offset_y)
        .with_effect("gain_mismatch", ratio=true.amplitude_y)
        .with_effect("phase", beta_deg=true.phase_deg)
        .with_effect("quadratic_nonlinearity", q_percent=100.0 * true.quadratic)
    )
    return State.of(sweep_of(made), chain)


def test_without_the_initial_fit_the_error_model_is_taken_as_it_is() -> None:
    state = misplaced(Made(points=72), 1.0)

    def left_deg(found: Discovery) -> float:
        return float(np.degrees(np.sqrt(np.mean(found.baseline.residual[0] ** 2))))

    assert left_deg(discover(state)) < 0.03
    assert left_deg(discover(state, without(initial_fit))) == pytest.approx(1.0, abs=0.02)


def test_without_the_row_masks_single_readings_weigh_on_what_is_measured_of_the_stairs() -> None:
    """The blur of a grid, found before any search; a glitch of 22 deg would be taken for noise ahead of it."""
    made = Made(causes=(("bus_glitch", 0.08),), points=120, bits=10)
    stages = (observe, initial_fit, row_masks, own_parameters, quantisation)

    def blur_deg(stages: tuple[Stage, ...]) -> float:
        state = start_of(made)
        for stage in stages:
            state = stage(state)
        return float(np.degrees(state.fit.weighting.blur))

    assert tuple(PIPELINE[:5]) == stages
    assert blur_deg(tuple(PIPELINE[:4])) < 0.1
    assert blur_deg(tuple(stage for stage in stages if stage is not row_masks)) > 1.0


def test_without_the_variance_a_loud_stretch_passes_for_causes() -> None:
    """25 readings that scatter by 0.5 deg among others that scatter by 0.02 deg, and no cause in the mean."""
    state = before(row_masks, Made(points=180, bits=30))
    residual = noise(len(state.sweep), seed=5)
    residual[60:85] *= 25.0
    start = State.of(with_residual(state, residual).sweep, state.start)
    assert names(discover(start)) == ("unnamed",)
    assert len(names(discover(start, without(variance)))) > 1


def test_the_loop_may_be_cut_short() -> None:
    """The first round names what makes readings scatter, the second searches with these weights, a third is still."""
    made = Made(causes=(("reference_jitter", 0.08),), turns=2)
    asked: list[State] = []

    def listening(state: State) -> State:
        asked.append(state)
        return state

    def rounds(most: int) -> int:
        asked.clear()
        state = start_of(made)
        state = state.with_(settings=replace(state.settings, most_rounds=most))
        loop = until_still(listening, *LOOP)
        discover(state, tuple(loop if stage is LOOP[0] else stage for stage in ONCE if stage not in LOOP[1:]))
        return len(asked)

    assert (rounds(1), rounds(2), rounds(9)) == (1, 2, 3)


def test_a_stage_may_be_added() -> None:
    """One of one's own names what it knows: here, that the bench is cold."""

    def cold(state: State) -> State:
        return state.with_(findings=(*state.findings, Finding.among(1, "zero_drift", -20.0, gain=40.0)))

    stages = (*PIPELINE[: PIPELINE.index(answer)], cold, *PIPELINE[PIPELINE.index(answer) :])
    assert set(names(discover(start_of(SATURATED), stages))) == {"saturation", "zero_drift"}


def test_a_stage_may_be_exchanged() -> None:
    """A search of one's own, which finds nothing."""

    def blind(state: State) -> State:
        return state if state.looked_at else state.with_(baseline=state.fit, looked_at=1)

    loop = until_still(*(blind if stage is stepwise else stage for stage in LOOP))
    stages = tuple(loop if stage not in ONCE else stage for stage in PIPELINE)
    found = discover(start_of(SATURATED), stages)
    assert names(found) == ()
    assert found.looked_at == 1


def test_the_same_state_gives_the_same_answer_again() -> None:
    state = start_of(SATURATED)
    one, other = discover(state), discover(state)
    assert one.likeness == other.likeness
    assert [cause.family_log_p for cause in one.causes] == [cause.family_log_p for cause in other.causes]
    assert one.verdict == "explained"
