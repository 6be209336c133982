"""What a screen reader is told of the page: the browser's own accessibility tree, and what is announced meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from tests.command_line import halltwin
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, complaints
from tests.scenarios.lab.test_explain import TWIN
from tests.scenarios.lab.test_page import AT_REST

pytestmark = pytest.mark.skipif(BROWSER is None, reason=WHY_SKIPPED)
NAMED = (
    *("button", "link", "slider", "spinbutton", "combobox", "checkbox", "textbox", "image", "progressbar", "table"),
    *("form", "region", "tab", "tabpanel", "tablist", "heading", "columnheader", "rowheader"),
)
FOCUSED = """((one) => one.ariaLabel || one.labels?.[0]?.textContent.trim() || one.textContent.trim())(
    document.activeElement)"""
HEARD = """(() => {
    window.listening?.forEach((one) => one.disconnect());
    window.heard = [];
    window.listening = [...document.querySelectorAll("[aria-live], [role=status]")].map((one) => {
        const listens = new MutationObserver(() => window.heard.push(one.textContent));
        listens.observe(one, { childList: true, subtree: true, characterData: true });
        return listens;
    });
})()"""
"""Begins to listen to all that is announced; ``window.heard`` has it."""


@pytest.fixture(autouse=True)
def begun(page: Page) -> Iterator[None]:
    page.browser.events.clear()
    page.call("Accessibility.enable")
    page.until(AT_REST)
    yield
    assert complaints(page.browser) == []


def told(page: Page) -> list[tuple[str, str, dict[str, Any]]]:
    """Role, name and properties of each node that a reader meets, in the order of the document."""
    nodes = {node["nodeId"]: node for node in page.call("Accessibility.getFullAXTree")["nodes"]}
    found: list[tuple[str, str, dict[str, Any]]] = []

    def visit(node: dict[str, Any]) -> None:
        if not node["ignored"]:
            properties = {one["name"]: one["value"].get("value") for one in node.get("properties", [])}
            found.append((node["role"]["value"], node.get("name", {}).get("value", ""), properties))
        for child in node.get("childIds", []):
            if child in nodes:
                visit(nodes[child])

    visit(next(node for node in nodes.values() if "parentId" not in node))
    return found


def names(page: Page, role: str) -> list[str]:
    return [name for kind, name, _ in told(page) if kind == role]


def check_names(page: Page) -> None:
    """Whatever can be met has a name, and what can be set a name of its own."""
    nodes = told(page)
    assert [(role, name) for role, name, _ in nodes if role in NAMED and not name.strip()] == []
    settable = [(role, name) for role, name, _ in nodes if role in ("slider", "spinbutton", "combobox", "checkbox")]
    assert len(settable) == len(set(settable))


def check_headings(page: Page) -> None:
    """One of the first level, and none a level below one that is missing."""
    levels = [properties["level"] for role, _, properties in told(page) if role == "heading"]
    assert levels.count(1) == 1
    assert levels[0] == 1
    assert all(below - above <= 1 for above, below in pairwise(levels)), levels


def test_the_page_has_a_frame_that_can_be_jumped_in(page: Page) -> None:
    nodes = told(page)
    roles = [role for role, _, _ in nodes]
    for role in ("banner", "main", "tablist", "tabpanel"):
        assert roles.count(role) == 1, role
    tabs = [(name, properties["selected"]) for role, name, properties in nodes if role == "tab"]
    assert tabs == [("Design", True), ("Explain", False), ("Bench", False)]
    assert names(page, "tabpanel") == ["Design"]
    check_headings(page)


def test_everything_has_a_name(page: Page) -> None:
    check_names(page)
    assert "Guide" in names(page, "link")


def test_pictures_say_what_they_show(page: Page) -> None:
    """The span of the curves, and where on the map the design stands."""
    pictures = names(page, "image")
    assert len(pictures) == 5
    error = next(name for name in pictures if name.startswith("Angle error"))
    assert "from \u22120." in error
    assert "near 6 mm and 2.5 mm 0.3" in next(name for name in pictures if name.startswith("Largest error over"))


def test_the_way_by_keys_is_that_of_the_eye(page: Page) -> None:
    """From the head to the drawing, to the pictures' buttons and to the numbers; and nothing on it is out of sight."""
    page.of("document.activeElement.blur()")
    met = []
    for _ in range(60):
        page.key("Tab")
        if page.of("document.activeElement === document.body"):
            break
        met.append(page.of(FOCUSED))
        assert page.of("document.activeElement.checkVisibility()"), met[-1]
    wanted = (
        "Design",
        "Twin",
        "Open",
        "Save twin",
        "Guide",
        "How to choose a magnet",
        "Sensor",
        "Magnet",
        "Save the",
        "Shape",
    )
    places = [next(k for k, name in enumerate(met) if name.startswith(one)) for one in wanted]
    assert places == sorted(places)
    assert "Explain" not in met


def test_a_change_by_keys_is_announced_and_its_picture_follows(page: Page) -> None:
    page.of(HEARD)
    before = names(page, "image")
    page.of("document.querySelector('#side [data-part=magnet]').focus()")
    assert page.of("document.activeElement.getAttribute('aria-valuetext')").endswith("mm")
    for _ in range(6):
        page.key("ArrowUp")
    page.until(AT_REST)
    page.until("window.heard.some((one) => one.startsWith('Keeps 0.5°'))")
    after = names(page, "image")
    assert sum(one != other for one, other in zip(before, after, strict=True)) >= 4


def test_a_refusal_is_an_alert(page: Page, saved: Path) -> None:
    (saved / "no.toml").write_text("schema = 1\n")
    page.drop(saved / "no.toml")
    page.until("!document.getElementById('error').hidden")
    alerts = [properties for role, _, properties in told(page) if role == "alert"]
    assert len(alerts) == 1
    assert page.of("document.getElementById('error').textContent").startswith("no.toml: ")


def test_a_search_is_followed_by_ear(page: Page, tmp_path: Path) -> None:
    """Its stages one by one, no ticking seconds, the verdict at the end; and its answer is met in order."""
    (tmp_path / "twin.toml").write_text(TWIN)
    options = ("--points", "120", "--both-directions", "--no-channels", "--seed", "3")
    assert halltwin("simulate", tmp_path / "twin.toml", "-o", tmp_path / "s.csv", *options).code == 0
    page.of(HEARD)
    page.drop(tmp_path / "s.csv")
    page.until("!!document.querySelector('#spectrum-plot path.line')", within_s=120.0)
    heard = [one for one in page.of("window.heard") if one]
    assert heard[-1] == "Explained: hysteresis"
    assert len([one for one in heard if "search" in one or "fitting" in one]) >= 1
    assert all(one != other for one, other in pairwise(heard)), heard
    assert not any(one[:1].isdigit() for one in heard)
    check_names(page)
    check_headings(page)
    assert names(page, "tabpanel") == ["Explain"]
    boxes = [name for name in names(page, "checkbox") if not name.startswith("held against")]
    assert [name.split(" without")[0] for name in boxes] == ["paper's error model", "hysteresis"]
    headings = names(page, "heading")
    assert headings.index("Explained: hysteresis") < headings.index("What is left") < headings.index("Layers")
    assert "hysteresis (concentrator)" in headings
