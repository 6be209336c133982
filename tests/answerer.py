"""The answer that a study asks for unless it is told of another program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnosis import explain


def explain_file(path: str) -> Mapping[str, Any]:
    """The JSON answer of ``halltwin explain`` to a sweep file."""
    return explain(path).to_dict()
