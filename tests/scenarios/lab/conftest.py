"""A server of the page, and the page in a browser; both for all tests of a file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.scenarios.lab.browser import Page, browsing, opened
from tests.scenarios.lab.serving import Client, serving


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    """Asks a server of its own."""
    with serving(tmp_path_factory.mktemp("lab")) as one:
        yield one


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the browser saves what it downloads."""
    return tmp_path_factory.mktemp("saved")


@pytest.fixture(scope="module")
def page(client: Client, saved: Path) -> Iterator[Page]:
    """The server's page."""
    with browsing(saved) as browser:
        yield opened(browser, client.server.guard.url, saved)
