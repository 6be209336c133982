"""The guide as the page's help: each view leads to its page, which is read on a wide and a narrow screen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from scenarios.commands.guide.site import site
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, complaints, cut_off
from tests.scenarios.lab.serving import Client

pytestmark = pytest.mark.skipif(BROWSER is None, reason=WHY_SKIPPED)
HELP = {"design": "guide/choose_magnet.html", "explain": "guide/explain_sweep.html", "bench": "guide/bench.html"}
WIDE = """[...document.querySelectorAll("main *")].filter((one) => one.getBoundingClientRect().right > innerWidth + 1
    && !one.closest(".scroll, pre")).map((one) => one.outerHTML.slice(0, 80))"""


@pytest.fixture(autouse=True)
def nothing_wrong(page: Page) -> Iterator[None]:
    page.browser.events.clear()
    yield
    assert complaints(page.browser) == []


def read(page: Page, client: Client, name: str) -> None:
    """Open a page of the guide in the place of the other."""
    page.call("Page.navigate", url=f"{client.server.guard.url}guide/{name}")
    page.until(f"location.pathname.endsWith('/{name.partition('#')[0]}') && document.readyState === 'complete'")


def test_each_view_leads_to_its_page(page: Page) -> None:
    for view, target in HELP.items():
        links: list[str] = page.of(f"[...document.querySelectorAll('#{view} p.help a')].map((one) => one.href)")
        assert len(links) == 1
        assert f"/{target}" in links[0]
    assert page.of("document.querySelector('.bar a.help').href").endswith("/guide/index.html")


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [1280, 390])
def test_pages_fit_the_screen(page: Page, client: Client, width: int, dark: bool) -> None:
    page.resize(width, dark=dark)
    for name in sorted(name for name in site() if name.endswith(".html")):
        read(page, client, name)
        assert cut_off(page, width) == [], name
        assert page.of(WIDE) == [], name
        assert page.of("getComputedStyle(document.body).fontFamily").startswith("system-ui"), name


def test_it_asks_nobody_but_the_program(page: Page, client: Client) -> None:
    read(page, client, "first_walk.html")
    asked: list[str] = page.of("performance.getEntriesByType('resource').map((one) => one.name)")
    assert len(asked) == 6
    assert {url[: len(client.server.guard.url)] for url in asked} == {client.server.guard.url}
    assert page.of("[...document.images].every((one) => one.naturalWidth > 600)")


def test_a_row_of_the_catalogue_is_led_to(page: Page, client: Client) -> None:
    read(page, client, "catalogue.html#hysteresis")
    page.until("Math.abs(document.getElementById('hysteresis').getBoundingClientRect().top) < 40")
    drawn = page.of("getComputedStyle(document.querySelector('#hysteresis .back')).strokeDasharray")
    assert drawn == "4px, 3px"


def test_rows_of_the_catalogue_are_blocks_on_a_phone(page: Page, client: Client) -> None:
    """Each cell below the other, with its column's head; nothing to scroll sideways."""
    page.resize(390)
    read(page, client, "catalogue.html")
    assert page.of("[...document.querySelectorAll('.scroll')].every((one) => one.scrollWidth <= one.clientWidth + 1)")
    heads = page.of("[...document.querySelectorAll('#hysteresis td')].map((one) => one.dataset.head)")
    assert heads[:3] == ["cause", "stage", "parameters"]
    assert (
        page.of("getComputedStyle(document.querySelectorAll('#hysteresis td')[1], '::before').content") == '"stage: "'
    )


@pytest.mark.parametrize("name", ["catalogue", "how_good"])
def test_no_table_is_cut_off_on_a_wide_screen(name: str, page: Page, client: Client) -> None:
    page.resize(1280)
    read(page, client, f"{name}.html")
    assert page.of("[...document.querySelectorAll('.scroll')].every((one) => one.scrollWidth <= one.clientWidth + 1)")


def test_a_picture_of_it(page: Page, client: Client, tmp_path: Path) -> None:
    read(page, client, "choose_magnet.html")
    page.picture(tmp_path / "guide.png")
    assert (tmp_path / "guide.png").stat().st_size > 20_000
