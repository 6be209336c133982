"""Further measurements: what would part each cause from its rivals, by how much, cheapest first."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
import pytest

from diagnosis.discovery.further.measurements import MENU
from diagnosis.discovery.further.power import advice
from diagnosis.discovery.stages.further_measurements import further_measurements
from tests.diagnosis.discovery.sweeps import Made, before

COSTS = {entry.name: entry.cost for entry in MENU}


@dataclass(frozen=True, kw_only=True)
class Case:
    """A cause, its rival, a measurement that parts them and one that does not; none: it has no rival."""

    made: Made
    rival: str = ""
    parts: str = ""
    parts_not: str = ""


CASES = {
    # The radius has the order 4 of saturation and none of a magnet's harmonic.
    "saturation in a turn": Case(
        made=Made(causes=(("saturation", 0.08),), points=120),
        rival="magnet_harmonic",
        parts="raw channels",
        parts_not="other direction",
    ),
    # A lag behind the speed is twice as large at twice of it, hysteresis is not.
    "latency at one speed": Case(
        made=Made(causes=(("latency", 0.1),), points=72, rpm=(300.0,), back=True, left_out=("turn",)),
        rival="hysteresis",
        parts="second speed",
        parts_not="raw channels",
    ),
    # A slip happens once, play is taken up at every reversal.
    "backlash and one reversal": Case(
        made=Made(causes=(("backlash", 0.1),), points=72, turns=2, back=True),
        rival="index_slip",
        parts="more turns",
        parts_not="raw channels",
    ),
    "harmonic of order 5": Case(made=Made(causes=(("magnet_harmonic", 0.05),), points=120, seed=2)),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_what_would_part_a_cause_from_its_rivals(case: Case) -> None:
    state = before(further_measurements, case.made)
    after = further_measurements(state)
    (cause,), (plain,) = after.causes, state.causes
    assert (case.rival in cause.rivals) == bool(case.rival)
    if not case.rival:
        assert cause.options == ()
        return
    sigma = {option.name: option.parted[case.rival] for option in cause.options}
    assert all(option.sigma == min(option.parted.values()) for option in cause.options)
    assert sigma[case.parts] > 5.0
    assert sigma[case.parts_not] < 3.0
    costs = [option.cost for option in cause.options]
    assert costs == sorted(costs)
    assert all(option.cost == COSTS[option.name] for option in cause.options)
    # All else of the entry stands.
    assert (cause.keys, cause.log_p, cause.before_deg) == (plain.keys, plain.log_p, plain.before_deg)
    assert after.fit is state.fit


def test_channels_part_a_magnets_harmonic_from_saturation() -> None:
    (cause,) = further_measurements(before(further_measurements, CASES["saturation in a turn"].made)).causes
    assert set(cause.rivals) == {"magnet_harmonic", "adc_inl"}
    # An S of the converter is the same curve, channel by channel.
    assert re.search(r"from magnet_harmonic: record vx and vy \(\d+ sigma", advice(cause.options))


def test_what_the_sweep_has_already_is_not_offered() -> None:
    state = before(further_measurements, CASES["latency at one speed"].made)
    (cause,) = further_measurements(state).causes
    assert not {"time stamps", "other direction"} & {option.name for option in cause.options}


def test_twice_the_strength_parts_them_by_twice_as_many_sigma() -> None:
    """Both are linear in the strength; what the noise adds to the fitted strength is a tenth of it."""
    sigma = []
    for strength_deg in (0.05, 0.1):
        made = Made(causes=(("saturation", strength_deg),), points=120)
        (cause,) = further_measurements(before(further_measurements, made)).causes
        (channels,) = (option for option in cause.options if option.name == "raw channels")
        sigma.append(channels.parted["magnet_harmonic"])
    assert sigma[1] / sigma[0] == pytest.approx(2.0, rel=0.2)
    assert np.isfinite(sigma).all()
