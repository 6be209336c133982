"""Intervals over a class of causes, and what is said of them."""

from __future__ import annotations

from typing import Any

from diagnosis.report.over_class import in_factors_words, open_words, over_class
from diagnosis.report.wording import with_unit


def factor(value: float, half: float) -> dict[str, Any]:
    return {"value": value, "low": value - half, "high": value + half, "unit": "deg", "at_bound": False}


def test_an_interval_holds_those_of_all_that_explains_the_sweep_as_well() -> None:
    named = {"beta_deg": factor(1.0, 0.1), "zero_deg": factor(2.0, 0.1)}
    others = [
        ("first", {"beta_deg": factor(3.0, 0.5), "zero_deg": factor(2.0, 0.05)}),
        ("second", {"beta_deg": factor(0.95, 0.2), "zero_deg": factor(2.0, 0.05)}),
    ]
    found = over_class(named, others)
    assert (found["beta_deg"]["low"], found["beta_deg"]["high"]) == (0.75, 3.5)
    assert found["beta_deg"]["value"] == 1.0
    assert found["beta_deg"]["as_named"] == [0.9, 1.1]
    # The second widens it by less than half: it is told as known as it is, and by the first alone as a range.
    assert found["beta_deg"]["open_by"] == ["first"]
    assert found["zero_deg"] == named["zero_deg"]
    assert over_class(named, []) == named


def test_what_is_open_is_told_as_a_range_with_what_opens_it() -> None:
    found = over_class({"beta_deg": factor(1.0, 0.1)}, [("first", {"beta_deg": factor(3.0, 0.5)})])
    assert with_unit(found["beta_deg"]) == "0.9 to 3.5 deg"
    told = {"extended": {"parameters": found}}
    words = open_words({**told, "causes": [{"indistinguishable_from": ["first"]}]})
    assert words == "Ranges: first in its cause's place may put phase anywhere there"
    assert open_words({**told, "causes": []}) == "Ranges: first beside may put phase anywhere there"
    near = over_class({"beta_deg": factor(1.0, 0.1)}, [("first", {"beta_deg": factor(1.02, 0.1)})])
    assert with_unit(near["beta_deg"]) == "1.00 ±0.11 deg"
    assert open_words({"extended": {"parameters": near}, "causes": []}) == ""


def test_what_the_factors_hold_is_said() -> None:
    said = "What one, two or three may do to the angle stands in the factors above"
    assert in_factors_words({"in_factors": ["one", "two", "three"]}) == said
    assert in_factors_words({"in_factors": []}) == ""
