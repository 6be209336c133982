"""Laws over temperature: their figures, and the words sensitive, immune and not told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from diagnosis.thermal.laws import IMMUNE, NOT_TOLD, SENSITIVE
from diagnosis.thermal.levels import Levels, Span
from diagnosis.thermal.over_temperature import OverTemperature, find_laws
from diagnosis.thermal.recording import joined, over_temperature, temperature_of
from tests.diagnosis.thermal.devices import (
    COLD_ROOM_HOT,
    FLOOR_DEG,
    GAIN_PER_K,
    X_PER_K,
    drifting,
    each_at,
    over,
    steady,
    warm,
)
from twin.baseline import FACTORS
from twin.chain import Chain
from twin.errors import UserError
from twin.motion import Motion
from twin.sweep import Sweep

X, Y, GAIN, PHASE, QUAD, ZERO = range(6)


def laws(sweeps: Sequence[Sweep]) -> OverTemperature:
    return find_laws(joined(sweeps), rng=np.random.default_rng(0))


def verdicts(found: OverTemperature) -> list[str]:
    return [law.verdict for law in found.factors]


def shown(found: OverTemperature, factor: int, power: int) -> tuple[float, float, float]:
    """Value and interval of a coefficient in the twin's unit; power 0 is the value at 25 C."""
    law, unit = found.factors[factor], FACTORS[factor].per_coordinate
    figure = (law.at_25, *law.per_power)[power].times(unit)
    return figure.value, figure.low, figure.high


@pytest.mark.parametrize("motion", [over(COLD_ROOM_HOT), drifting(points=180, turns=12)], ids=["steps", "drifting"])
def test_two_factors_sensitive_and_the_others_immune(motion: Motion) -> None:
    found = laws([warm().simulate(motion, seed=3)])
    assert verdicts(found) == [SENSITIVE, IMMUNE, SENSITIVE, IMMUNE, IMMUNE, IMMUNE]
    # The ratio at 25 C is 1.01, and the drift multiplies it.
    for factor, at_25, per_k in ((X, 0.75, X_PER_K), (GAIN, 1.01, 1.01 * 0.01 * GAIN_PER_K)):
        for power, truth in ((0, at_25), (1, per_k)):
            value, low, high = shown(found, factor, power)
            # 95 % intervals, widened by a third: of eight, at these seeds.
            assert abs(value - truth) < 1.33 * (high - value)
            assert low < value < high
        assert shown(found, factor, 1)[0] == pytest.approx(per_k, rel=0.1)
    assert found.noise_rad == pytest.approx(np.radians(FLOOR_DEG), rel=0.1)
    # At -40 and 85 C the two move the angle by 0.5 % and 0.76 % of a radian times their share of the turn.
    assert np.degrees(found.factors[Y].drift_below_rad) < FLOOR_DEG < np.degrees(found.factors[X].drift_rad)


def test_sweeps_at_one_temperature_each_say_the_same() -> None:
    sensors = {c: warm() for c in COLD_ROOM_HOT}
    sweeps = each_at(sensors)
    assert over_temperature(sweeps)
    assert not over_temperature(sweeps[:1])
    found = laws(sweeps)
    assert verdicts(found)[:3] == [SENSITIVE, IMMUNE, SENSITIVE]
    assert SENSITIVE not in verdicts(found)[3:]


def test_nothing_seen_is_no_proof_of_immunity() -> None:
    """Few readings: a drift by the noise floor could hide, so no factor of a steady sensor is immune."""
    found = laws([steady().simulate(over(COLD_ROOM_HOT, points=12, turns=1), seed=1)])
    assert set(verdicts(found)) == {NOT_TOLD}
    assert all(law.p_constant > 0.01 for law in found.factors)
    many = laws([steady().simulate(over(COLD_ROOM_HOT, points=360, turns=1), seed=1)])
    assert set(verdicts(many)) == {IMMUNE}


def test_a_drift_by_the_noise_floor_is_not_called_immune() -> None:
    """At 1 % over the family, of 15 sensors that drift by just the margin none or one is called immune."""
    # A per cent of offset moves the angle by 0.01 sin: 0.405 deg RMS. Over 125 K it is to make the floor.
    per_k = FLOOR_DEG / 0.4052 / 125.0
    motion = over(COLD_ROOM_HOT, points=24, turns=1)
    sensor = steady().with_effect("offset_drift", x_percent_per_K=per_k)
    words = [verdicts(laws([sensor.simulate(motion, seed=seed)]))[X] for seed in range(15)]
    assert words.count(IMMUNE) <= 1


@pytest.mark.parametrize("noise", [{"rms_deg": 0.02}, {"rms_deg": 0.02, "correlation": 0.8}], ids=["white", "coloured"])
def test_a_steady_sensor_is_not_called_sensitive(noise: dict[str, float]) -> None:
    """At 1 % over the family, of 10 steady sensors at most one; that neighbours go together must not fool it."""
    motion = over(COLD_ROOM_HOT, points=72, turns=1)
    words = [verdicts(laws([steady(noise).simulate(motion, seed=seed)])) for seed in range(10)]
    assert sum(SENSITIVE in one for one in words) <= 1


def test_structure_that_is_the_same_at_every_temperature_is_no_noise() -> None:
    sensor = warm({"rms_deg": 0.01}).with_effect("saturation", k_percent=0.5)
    sensor = sensor.with_effect("hysteresis", lag_deg=0.1, memory_deg=8.0)
    found = laws([sensor.simulate(over(COLD_ROOM_HOT, both=True), seed=2)])
    # Order 4 of 0.07 deg and a lag of 0.1 deg; what the memory leaves at each reversal alone passes for noise.
    assert found.noise_rad < np.radians(0.02)
    assert verdicts(found) == [SENSITIVE, IMMUNE, SENSITIVE, IMMUNE, IMMUNE, IMMUNE]


