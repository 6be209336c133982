"""Spread: what makes some rows louder than others is named, judged on what the search leaves, and weighs the rows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from diagnosis.discovery.finding import Finding
from diagnosis.discovery.marks.row_masks import scaled
from diagnosis.discovery.settings import DiscoverySettings
from diagnosis.discovery.stages.spread import spread
from diagnosis.discovery.state import State
from tests.diagnosis.discovery.spreads import Loud, handed
from twin.catalogue import find, unnamed

LIMITS = DiscoverySettings()
JITTER, BURST, BUMP = "reference_jitter", "unnamed_burst", "unnamed_bump"


@dataclass(frozen=True, kw_only=True)
class Case:
    """What is loud, the causes found, the noise in force, how many effects may show in the spread, what is named."""

    loud: Loud
    keys: tuple[str, ...] = ()
    member: int = 0
    family: int = 2
    named: str | None = None


CASES = {
    "even noise": Case(loud=Loud()),
    "shape, too weak": Case(loud=Loud(jitter_percent=0.04)),
    "shape, strong enough": Case(loud=Loud(jitter_percent=0.045), named=JITTER),
    "among more effects, too weak": Case(loud=Loud(jitter_percent=0.045), family=20),
    "among more effects, strong enough": Case(loud=Loud(jitter_percent=0.05), family=20, named=JITTER),
    "stretch, too weak for one without a name": Case(loud=Loud(stretch=1.7)),
    "stretch, strong enough": Case(loud=Loud(stretch=1.75), named=BURST),
    "beside a shape without a name, too weak": Case(loud=Loud(jitter_percent=0.055), keys=(BUMP,)),
    "beside a shape without a name, strong enough": Case(loud=Loud(jitter_percent=0.06), keys=(BUMP,), named=JITTER),
    "beside one in coloured noise, too weak": Case(loud=Loud(jitter_percent=0.055), keys=(BUMP,), member=1),
    "beside a named cause": Case(loud=Loud(jitter_percent=0.045), keys=("saturation",), named=JITTER),
}


def state_of(case: Case) -> State:
    state = handed(spread, case.loud).with_(keys=case.keys)
    # Others that may show there, and do not.
    silent = [replace(find(BURST), name=f"silent_{number}") for number in range(case.family - 2)]
    state = state.with_(start=replace(state.start, effects=(*state.start.effects, *silent)))
    return state.with_(replace(state.fit, weighting=replace(state.fit.weighting, member=case.member)))


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_is_named(case: Case) -> None:
    state = state_of(case)
    after = spread(state)
    assert [finding.keys for finding in after.findings] == ([] if case.named is None else [(case.named,)])
    assert (after is state) == (case.named is None)
    if case.named is not None:
        (finding,) = after.findings
        # One family with all effects that may show in the spread; a shape without a name has to gain more, and so has
        # any cause beside one. Near to the limit: half of it or twice as much would be noticed.
        limit = LIMITS.effect_log_p(case.family)
        assert finding.family_log_p == pytest.approx(finding.log_p + np.log(case.family))
        odds = LIMITS.unnamed_log_odds * (unnamed(case.named) + (case.keys == (BUMP,)))
        assert 2.0 * limit < finding.log_p + odds < limit
        assert finding.keys[0] in after.fit.chain.values
        assert not np.all(after.fit.observations.scale == 1.0)


def test_of_two_the_more_improbable_is_named() -> None:
    """A stretch 1.8 times as loud, and jitter that stands out far more; the other way round."""
    (shape,) = spread(handed(spread, Loud(stretch=1.8, jitter_percent=0.1))).findings
    (stretch,) = spread(handed(spread, Loud(stretch=4.0, jitter_percent=0.05))).findings
    assert (shape.keys, stretch.keys) == ((JITTER,), (BURST,))


@pytest.mark.parametrize("percent", [0.1, 0.3])
def test_the_size_of_a_converters_jitter_lies_in_its_interval(percent: float) -> None:
    (finding,) = spread(handed(spread, Loud(jitter_percent=percent))).findings
    low, high = finding.intervals["reference_jitter", "percent_rms"]
    assert low < percent < high
    # 360 squares in all, half of them loud: a variance is known to a tenth, and a size to half of that.
    assert high - low < 0.4 * percent


def test_where_is_said_of_a_stretch() -> None:
    after = spread(handed(spread, Loud(stretch=4.0)))
    values = after.fit.chain.values[BURST]
    assert abs(values["first_row"] - Loud().first) <= 6
    assert abs(values["last_row"] - (Loud().first + Loud().length - 1)) <= 6
    # Beyond the noise of 0.02 deg, in squares; 40 readings tell it to a tenth.
    assert values["rms_deg"] == pytest.approx(0.02 * np.sqrt(4.0**2 - 1.0), rel=0.3)


def test_it_is_judged_once() -> None:
    state = handed(spread, Loud(stretch=4.0)).with_(findings=(Finding.among(1, JITTER, -30.0, gain=60.0),))
    assert spread(state) is state


def test_a_scale_that_no_cause_carries_goes() -> None:
    state = handed(spread, Loud())
    loud = np.ones(len(state.sweep))
    loud[100:140] = 4.0
    after = spread(state.with_(scaled(state.fit, loud)))
    assert np.all(after.fit.observations.scale == 1.0)
    assert after.findings == ()
    assert spread(after) is after


def test_a_scale_that_is_named_stays() -> None:
    state = handed(spread, Loud(stretch=4.0))
    loud = np.ones(len(state.sweep))
    loud[100:140] = 16.0
    after = spread(state.with_(scaled(state.fit, loud)))
    assert [finding.keys for finding in after.findings] == [(BURST,)]
    assert np.max(after.fit.observations.scale) == pytest.approx(4.0, rel=0.25)
