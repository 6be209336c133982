"""Flipped bits: single readings that are off by the size of a bit, judged on what the causes leave."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.flipped_bits import flipped_bits
from tests.diagnosis.discovery.claims import claiming, with_effects
from tests.diagnosis.discovery.stages.test_repeated_frames import rows_hit
from tests.diagnosis.discovery.sweeps import Made, before, noise, with_residual

LIMIT = DiscoverySettings().footprint_log_p
STALE, GLITCH = "stale_frames", "bus_glitch"
CLEAN = Made(turns=2)
MADE = Made(causes=((GLITCH, 0.05),), turns=2)
BOTH = Made(causes=((STALE, 0.05), (GLITCH, 0.05)), turns=2)


@pytest.mark.parametrize("made", [MADE, BOTH])
def test_the_words_that_were_hit_are_named(made: Made) -> None:
    after = flipped_bits(before(flipped_bits, made))
    (cause,) = [finding for finding in after.findings if finding.keys == (GLITCH,)]
    assert cause.rows == rows_hit(made, GLITCH)
    # Five effects are looked for in the sequence.
    assert cause.family_log_p == pytest.approx(cause.log_p + np.log(5.0))
    assert cause.family_log_p < LIMIT
    assert set(cause.rows) <= set(np.flatnonzero(after.touched))
    assert flipped_bits(after) is after


def test_a_reading_belongs_to_one_effect_alone() -> None:
    """Repeats are off by a step of the shaft, 2 deg, which is no bit: had they not been spoken for, none were named."""
    state = before(flipped_bits, BOTH)
    assert tuple(np.flatnonzero(state.touched)) == rows_hit(BOTH, STALE)
    forgotten = state.with_(touched=np.zeros_like(state.touched))
    assert [finding.keys for finding in flipped_bits(forgotten).findings] == [(STALE,)]


@dataclass(frozen=True, kw_only=True)
class Off:
    """Rows that are off by so many degrees, and whether they are named."""

    off_deg: float
    named: bool
    rows: tuple[int, ...] = (65, 200, 290)


OFF = {
    "a bit": Off(off_deg=360.0 / 2**5, named=True),
    "no bit": Off(off_deg=360.0 / 2**4.5, named=False),
    "one bit once": Off(off_deg=360.0 / 2**4, rows=(65,), named=False),
    # Seven sigma of the noise is the least that stands out.
    "a bit within the noise": Off(off_deg=360.0 / 2**12, named=False),
    # More than one reading in twenty is no rare event.
    "too many": Off(off_deg=360.0 / 2**5, rows=tuple(range(0, 360, 18)), named=False),
}


@pytest.mark.parametrize("case", OFF.values(), ids=OFF)
def test_an_error_that_is_no_bit_is_not_named(case: Off) -> None:
    state = before(flipped_bits, CLEAN)
    residual = noise(len(state.sweep))
    residual[list(case.rows)] += np.radians(case.off_deg)
    state = with_residual(state, residual)
    after = flipped_bits(state)
    assert [finding.rows for finding in after.findings] == ([case.rows] if case.named else [])
    assert (after is state) == (not case.named)


@pytest.mark.parametrize(("margin", "named"), [(-0.1, True), (0.1, False)])
@pytest.mark.parametrize("early", [True, False])
@pytest.mark.parametrize("family", [1, 3])
def test_a_claim_is_believed_by_its_probability(margin: float, named: bool, early: bool, family: int) -> None:
    """Those that are looked for first are looked for once more in what is left at the end."""
    claims = LIMIT - np.log(family) + margin
    silent = [claiming(STALE, (), 0.0, early=True) for _ in range(family - 1)]
    state = with_effects(before(flipped_bits, CLEAN), claiming(GLITCH, (40, 90), claims, early=early), *silent)
    after = flipped_bits(state)
    assert (after is state) == (not named)
    assert tuple(np.flatnonzero(after.touched)) == ((40, 90) if named else ())


def test_what_has_been_found_is_not_looked_for_again() -> None:
    state = with_effects(before(flipped_bits, CLEAN), claiming(STALE, (40, 90), -50.0, early=True))
    state = state.with_(findings=(Finding.among(1, STALE, -20.0, gain=40.0),))
    assert flipped_bits(state) is state
