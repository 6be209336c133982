"""The modified swarm: Eq. 8 to 11, bounds, seeds, histories."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from diagnosis.error_model import swarm
from diagnosis.error_model.error_band import SENTINELS, delta_e_rad, outside
from diagnosis.error_model.grid_search import full_grid_count, grid_search
from diagnosis.error_model.model import NOMINAL, Readings
from tests.diagnosis.cases import turn
from tests.diagnosis.study import STEPS, device, draw, iterations_needed
from twin.angles import Array
from twin.chain import Chain

LOWER: Array = np.full((3, 4), -2.0)
UPPER: Array = np.full((3, 4), 1.0)


def bowl(points: Array) -> Array:
    return np.asarray(((points - 0.3) ** 2).sum(axis=-1))


def wall(points: Array) -> Array:
    return np.asarray(points.sum(axis=-1))


def test_inertia_falls_linearly() -> None:
    settings = swarm.SwarmSettings(iterations=200)
    assert swarm.inertia(settings, 0) == pytest.approx(0.9)
    assert swarm.inertia(settings, 100) == pytest.approx(0.65)
    assert swarm.inertia(settings, 200) == pytest.approx(0.4)


@pytest.mark.parametrize("bounds", ["reflect", "clamp"])
def test_finds_the_bottom_inside_and_at_the_wall(bounds: Literal["reflect", "clamp"]) -> None:
    settings = swarm.SwarmSettings(bounds=bounds)
    inside = swarm.run(bowl, LOWER, UPPER, rng=np.random.default_rng(0), settings=settings)
    np.testing.assert_allclose(inside.best, 0.3, atol=1e-4)
    at_wall = swarm.run(wall, LOWER, UPPER, rng=np.random.default_rng(0), settings=settings)
    assert np.all(at_wall.best >= LOWER)
    np.testing.assert_allclose(at_wall.best, -2.0, atol=0.02)


def test_same_seed_same_swarm_and_best_never_gets_worse() -> None:
    runs = [swarm.run(bowl, LOWER, UPPER, rng=np.random.default_rng(5)) for _ in range(2)]
    np.testing.assert_array_equal(runs[0].best, runs[1].best)
    assert np.all(np.diff(runs[0].best_history, axis=1) <= 0.0)
    assert np.all(runs[0].own_history >= runs[0].best_history)
    assert runs[0].best_history.shape == (3, 201)
    assert runs[0].evaluations == 100 * 201


def test_velocity_in_steps_keeps_to_the_grid() -> None:
    steps = np.full(4, 0.05)
    settings = swarm.SwarmSettings(iterations=50, bounds="clamp")
    found = swarm.run(bowl, LOWER, UPPER, rng=np.random.default_rng(0), settings=settings, steps=steps)
    offset = (found.best - LOWER) / 0.05
    np.testing.assert_allclose(offset, np.round(offset), atol=1e-9)


def test_settled_swarm_stops_early() -> None:
    settings = swarm.SwarmSettings(stop_settled=True)
    found = swarm.run(lambda p: bowl(p) + 1.0, LOWER, UPPER, rng=np.random.default_rng(0), settings=settings)
    assert found.best_history.shape[1] < 201
    np.testing.assert_allclose(found.best_cost, 1.0, atol=1e-3)


def test_discard_rule_holds_the_band_against_every_sentinel() -> None:
    reference = turn(SENTINELS)[None]
    leaves = outside(Readings.of(reference, reference), 0.01)
    shifted = np.tile(NOMINAL, (1, 3, 1))
    shifted[0, 1, 5], shifted[0, 2, 0] = 0.009, 0.02
    assert leaves(shifted).tolist() == [[False, False, True]]


def test_delta_e_adds_the_settings_of_the_chain() -> None:
    assert delta_e_rad(Chain()) == 0.0
    # The paper's table: 8 iterations leave up to atan(2^-7) of a turn's arc.
    assert delta_e_rad(Chain().with_effect("cordic_truncation", iterations=8)) == pytest.approx(np.arctan(2.0**-7))
    twelve = delta_e_rad(Chain().with_effect("output_quantisation", bits=12))
    assert np.degrees(twelve) == pytest.approx(0.5 * 360 / 4096)
    assert delta_e_rad(device("a"), immeasurable_rad=0.1) == pytest.approx(0.1 + delta_e_rad(device("a")))


def test_converges_below_200_iterations() -> None:
    cases = draw(12, np.random.default_rng(3))
    rng = np.random.default_rng(4)
    assert np.all(iterations_needed(cases, rng) < 150)
    assert np.all(iterations_needed(cases, rng, steps=STEPS) < 200)
    assert np.all(iterations_needed(cases, rng, band_rad=delta_e_rad(device("a"))) < 200)


def test_ordinary_method() -> None:
    assert full_grid_count() == pytest.approx(3.2e23, rel=0.02)
    reference = turn(90)
    gram = Readings.of(reference, reference).gram()
    spread = np.array([0.01, 0.01, 0.02, 0.01, 0.003, 0.0])
    found = grid_search(gram, NOMINAL - spread, NOMINAL + spread, points=3)
    np.testing.assert_allclose(found.best, NOMINAL, atol=1e-12)
    assert found.evaluations == 3**5