def test_a_bent_law_has_a_second_power_where_that_is_supported() -> None:
    bend = 2e-5

    def at(celsius: float) -> Chain:
        return steady().with_effect("offset", x_percent=0.75 + bend * (celsius - 25.0) ** 2, y_percent=-0.7)

    found = laws(each_at({c: at(c) for c in (-40.0, 0.0, 25.0, 60.0, 85.0)}))
    assert found.factors[X].verdict == SENSITIVE
    assert len(found.factors[X].per_power) == 2
    assert not found.factors[X].scatters
    value, _, high = shown(found, X, 2)
    assert abs(value - bend) < 1.5 * (high - value)
    straight = laws([warm().simulate(over((-40.0, 0.0, 25.0, 60.0, 85.0)), seed=1)])
    assert len(straight.factors[X].per_power) == 1


def test_scatter_about_any_law_widens_the_interval() -> None:
    """Offset x of each sweep at random, by thirty times what the noise explains: no law, and no certainty."""
    draws = np.random.default_rng(5).normal(0.75, 0.2, 5)
    sensors = {
        c: steady().with_effect("offset", x_percent=float(x), y_percent=-0.7)
        for c, x in zip((-40.0, 0.0, 25.0, 60.0, 85.0), draws, strict=True)
    }
    law = laws(each_at(sensors)).factors[X]
    assert law.scatters
    assert law.verdict == NOT_TOLD
    # The line through five values that scatter by 0.2 % has a slope known to 0.2 / (sqrt(5) 45 K) = 0.002 %/K.
    assert law.per_power[0].times(100.0).high - law.per_power[0].times(100.0).value > 0.002


def test_a_temperature_that_moves_with_the_angle_tells_nothing() -> None:
    motion = over((20.0,), points=180, turns=1)
    motion = replace(motion, temperature_c=np.linspace(20.0, 60.0, len(motion)))
    found = laws([warm().simulate(motion, seed=1)])
    assert found.power == 0
    assert set(verdicts(found)) == {NOT_TOLD}
    assert all(law.per_power == () for law in found.factors)


def test_two_close_levels_of_three_support_no_second_power() -> None:
    """As where a chamber that wavers about 20 C makes two levels of one."""
    for levels, power in (((20.0, 21.5, 60.0), 1), ((20.0, 40.0, 60.0), 2), ((20.0, 60.0), 1), ((40.0,), 0)):
        found = Levels(np.array(levels), np.zeros(1, dtype=np.int64))
        assert found.power(Span(20.0, 60.0)) == power


@pytest.mark.parametrize("by_deg", [0.05, 180.0])
def test_a_reference_set_anew_at_each_turn_leaves_the_zero_untold(by_deg: float) -> None:
    sweep = warm().simulate(over(COLD_ROOM_HOT, turns=4), seed=1)
    assert sweep.turn is not None
    anew = np.random.default_rng(1).uniform(-by_deg, by_deg, 12)[sweep.turn.astype(int)]
    found = laws([replace(sweep, reference_deg=sweep.reference_deg + anew)])
    assert found.own_zeros
    assert verdicts(found)[:3] == [SENSITIVE, IMMUNE, SENSITIVE]
    assert found.factors[ZERO].verdict == NOT_TOLD
    assert not found.followed[ZERO]
    assert found.noise_rad == pytest.approx(np.radians(FLOOR_DEG), rel=0.1)
    assert not laws([sweep]).own_zeros


def test_gross_errors_are_left_out() -> None:
    sweep = warm().simulate(over(COLD_ROOM_HOT), seed=1)
    measured = sweep.measured_deg.copy()
    measured[[5, 300]] += 30.0
    found = laws([replace(sweep, measured_deg=measured)])
    assert np.flatnonzero(found.gross).tolist() == [5, 300]
    assert verdicts(found)[:3] == [SENSITIVE, IMMUNE, SENSITIVE]


def test_a_single_wild_temperature_is_its_neighbours() -> None:
    sweep = warm().simulate(over(COLD_ROOM_HOT), seed=1)
    assert sweep.temperature_c is not None
    wild = sweep.temperature_c.copy()
    wild[[0, 100]] = 9000.0, -200.0
    np.testing.assert_array_equal(temperature_of(replace(sweep, temperature_c=wild)), sweep.temperature_c)
    at_one = np.full(len(sweep), 25.0)
    at_one[7] = 85.0
    assert not over_temperature([replace(sweep, temperature_c=at_one)])


def test_temperatures_that_take_turns_stay_as_they_are() -> None:
    sweep = warm().simulate(over(COLD_ROOM_HOT), seed=1)
    assert sweep.temperature_c is not None
    taking_turns = np.tile(np.array(COLD_ROOM_HOT, dtype=np.float64), len(sweep) // len(COLD_ROOM_HOT))
    found = temperature_of(replace(sweep, temperature_c=taking_turns))
    np.testing.assert_array_equal(found, taking_turns)


def test_a_sweep_that_counts_the_other_way_round_is_refused() -> None:
    first, second, third = each_at({c: warm() for c in COLD_ROOM_HOT})
    turned = replace(second, measured_deg=-second.measured_deg, name="turned.csv")
    with pytest.raises(UserError, match=r"turned.csv: its angle counts the other way round"):
        joined([first, turned, third])
