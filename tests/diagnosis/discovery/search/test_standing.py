"""Standing: which rivals are the same from one examination of a cause to the next."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from diagnosis.discovery.search.standing import form_of
from diagnosis.discovery.stages.stepwise import stepwise
from tests.diagnosis.discovery.searches import candidate
from tests.diagnosis.discovery.sweeps import Made, before
from twin.catalogue import find

# Ten turns in 60 s: two lines are told apart by a tenth of an order, or by 0.017 Hz.
TEN_TURNS = Made(points=40, turns=10, rpm=(10.0,), bits=30)


@pytest.mark.parametrize(
    ("name", "one", "other", "same"),
    [
        ("magnet_harmonic", {"order": 3.0, "amplitude_deg": 0.1}, {"order": 3.0, "amplitude_deg": 0.2}, True),
        ("magnet_harmonic", {"order": 3.0, "amplitude_deg": 0.1}, {"order": 4.0, "amplitude_deg": 0.1}, False),
        ("unnamed_order", {"order": 3.33}, {"order": 3.335}, True),
        ("unnamed_order", {"order": 3.33}, {"order": 3.53}, False),
        ("unnamed_tone", {"frequency_Hz": 0.5}, {"frequency_Hz": 0.501}, True),
        ("unnamed_tone", {"frequency_Hz": 0.5}, {"frequency_Hz": 0.55}, False),
    ],
)
def test_another_order_or_frequency_is_another_rival(
    name: str, one: Mapping[str, float], other: Mapping[str, float], same: bool
) -> None:
    fit = before(stepwise, TEN_TURNS).fit
    assert (form_of(candidate(name, fit, **one), fit) == form_of(candidate(name, fit, **other), fit)) == same


def test_another_place_of_the_grid_is_another_rival() -> None:
    fit = before(stepwise, TEN_TURNS).fit
    effect = find("unnamed_bump")
    first, *_, last = effect.shapes(fit.linear.motion)
    near = {key: value * (1.0 + 1e-6) for key, value in first.items()}
    forms = [form_of(candidate("unnamed_bump", fit, **shape), fit) for shape in (first, near, last)]
    assert forms[0] == forms[1] != forms[2]
