"""What has changed since a twin was made: a few pairs of the study ``python -m tests.changed_twin``."""

from __future__ import annotations

import pytest

from tests.changed_twin import outcome
from tests.hidden.changed import ANOTHER, NOTHING

PAIRS = (("offset_y", 0), ("hysteresis", 4), ("latency", 0))
"""A factor, a cause of the twin that grows, and one that appears."""


@pytest.mark.parametrize(("kind", "number"), PAIRS)
def test_what_has_changed_is_named_and_nothing_else(kind: str, number: int) -> None:
    found = outcome(kind, number, seed=11)
    assert found.named, found.said
    assert found.extra == ()
    assert not found.other_device


def test_a_remounted_sensor_has_not_changed() -> None:
    assert outcome(NOTHING, 0, seed=11).said == ()


def test_the_twin_of_another_device_is_known_as_such() -> None:
    assert outcome(ANOTHER, 0, seed=11).other_device
