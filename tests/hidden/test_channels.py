"""Raw channels never make an answer worse: the comparison itself, and a small part of its study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from .channels import CHANNELS, compared, every
from .study import DEFAULT_ANSWERER, load


def _draw(label: str) -> tuple[Any, Any]:
    return next(every(only=frozenset({label}), draws=1, seed=41))


@pytest.mark.parametrize(
    ("given_with", "given_without", "worse"), [("hysteresis", "", True), ("", "hysteresis", False)]
)
def test_worse_is_what_the_channels_made_worse(
    tmp_path: Path, given_with: str, given_without: str, worse: bool
) -> None:
    """Of a clean sweep a name is false."""

    def answerer(path: str) -> Mapping[str, Any]:
        recorded = Path(path).read_text(encoding="utf-8").splitlines()[0].split(",")
        name = given_with if set(CHANNELS) <= set(recorded) else given_without
        return {"causes": [{"name": name}] if name else []}

    job, hidden = _draw("white_raw")
    assert compared(job, hidden, tmp_path, answerer).worse == worse


@pytest.mark.parametrize("label", ["block_raw", "universal_joint"])
def test_channels_make_no_answer_worse(tmp_path: Path, label: str) -> None:
    job, hidden = _draw(label)
    found = compared(job, hidden, tmp_path, load(DEFAULT_ANSWERER))
    assert not found.worse, found
    assert found.with_them == "right"
