"""The modified swarm: Eq. 8 to 11, bounds, seeds, histories."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest

from diagnosis.error_model import swarm
from diagnosis.error_model.error_band import SENTINELS, delta_e_rad, outside
from diagnosis.error_model.grid_search import full_grid_count, grid_search
from diagnosis.error_model.model import NOMINAL, Readings
from scenarios.commands.paper.search import methods, search
from scenarios.commands.paper.table_2 import draw
from tests.diagnosis.cases import turn
from tests.diagnosis.error_model.study import device
from twin.adc.adc_quantisation import FULL_SCALE
from twin.angles import TAU, Array, wrap
from twin.chain import Chain
from twin.effect import BoolArray
from twin.motion import Motion

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


@pytest.mark.parametrize(("own_pull", "best_pull"), [(0.0, 0.0), (1.494, 0.0), (0.0, 1.494), (1.0, 0.5)])
def test_particles_move_by_equation_8(own_pull: float, best_pull: float) -> None:
    """What a move adds to the one before, inertia (Eq. 10) apart: a share of the way to each of the best places.

    A share is uniform between 0 and its pull. So by least squares over thousands of moves the shares are half the
    pulls, to five standard errors, which follow from the variance pull^2 / 12 of each.
    """
    seen: list[Array] = []

    def watched(points: Array) -> Array:
        seen.append(points[0, :, 0].copy())
        return bowl(points)

    settings = swarm.SwarmSettings(particles=50_000, iterations=2, own_pull=own_pull, best_pull=best_pull)
    wall = 50.0
    swarm.run(watched, np.full((1, 1), -wall), np.full((1, 1), wall), rng=np.random.default_rng(0), settings=settings)
    first, second, third = seen
    carried = swarm.inertia(settings, 1) * (second - first)
    own = np.where(bowl(second[:, None]) < bowl(first[:, None]), second, first)
    pulls = np.array([own_pull, best_pull])
    ways = np.stack([own - second, own[np.argmin(bowl(own[:, None]))] - second])
    # Chosen by what no share can change: neither move comes to a wall or to the speed limit, half the range.
    moves = [carried + a * ways[0] + b * ways[1] for a in (0.0, own_pull) for b in (0.0, best_pull)]
    free = np.abs(first) < 8.0
    for move in moves:
        free &= (np.abs(move) < wall) & (np.abs(second + move) < wall)
    assert np.count_nonzero(free) > 5_000
    added, ways = (third - second - carried)[free], ways[:, free]
    solve = np.linalg.pinv(ways.T)
    error = np.sqrt(solve**2 @ ((pulls**2 / 12.0) @ ways**2))
    assert np.all(np.abs(solve @ added - 0.5 * pulls) <= 5.0 * error + 1e-9)
    # Nothing else moves a particle: what is left of a move is what the shares leave.
    assert np.std(added - 0.5 * pulls @ ways) == pytest.approx(np.sqrt(np.mean((pulls**2 / 12.0) @ ways**2)), rel=0.05)


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


def test_a_discarded_particle_counts_for_nothing() -> None:
    """Eq. 11: the least cost lies outside the band, and a swarm that is led from inside it never takes it.

    Inside the band, which ends 0.2 before the bottom of the bowl, the least cost is 0.2^2.
    """
    lanes = 12
    lower, upper = np.full((lanes, 4), -2.0), np.full((lanes, 4), 1.0)

    def beyond(points: Array) -> BoolArray:
        return np.asarray(points[..., 0] > 0.1)

    start = swarm.run(
        bowl, lower, upper, rng=np.random.default_rng(0), settings=swarm.SwarmSettings(iterations=0), outside=beyond
    )
    found = swarm.run(bowl, lower, upper, rng=np.random.default_rng(0), outside=beyond)
    led_from_inside = start.best[:, 0] <= 0.1
    assert led_from_inside.any()
    assert np.all(found.best[led_from_inside, 0] <= 0.1)
    np.testing.assert_allclose(found.best_cost[led_from_inside], 0.04, atol=1e-3)
    assert np.all(found.discarded[led_from_inside] > 0)
    # Led from outside it would discard everybody, so nobody is discarded.
    outside_all_along = ~led_from_inside & (found.best[:, 0] > 0.1)
    assert outside_all_along.any()
    assert np.all(found.discarded[outside_all_along] == 0)


DEVIATIONS: dict[str, tuple[dict[str, float], float]] = {
    # The converter's half step in each channel, both the same way at 45 deg, at amplitude 1.
    "adc_quantisation": ({"bits": 10}, np.sqrt(2.0) * FULL_SCALE / 2**10),
    "output_quantisation": ({"bits": 10}, 0.5 * TAU / 2**10),
    # The last of n steps, arctan 2^-(n - 1), which the iteration may end wrong by.
    "cordic_truncation": ({"iterations": 8}, float(np.arctan(2.0**-7))),
    # Noise of both channels at 45 deg: each turns the angle by half its share of the amplitude.
    "reference_jitter": ({"percent_rms": 0.1}, 4.0 * 0.001 * np.sqrt(2.0) / 2.0),
    "noise": ({"rms_deg": 0.05}, 4.0 * float(np.radians(0.05))),
}


@pytest.mark.parametrize("name", DEVIATIONS)
def test_delta_e_is_the_largest_deviation_of_a_simulated_sweep(name: str) -> None:
    """Each term of Eq. 7 against readings of the twin that has it: never exceeded by a grid, nearly reached.

    Of 20,000 readings 1.3 leave four standard deviations: the largest lies between 3.3 and 5.5 with a probability
    beyond 0.999; of a grid some reading comes within a tenth of the largest deviation.
    """
    params, largest = DEVIATIONS[name]
    chain = Chain().with_effect(name, **params)
    assert delta_e_rad(chain) == pytest.approx(largest)
    motion = Motion.from_angle(turn(20_000))
    sweep = chain.simulate(motion, seed=1)
    worst = np.max(np.abs(wrap(np.radians(sweep.measured_deg) - motion.shaft_rad)))
    if name in ("noise", "reference_jitter"):
        assert 3.3 / 4.0 * largest < worst < 5.5 / 4.0 * largest
    else:
        assert 0.9 * largest < worst <= largest * (1.0 + 1e-9)


def test_delta_e_adds_the_settings_of_the_chain() -> None:
    assert delta_e_rad(Chain()) == 0.0
    # The paper's table: 8 iterations leave up to atan(2^-7) of a turn's arc.
    assert delta_e_rad(Chain().with_effect("cordic_truncation", iterations=8)) == pytest.approx(np.arctan(2.0**-7))
    twelve = delta_e_rad(Chain().with_effect("output_quantisation", bits=12))
    assert np.degrees(twelve) == pytest.approx(0.5 * 360 / 4096)
    everything = Chain()
    for name, (params, _) in DEVIATIONS.items():
        everything = everything.with_effect(name, **params)
    assert delta_e_rad(everything) == pytest.approx(sum(largest for _, largest in DEVIATIONS.values()))
    assert delta_e_rad(device("a"), immeasurable_rad=0.1) == pytest.approx(0.1 + delta_e_rad(device("a")))


def test_converges_below_200_iterations() -> None:
    cases = draw(12, np.random.default_rng(3))
    ways = methods(delta_e_rad(device("a")))
    assert np.all(search(cases, ways["modified"], seed=4).needed < 150)
    assert np.all(search(cases, ways["steps"], seed=4).needed < 200)
    assert np.all(search(cases, ways["discard"], seed=4).needed < 200)


def test_ordinary_method() -> None:
    assert full_grid_count() == pytest.approx(3.2e23, rel=0.02)
    reference = turn(90)
    gram = Readings.of(reference, reference).gram()
    spread = np.array([0.01, 0.01, 0.02, 0.01, 0.003, 0.0])
    found = grid_search(gram, NOMINAL - spread, NOMINAL + spread, points=3)
    np.testing.assert_allclose(found.best, NOMINAL, atol=1e-12)
    assert found.evaluations == 3**5
