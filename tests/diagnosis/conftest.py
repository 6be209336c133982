"""Long studies run on request only: ``pytest -m study tests/diagnosis``."""

from __future__ import annotations

import pytest


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if "study" in str(config.getoption("markexpr")):
        return
    for item in items:
        if item.get_closest_marker("study") is not None:
            item.add_marker(pytest.mark.skip(reason="a long study: run with -m study"))
