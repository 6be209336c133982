"""What a fit asks of a chain thousands of times is worked out once, and is still that of the chain asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from twin import operations
from twin.catalogue import CATALOGUE, find
from twin.chain import Chain
from twin.operations import operations_of

OFFSET = "offset"


def test_the_same_effects_are_put_in_order_once() -> None:
    assert operations_of(CATALOGUE) is operations_of(CATALOGUE)
    assert [one.name for one in operations_of(CATALOGUE[:3])] != [one.name for one in operations_of(CATALOGUE)]


def test_an_effect_is_that_of_the_effects_asked() -> None:
    other = tuple(replace(one, signature="of other effects") if one.name == OFFSET else one for one in CATALOGUE)
    assert find(OFFSET, other) is not find(OFFSET)
    assert find(f"{OFFSET}#2") is find(OFFSET)


def test_what_acts_is_worked_out_once_for_each_chain(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    plain = operations.aligned
    monkeypatch.setattr(operations, "aligned", lambda *given: asked.append(given[2]) or plain(*given))
    chain = Chain().with_effect(OFFSET, x_percent=1.0)
    ((key, _, values),) = chain.active("channels")
    count = len(asked)
    assert list(chain.active("channels"))
    assert len(asked) == count
    assert (key, values["x_percent"]) == (OFFSET, 1.0)
    ((_, _, values),) = chain.with_effect(OFFSET, x_percent=2.0).active("channels")
    assert values["x_percent"] == 2.0


@pytest.mark.parametrize("value", [0.0, np.float64(0.0), np.zeros(3), np.zeros((2, 1, 1))])
def test_a_value_at_null_is_so_in_any_shape(value: object) -> None:
    assert find(OFFSET).params["x_percent"].at_null(value)
    assert not find(OFFSET).params["x_percent"].at_null(np.asarray(value) + np.array([0.0, 1.0])[:, None, None])
