"""Quantisation: the stairs that the set of values shows become part of the model before anything else is searched."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.marks.outliers import local_rms
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.quantisation import quantisation
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.sweeps import Made, before, noise, truth_of, with_residual
from twin.angles import TAU, Array
from twin.catalogue import find
from twin.cordic.cordic_truncation import CORDIC_TRUNCATION
from twin.effect import Effect
from twin.link.output_quantisation import OUTPUT_QUANTISATION

LIMITS = DiscoverySettings()
GRID = OUTPUT_QUANTISATION.name
BITS = 12
STEP = TAU / 2.0**BITS


def rounded(ahead: Array) -> State:
    """Readings on the grid, with this noise (n,) [rad] ahead of it."""
    state = before(quantisation, Made(points=ahead.size, bits=30))
    words = np.round((state.fit.linear.angle + ahead) / STEP)
    return with_residual(state, words * STEP - state.fit.linear.angle).with_(bits=BITS)


def on_a_grid(share: float) -> State:
    """Readings on a grid whose step/sqrt(12) is this share of their robust scatter, the grid's own included."""
    plain = noise(180)
    ahead = STEP / np.sqrt(12.0) * np.sqrt(1.0 / share**2 - 1.0)
    return rounded(plain * ahead / local_rms(plain))


@pytest.mark.parametrize(
    ("share", "modelled"),
    [(0.075, False), (0.13, True), (0.5, True), (0.9, True)],
)
def test_the_grid_is_modelled_where_it_is_not_small_against_the_noise(share: float, modelled: bool) -> None:
    state = on_a_grid(share)
    after = quantisation(state)
    assert (GRID in after.fit.chain.values) == modelled
    assert (after.fit.weighting.blur > 0.0) == modelled
    assert after.findings == ()
    if modelled:
        assert after.fit.chain.values[GRID] == {"bits": float(BITS)}


@pytest.mark.parametrize("ahead", [0.3, 0.6, 1.0])
def test_the_blur_of_the_stairs_is_the_noise_ahead_of_them(ahead: float) -> None:
    """In steps; the RMS of 720 readings is known to 2.6 %: four of these, and the words are tabled to 4 %."""
    plain = noise(720)
    after = quantisation(rounded(plain * ahead * STEP / np.sqrt(np.mean(plain**2))))
    assert after.fit.weighting.blur / STEP == pytest.approx(ahead, rel=4.0 / np.sqrt(2.0 * 720) + 0.04)


@pytest.mark.parametrize("known", [{"bits": 12.0}, {"bits": 10.0}])
def test_a_grid_that_is_known_stays_as_it_is(known: dict[str, float]) -> None:
    state = on_a_grid(0.5)
    state = state.with_(replace(state.fit, chain=state.fit.chain.with_values({GRID: known})))
    assert quantisation(state).fit.chain.values[GRID] == known


def test_without_a_word_length_there_is_no_grid() -> None:
    state = on_a_grid(0.9).with_(bits=None)
    after = quantisation(state)
    assert after.fit is state.fit
    assert after.findings == ()


@pytest.mark.parametrize("strength_deg", [0.4, 0.1, 0.025])
def test_the_finite_set_of_a_truncated_cordic_is_a_cause(strength_deg: float) -> None:
    made = Made(causes=(("cordic_truncation", strength_deg),), points=180)
    after = quantisation(before(quantisation, made))
    (cause,) = after.findings
    assert cause.keys == (CORDIC_TRUNCATION.name,)
    assert cause.log_p < LIMITS.effect_log_p(10)
    iterations = truth_of(made, CORDIC_TRUNCATION.name)["iterations"]
    assert after.fit.chain.values[CORDIC_TRUNCATION.name] == {"iterations": iterations}
    assert after.fit.weighting.blur > 0.0


@dataclass(frozen=True, kw_only=True)
class Half:
    """So many different words, all in one half of the cells, where so many levels of so many effects are tried."""

    words: int
    tried: int
    enough: bool
    effects: int = 1


HALVES = {
    # Each set is tried as it is and a cell wider. log(0.01 / 4) - log(20) = -8.99 for one effect: thirteen halves are
    # -9.01, twelve -8.32.
    "ten levels, just enough": Half(words=13, tried=10, enough=True),
    "ten levels, one too few": Half(words=12, tried=10, enough=False),
    # log(0.01 / 4) - log(2) = -6.68: ten halves are -6.93, nine -6.24.
    "one level, just enough": Half(words=10, tried=1, enough=True),
    "one level, one too few": Half(words=9, tried=1, enough=False),
    # log(0.01 / 4 / 3) - log(2) = -7.78: twelve halves are -8.32, eleven -7.62.
    "one of three effects, just enough": Half(words=12, tried=1, effects=3, enough=True),
    "one of three effects, one too few": Half(words=11, tried=1, effects=3, enough=False),
}


def half_of_the_cells(tried: int) -> Effect:
    """An effect that leaves the even words of a turn, at each of so many levels."""
    even = np.arange(0, 2**BITS, 2) * STEP
    return replace(
        find(CORDIC_TRUNCATION.name),
        attainable=lambda values: even,
        shapes=lambda motion: [{"iterations": float(level)} for level in range(1, tried + 1)],
        stair=lambda values: 0.0,
    )


@pytest.mark.parametrize("case", HALVES.values(), ids=HALVES)
def test_chance_is_shared_by_the_levels_that_are_tried(case: Half) -> None:
    state = before(quantisation, Made(points=180, bits=30))
    words = 2 * (np.arange(180) % case.words)
    # The others leave all words, and cannot be told.
    everywhere = np.arange(2**BITS) * STEP
    effect = half_of_the_cells(case.tried)
    others = [
        replace(effect, name=f"all_{number}", attainable=lambda values: everywhere)
        for number in range(case.effects - 1)
    ]
    effects = (effect, *others)
    sweep = replace(state.sweep, measured_deg=np.degrees(words * STEP))
    state = state.with_(sweep=sweep, start=replace(state.start, effects=effects), bits=BITS)
    assert len(quantisation(state).findings) == int(case.enough)
