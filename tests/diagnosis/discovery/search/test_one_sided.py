"""At one speed a wave in time that the angle carries to both sides is looked for where both sides are seen."""

from __future__ import annotations

import numpy as np
import pytest

from diagnosis.discovery.fitting.initial_fit import baseline_fit, unfitted
from diagnosis.discovery.fitting.observations import collect
from diagnosis.discovery.search.screening import Base, Candidate, gains_of, one_sided, screen_one
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.spin.of_log import sweeps_of
from twin.angles import TAU, Array
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.spin import Spin
from twin.sweep import Sweep

TIME = np.arange(3000) / 1000.0
SHAFT = TAU * (8.0 * TIME + 0.1 * TIME**2)
"""From 8 to 8.6 turns a second."""
PHASE = TAU * 137.0 * TIME + 0.4
SIZE = 5e-4


def candidate(wave: Array) -> Candidate | None:
    """A ripple at its best shape in readings (n,) [rad] that are off by this wave and by noise of 3e-4 rad."""
    read = SHAFT + wave + 3e-4 * np.random.default_rng(1).standard_normal(TIME.size)
    sweep = Sweep(reference_deg=np.degrees(SHAFT), measured_deg=np.mod(np.degrees(read), 360.0), time_s=TIME)
    fit = baseline_fit(unfitted(collect(sweep), Chain(), DiscoverySettings()))
    return screen_one(Base.of(fit), find("reference_ripple", CATALOGUE))


def near(found: Candidate | None, frequency_hz: float) -> bool:
    return found is not None and abs(found.values["frequency_Hz"] - frequency_hz) < 1.0 and found.gain > 50.0


def test_a_ripple_shows_on_both_sides() -> None:
    assert near(candidate(SIZE * np.cos(PHASE) * np.sin(2.0 * SHAFT)), 137.0)


@pytest.mark.parametrize("side", [2.0, -2.0])
def test_a_wave_on_one_side_is_no_ripple(side: float) -> None:
    assert not near(candidate(0.5 * SIZE * np.cos(PHASE + side * SHAFT)), 137.0)


def test_a_ripple_whose_lower_side_is_weaker_by_chance_is_one() -> None:
    wave = 0.5 * SIZE * (np.cos(PHASE + 2.0 * SHAFT) - 0.6 * np.cos(PHASE - 2.0 * SHAFT))
    assert near(candidate(wave), 137.0)


def test_a_ripple_is_found_beside_a_stronger_wave_on_one_side() -> None:
    other = np.cos(TAU * 61.0 * TIME + 2.0 * SHAFT)
    assert near(candidate(SIZE * (np.cos(PHASE) * np.sin(2.0 * SHAFT) + other)), 137.0)


def test_a_side_that_the_shafts_own_motion_hides_leaves_a_wave_without_a_name() -> None:
    """Without a reference: a tenth of a Hz above two orders of the speed the lower side is as slow as the shaft."""
    shaft = TAU * 8.0 * TIME
    read = shaft + SIZE * np.cos(TAU * 16.1 * TIME) * np.sin(2.0 * shaft)
    read = read + 3e-4 * np.random.default_rng(1).standard_normal(TIME.size)
    (sweep,) = sweeps_of([Spin.from_columns({"time_s": TIME, "measured_deg": np.mod(np.degrees(read), 360.0)})])
    base = Base.of(baseline_fit(unfitted(collect(sweep), Chain(), DiscoverySettings())))
    effect = find("reference_ripple", CATALOGUE)
    assert effect.line is not None
    shapes = [{"frequency_Hz": 16.1}]
    assert gains_of(base, effect, [{**effect.null(), **shapes[0]}])[0][0, 0] > 50.0
    assert one_sided(base, effect, effect.line, shapes).all()
