"""Causes that are too weak on one device and plain in the batch."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.population.pooled import FEWEST_DEVICES, OWN, REFERENCE, SENSOR, WAYS, Figures, log_p_of, newly_found
from tests.diagnosis.population.batches import clean, looked
from tests.hidden.fleets.generator import Plan
from twin.angles import Array

COUNT = 300


def figures(amplitude: float, phase: Array, turned: Array, rng: np.random.Generator, noise: float = 1.0) -> Figures:
    """Coefficients of a line with these phases (N,) [rad], each half with twice the variance of the whole."""
    truth = amplitude * np.stack([np.cos(phase), np.sin(phase)], axis=1)
    halves = truth + noise * np.sqrt(2.0) * rng.standard_normal((2, phase.size, 2))
    return Figures(line=True, values=halves.mean(axis=0), halves=halves, errors=np.ones(phase.size), turned=turned)


@pytest.mark.parametrize("way", WAYS)
def test_each_way_of_sharing_a_phase_is_told(way: str) -> None:
    """One and a half errors on a device: of three tests the right one says it plainly, the others nothing."""
    rng = np.random.default_rng(8)
    turned = rng.uniform(-np.pi, np.pi, COUNT)
    phase = {REFERENCE: np.full(COUNT, 0.7), SENSOR: 0.7 + turned, OWN: rng.uniform(-np.pi, np.pi, COUNT)}[way]
    log_p = dict(zip(WAYS, log_p_of(figures(1.5, phase, turned, rng), 0), strict=True))
    assert log_p[way] < np.log(1e-6)
    assert all(log_p[other] > np.log(1e-4) for other in {REFERENCE, SENSOR} - {way})


def test_chance_is_what_it_says() -> None:
    """Of 600 batches without a cause a tenth is below 0.1 in each test: 60 +- 4 sigma of 7.3; noise twice as large."""
    rng = np.random.default_rng(9)
    log_p = np.array([log_p_of(figures(0.0, np.zeros(60), rng.uniform(0, 6, 60), rng, 2.0), 0) for _ in range(600)])
    counts = np.count_nonzero(log_p < np.log(0.1), axis=0)
    assert np.all(np.abs(counts - 60) < 30)


def test_one_odd_device_decides_nothing() -> None:
    rng = np.random.default_rng(10)
    with_odd = figures(0.0, np.zeros(COUNT), np.zeros(COUNT), rng)
    odd = with_odd.values.copy(), with_odd.halves.copy()
    odd[0][3] += 200.0
    odd[1][:, 3] += 200.0
    changed = Figures(line=True, values=odd[0], halves=odd[1], errors=with_odd.errors)
    np.testing.assert_allclose(np.exp(log_p_of(changed, 0)[[0, 2]]), np.exp(log_p_of(with_odd, 0)[[0, 2]]), atol=0.2)


def test_one_odd_device_hides_nothing() -> None:
    rng = np.random.default_rng(11)
    shared = figures(1.0, np.zeros(COUNT), np.zeros(COUNT), rng)
    shared.values[3, 0] += 200.0
    assert log_p_of(shared, 0)[0] < np.log(1e-6)


def test_a_sign_that_physics_forbids_is_no_cause() -> None:
    rng = np.random.default_rng(12)
    values = -1.0 + rng.standard_normal((COUNT, 1))
    found = Figures(line=False, values=values, halves=np.stack([values, values]), errors=np.ones(COUNT))
    assert log_p_of(found, 1)[0] == 0.0
    assert log_p_of(found, -1)[0] < np.log(1e-6)
    # What has no phase has none of its own.
    assert np.isnan(log_p_of(found, 0)[1:]).all()


def test_few_devices_are_not_tested() -> None:
    rng = np.random.default_rng(13)
    few = figures(5.0, np.zeros(FEWEST_DEVICES - 1), np.zeros(FEWEST_DEVICES - 1), rng)
    assert np.isnan(log_p_of(few, 0)).all()


def test_what_a_stronger_one_leaks_is_not_taken_with_it() -> None:
    log_p = np.array([-200.0, -12.0, -12.0, -0.5])
    overlaps = np.eye(4)
    overlaps[0, 1] = overlaps[1, 0] = 0.3
    assert newly_found(log_p, overlaps, devices=100) == [0, 2]


@pytest.mark.parametrize(
    ("cause", "strength_deg", "phase", "phase_from"),
    [
        ("hysteresis", 0.003, "own", ()),
        ("drive_ripple", 0.006, "bench", (REFERENCE,)),
        ("magnet_harmonic", 0.006, "design", (SENSOR,)),
    ],
)
def test_weak_causes_of_a_batch_come_back(
    cause: str, strength_deg: float, phase: str, phase_from: tuple[str, ...]
) -> None:
    _, found = looked(Plan(count=60, cause=cause, strength_deg=strength_deg, phase=phase), seed=14)
    first = found.population.causes[0]
    assert cause in (first.name, *first.not_told_from)
    assert first.phase_from == phase_from
    assert not first.own_phase
    # Half an interval more, as the candidate's memory is that of a grid.
    half = first.high - first.low
    assert first.low - half < strength_deg < first.high + half
    assert found.ended


def test_a_phase_of_each_devices_own() -> None:
    _, found = looked(Plan(count=60, cause="magnet_harmonic", strength_deg=0.008, phase="own"), seed=15)
    first = found.population.causes[0]
    assert first.name == "magnet_harmonic"
    assert first.own_phase
    assert first.phase_from == ()
    # The root mean square over a spread of 20 %.
    assert first.amplitude == pytest.approx(0.008, rel=0.25)


def test_nothing_is_shared_where_nothing_is() -> None:
    _, found, population = clean()
    assert found.looks == 1
    assert population.causes == ()
