"""Variance: rows that are beyond doubt louder weigh less before the search, whatever it is that makes them so."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis.discovery.marks.spread import bursts, spread_shapes
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.stages.variance import variance
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.spreads import Loud, handed
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual
from twin.adc.reference_jitter import spread as jitter_variance

LIMIT = DiscoverySettings().beyond_doubt_log_p


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is loud, and whether it is beyond doubt: its log probability lies near to the limit, on that side."""

    loud: Loud
    weighed: bool


CASES = {
    "stretch just below the limit": Case(loud=Loud(stretch=2.7), weighed=False),
    "stretch just above the limit": Case(loud=Loud(stretch=3.0), weighed=True),
    "shape just below the limit": Case(loud=Loud(jitter_percent=0.08), weighed=False),
    "shape just above the limit": Case(loud=Loud(jitter_percent=0.09), weighed=True),
}


def strongest(state: State) -> float:
    """The log probability by chance of what stands out most of the spread."""
    burst = bursts(state.fit, against_neighbours=True)
    found = [shape.log_p for shape in spread_shapes(state.fit, state.effects)]
    return min([*found, *([burst.log_p] if burst is not None else [])])


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_is_beyond_doubt_weighs_the_rows(case: Case) -> None:
    state = handed(variance, case.loud)
    # A limit twice as far, or half, would be noticed.
    assert 1.2 > strongest(state) / LIMIT > 0.8
    after = variance(state)
    assert (after is state) == (not case.weighed)
    assert after.findings == ()
    assert np.all(after.fit.observations.scale == 1.0) == (not case.weighed)


def test_the_rows_of_a_loud_stretch_weigh_by_how_loud_it_is() -> None:
    """Ends and loudness of a stretch of 40 rows are told to some rows and to a tenth: five sigma would be half."""
    factor = 4.0
    after = variance(handed(variance, Loud(stretch=factor)))
    scale = after.fit.observations.scale
    (first, *_, last) = np.flatnonzero(scale > 1.0)
    assert abs(first - Loud().first) <= 6
    assert abs(last - (Loud().first + Loud().length - 1)) <= 6
    assert np.max(scale) == pytest.approx(factor, rel=0.25)
    assert np.median(scale) == 1.0


def test_the_rows_weigh_by_the_shape_where_that_stands_out_more() -> None:
    after = variance(handed(variance, Loud(jitter_percent=0.3)))
    shape = jitter_variance(after.fit.linear.sensor_angle, {"percent_rms": 0.3}) + np.radians(0.02) ** 2
    expected = np.sqrt(shape / np.median(shape))
    assert np.max(np.abs(np.log(after.fit.observations.scale / expected))) < 0.3


def test_a_loud_speed_is_a_shape_and_no_stretch() -> None:
    """The readings at each of three speeds weigh alike, where a stretch would end short of the turn's last ones."""
    state = before(variance, Made(points=120, turns=2, bits=30, rpm=(60.0, 300.0, 1500.0)))
    speed = np.abs(state.fit.observations.motion.speed_rad_s)
    residual = noise(speed.size, 0.02) + 15e-6 * speed * noise(speed.size, 1.0, seed=4) / np.radians(1.0)
    scale = variance(with_residual(state, residual)).fit.observations.scale
    assert [np.ptp(scale[np.round(speed) == rad_s]) < 1e-9 for rad_s in (6.0, 31.0, 157.0)] == [True] * 3
    assert scale[-1] > 5.0 * scale[0]


def test_even_noise_is_left_as_it_is() -> None:
    state = handed(variance, Loud())
    assert variance(state) is state


def test_once_a_search_has_been_made_what_it_leaves_is_judged_instead() -> None:
    state = handed(variance, Loud(stretch=4.0)).with_(looked_at=20)
    assert variance(state) is state


def test_beside_stairs_that_make_most_of_the_spread_it_is_no_evidence() -> None:
    """How much a reading scatters depends there on its place between two steps."""
    made = Made(points=180, turns=2, bits=9)
    state = quantisation(before(quantisation, made))
    residual = noise(len(state.sweep), 0.2)
    residual[100:140] *= 6.0
    state = with_residual(state, residual)
    assert bursts(state.fit) is None
    assert spread_shapes(state.fit, state.effects) == []
    assert variance(state) is state


def test_what_is_off_together_is_no_louder() -> None:
    """A reference that slips and slips back: the rows between are as far off as of a noise six times as loud."""
    state = before(variance, Made(points=180, turns=2, bits=30))
    residual = noise(len(state.sweep), 0.02)
    residual[100:140] += np.radians(0.12)
    state = with_residual(state, residual)
    seen = bursts(state.fit)
    assert seen is not None
    assert seen.log_p < LIMIT
    assert variance(state) is state
