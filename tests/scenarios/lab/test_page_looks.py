"""What stands where on the page: the map by yield, hatching, sentences, even columns, one column on a phone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.command_line import halltwin
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, complaints, cut_off
from tests.scenarios.lab.serving import Client
from tests.scenarios.lab.test_page import AT_REST, CHOOSE

pytestmark = pytest.mark.skipif(BROWSER is None, reason=WHY_SKIPPED)
RIPPLE = """schema = "halltwin.twin/1"
[effects.drive_ripple]
order = 50
amplitude_deg = 0.12
[effects."drive_ripple#2"]
order = 100
amplitude_deg = 0.08
phase_deg = 40
[effects.noise]
rms_deg = 0.02
"""
SHOW = """(() => {{ const one = document.getElementById("map-of"); one.value = "{}";
    one.dispatchEvent(new Event("change")); }})()"""
LEGEND = "[...document.querySelectorAll('#map-plot svg > g:first-child text')].map((one) => one.textContent)"
BOX = (
    "[...document.querySelectorAll('{}')].map((one) => one.getBoundingClientRect()).map((one) => [one.top, one.bottom])"
)
DONE = "!document.getElementById('answer').hidden && !!document.querySelector('#spectrum-plot path.line')"


@pytest.fixture(autouse=True)
def sound(page: Page) -> Iterator[None]:
    page.browser.events.clear()
    page.resize(1280)
    page.until(AT_REST)
    yield
    assert complaints(page.browser) == []


def test_the_map_of_the_yield_is_the_studys(client: Client) -> None:
    """Each cell is what the study says of that design with as many mountings."""
    design = client.ask("start").json["twin"]["design"]
    told = client.ask("design/yield-map", design).json
    share = np.array(told["yield"])
    assert share.shape == (12, 12)
    assert share.min() == 0.0
    assert share.max() == 1.0
    row, column = np.argwhere((share > 0.2) & (share < 0.9))[0]
    design["magnet"]["diameter_mm"] = told["size_mm"][column]
    design["placement"]["air_gap_mm"] = told["air_gap_mm"][row]
    design["demand"]["mountings"] = 50
    study = client.ask("design/study", design).json["figures"]
    # The map's sizes are told to five decimals.
    assert share[row, column] == pytest.approx(study["yield"], abs=0.021)
    assert told["field_low_mT"][row][column] == pytest.approx(study["field_low_mT"], abs=1e-3)


def test_the_map_shows_error_or_yield(page: Page) -> None:
    assert page.of(LEGEND)[:2] == ["≤ 0.125°", "≤ 0.25°"]
    page.of(SHOW.format("yield"))
    page.until(f"{LEGEND}[0] === '≥ 99 %'")
    assert page.of(LEGEND) == ["≥ 99 %", "≥ 90 %", "≥ 75 %", "≥ 50 %", "< 50 %", "field too weak", "too strong"]
    assert page.of("document.getElementById('map-note').textContent").startswith("Share of 50 mountings")
    page.of(SHOW.format("error"))
    page.until(f"{LEGEND}[0] === '≤ 0.125°'")


def test_too_weak_and_too_strong_are_hatched_in_two_ways(page: Page) -> None:
    """Far from the sensor the strokes rise, near to it they fall."""
    for kind, way in (("weak", -1), ("strong", 1)):
        strokes = page.of(f"document.querySelector('#map-plot .hatch.{kind}').getAttribute('d')").split("M")[1:]
        ends = [[tuple(map(float, end.split())) for end in stroke.split("L")] for stroke in strokes]
        assert len(ends) > 20
        assert {np.sign(to[1] - start[1]) for start, to in ends} == {way}
        assert all(to[0] > start[0] for start, to in ends)


def test_a_sentence_says_which_cause_to_mend(page: Page, client: Client) -> None:
    design = client.ask("start").json["twin"]["design"]
    told = client.ask("design/study", design).json
    name, left = min(told["without_deg"].items(), key=lambda one: one[1])
    said = page.of("document.getElementById('causes-first').textContent")
    assert said.startswith(f"Worth mending first: {name.replace('_', ' ')}. Without it")
    assert f"{left:.3f}° in place of {told['all_deg']:.3f}°" in said
    page.of(CHOOSE.format("hall-12bit"))
    page.until(AT_REST)
    page.until("document.getElementById('preset').value === 'hall-12bit'")
    page.of(CHOOSE.format("imc-14bit"))
    page.until(f"{AT_REST} && document.getElementById('causes-first').textContent === {said!r}")


def test_columns_end_together(page: Page) -> None:
    for selector in ("#design .bench > *", "#design .charts > .causes, #design .charts > .command"):
        bottoms = [bottom for _, bottom in page.of(BOX.format(selector))]
        assert len(bottoms) > 1
        assert max(bottoms) - min(bottoms) < 1.0, selector


def test_numbers_that_are_opened_scroll_beside_the_drawings(page: Page) -> None:
    """The cards beside them do not grow with them."""
    high = "document.querySelector('#design .scene').getBoundingClientRect().height"
    before = page.of(high)
    page.of("document.querySelectorAll('#controls details').forEach((one) => { one.open = true; })")
    numbers = "document.getElementById('controls')"
    assert page.of(high) == before
    assert page.of(f"{numbers}.scrollHeight > {numbers}.clientHeight")
    assert page.of(f"{numbers}.scrollWidth <= {numbers}.clientWidth")
    boxes = "[...document.querySelectorAll('#controls .row')].map((one) => one.getBoundingClientRect())"
    rows = page.of(f"{boxes}.filter((one) => one.width).map((one) => one.right)")
    assert max(rows) - min(rows) < 1.0
    page.resize(390)
    assert page.of(f"{numbers}.scrollHeight <= {numbers}.clientHeight + 1")
    page.of("document.querySelectorAll('#controls details').forEach((one) => { one.open = false; })")


@pytest.fixture(scope="module")
def ripple(page: Page, tmp_path_factory: pytest.TempPathFactory) -> Page:
    """The page with a sweep of two lines of one cause explained."""
    folder: Path = tmp_path_factory.mktemp("ripple")
    (folder / "twin.toml").write_text(RIPPLE)
    options = ("--points", "360", "--both-directions", "--no-channels")
    assert halltwin("simulate", folder / "twin.toml", "-o", folder / "r.csv", *options).code == 0
    page.drop(folder / "r.csv")
    page.until(DONE, within_s=120.0)
    return page


def test_lines_of_one_cause_bear_their_orders(ripple: Page) -> None:
    layers = ripple.of("[...document.querySelectorAll('#layers b')].map((one) => one.textContent)")
    assert layers == ["paper's error model", "drive ripple (order 50, 100)"]
    labels = ripple.of(
        "[...document.querySelectorAll('#factors label')].map((one) => one.firstChild.textContent.trim())"
    )
    assert {"amplitude, order 50", "phase, order 50", "amplitude, order 100", "phase, order 100"} <= set(labels)
    assert len(labels) == len(set(labels))


def test_what_to_measure_next_begins_with_what_to_do(ripple: Page) -> None:
    first = ripple.of("document.querySelector('#next li').firstChild.textContent")
    assert first.startswith("Tell drive ripple from mechanics (teeth of a belt or gear): count them")
    assert ripple.of("document.querySelector('#next li small').textContent") == ""


def test_a_floor_that_is_not_known_is_said_in_words(ripple: Page) -> None:
    cards = ripple.of("[...document.querySelectorAll('#answer-figures .value')].map((one) => one.textContent)")
    assert cards[-1] == "not known"
    assert not any("–" in card for card in cards)


def test_numbers_scroll_beside_the_pictures(ripple: Page) -> None:
    bottoms = [bottom for _, bottom in ripple.of(BOX.format("#answer > .wide:first-child, #answer > .side"))]
    assert abs(bottoms[0] - bottoms[1]) < 1.0
    assert ripple.of(
        "document.getElementById('factors').scrollHeight > document.getElementById('factors').clientHeight"
    )


def test_on_a_phone_all_stands_in_one_column(ripple: Page) -> None:
    """What was found behind the layers, no table that is cut off, the sliders last but one."""
    ripple.resize(390)
    cards = ".first-card, #answer .layers-card, #answer .found, #answer .next-card, #factors, #answer .command"
    order = """[...document.querySelectorAll("#answer %s")]
        .sort((one, other) => one.getBoundingClientRect().top - other.getBoundingClientRect().top)
        .map((one) => one.classList[1] ?? one.id)"""
    assert ripple.of(order % cards) == ["first-card", "layers-card", "found", "next-card", "controls", "command"]
    cut = """[...document.querySelectorAll("#answer .scroll")]
        .filter((one) => one.scrollWidth > one.clientWidth + 1).length"""
    assert ripple.of(cut) == 0
    first, second = ripple.of(BOX.format("#answer .found > div"))
    assert second[0] >= first[1]
    assert cut_off(ripple, 390) == []
    head = "getComputedStyle(document.querySelectorAll('#factor-table td.number')[{}], '::before').content"
    assert [ripple.of(head.format(k)).replace('" "', " ").strip('" ') for k in (0, 1)] == [
        "before:",
        "with the causes:",
    ]


def test_the_head_of_the_page_has_two_rows_on_a_phone(page: Page) -> None:
    page.resize(390)
    page.of("document.getElementById('tab-explain').click()")
    assert page.of("document.getElementById('status').textContent") == ""
    tops = page.of("""[...document.querySelectorAll(".bar > *")].map((one) => one.getBoundingClientRect())
        .filter((one) => one.height).map((one) => one.top + one.height / 2)""")
    assert len({round(top / 20.0) for top in tops}) == 2
    page.of("document.getElementById('tab-design').click()")
    assert page.of("document.getElementById('preset').labels[0].textContent") == "Twin"


def test_an_underscore_has_room_in_a_field(page: Page) -> None:
    page.of("document.getElementById('tab-bench').click()")
    inside, letters = page.of("""(() => { const one = document.getElementById("hide"), style = getComputedStyle(one);
        return [one.clientHeight - parseFloat(style.paddingTop) - parseFloat(style.paddingBottom),
            parseFloat(style.fontSize)]; })()""")
    page.of("document.getElementById('tab-design').click()")
    assert inside >= 1.5 * letters


@pytest.mark.parametrize("of", ["command", "explain-command", "loop-command"])
def test_every_command_line_is_copied(of: str, page: Page) -> None:
    page.of("""Object.defineProperty(navigator, "clipboard", { configurable: true,
        value: { writeText: async (words) => { window.copied = words; } } })""")
    page.of(f"document.getElementById('{of}').textContent ||= 'halltwin of {of}'")
    page.of(f"document.querySelector('button.copy[data-of={of}]').click()")
    page.until(f"window.copied === document.getElementById('{of}').textContent")
    assert page.of("document.getElementById('status').textContent") == "copied the command line"


def test_a_hostile_look_of_the_map_is_one_line(client: Client) -> None:
    got = client.ask("design/yield-map", {"magnet": 1})
    assert got.status == 400
    assert got.error.startswith("a design is ")
