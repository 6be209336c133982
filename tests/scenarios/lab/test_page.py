"""The page in a browser: dragged, set by keys, saved, on a wide and on a narrow screen, light and dark."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, complaints, cut_off, file_in, unnamed
from tests.scenarios.lab.dragging import DRAG_TIMES, drag
from tests.scenarios.lab.serving import Client

pytestmark = pytest.mark.skipif(BROWSER is None, reason=WHY_SKIPPED)
AT_REST = "document.querySelector('#map-plot rect') && !document.querySelector('#figures.waiting')"
GAP = "document.querySelector('[aria-label=\"Air gap in mm\"]').valueAsNumber"
CHOOSE = """(() => {{ const one = document.getElementById("preset"); one.value = "{}";
    one.dispatchEvent(new Event("change")); }})()"""
NUMBERS = """Object.fromEntries([...document.querySelectorAll("#controls input[type=number][aria-label]")]
    .map((one) => [one.ariaLabel, one.valueAsNumber]))"""
SET_GAP = """(() => {{ const one = document.querySelector('[aria-label="Air gap in mm"]'); one.value = "{}";
    one.dispatchEvent(new Event("change")); }})()"""
COMMAND = "document.getElementById('command').textContent"
ERROR = "[...document.querySelectorAll('#error-plot path.line.first')].pop().getAttribute('d')"


@pytest.fixture(autouse=True)
def fresh(page: Page) -> Iterator[None]:
    """The page as it begins; and nothing that the browser complains of at the end."""
    page.browser.events.clear()
    page.resize(1280)
    page.of("document.documentElement.dataset.ready = 'before'")
    page.call("Page.reload")
    page.until("document.documentElement?.dataset.ready === 'yes'")
    page.until(AT_REST)
    yield
    assert complaints(page.browser) == []


def test_it_shows_the_figures_of_the_program(page: Page, client: Client) -> None:
    begun = client.ask("start").json["twin"]["design"]
    told = client.ask("design/study", begun).json["figures"]
    cards = page.of("[...document.querySelectorAll('#figures .value')].map((one) => one.textContent)")
    assert cards[1] == f"{told['error_deg']:.3f} deg"
    assert cards[2] == f"{told['field_low_mT']:.1f}\u2013{told['field_high_mT']:.1f} mT"
    assert cards[3] == f"{100 * told['yield']:g} %"
    assert f"{100 * told['yield']:g} % of the mountings" in page.of("document.getElementById('verdict').textContent")


def test_the_magnet_is_dragged(page: Page, client: Client) -> None:
    """Upwards the gap grows, at the drawing's own scale, and all that follows from it is the program's."""
    before, curve = page.of(GAP), page.of(ERROR)
    drag(page, "#side [data-part=magnet] .south", by=(0.0, -30.0), steps=6)
    page.until(AT_REST)
    after = page.of(GAP)
    assert after > before + 0.5
    assert page.of(ERROR) != curve
    assert page.of(COMMAND).count(f"--air-gap={after:g}") == 1
    design = client.ask("start").json["twin"]["design"]
    design["placement"]["air_gap_mm"] = after
    told = client.ask("design/study", design).json["figures"]
    assert page.of("document.querySelectorAll('#figures .value')[1].textContent") == f"{told['error_deg']:.3f} deg"


@pytest.mark.parametrize(
    ("part", "by", "moved"),
    [
        ("#side [data-part=sensor] .hit", (24.0, 0.0), ["Sensor off axis, x"]),
        ("#top [data-part=sensor] .hit", (20.0, 16.0), ["Sensor off axis, x", "Sensor off axis, y"]),
        ("#side [data-part=size] .hit", (20.0, -20.0), ["Diameter", "Height"]),
        ("#top [data-part=magnet] .south", (12.0, 8.0), ["Magnet off axis, x", "Magnet off axis, y"]),
    ],
)
def test_what_is_dragged_is_what_its_field_shows(
    page: Page, part: str, by: tuple[float, float], moved: list[str]
) -> None:
    before = page.of(NUMBERS)
    drag(page, part, by=by, steps=4)
    page.until(AT_REST)
    after = page.of(NUMBERS)
    changed = [name.removesuffix(" in mm") for name in after if after[name] != before[name]]
    assert changed == moved
    assert all(after[f"{name} in mm"] > before[f"{name} in mm"] for name in moved)


def test_keys_do_what_the_pointer_does(page: Page) -> None:
    """Arrow keys on the magnet itself, and on the sliders, which every part has."""
    page.of("document.querySelector('#side [data-part=magnet]').focus()")
    before = page.of(GAP)
    for _ in range(3):
        page.key("ArrowUp")
    assert page.of(GAP) == pytest.approx(before + 0.3)
    assert page.of("document.activeElement.dataset.part") == "magnet"
    page.of("document.getElementById('placement-air_gap_mm').focus()")
    page.key("ArrowRight")
    assert page.of(GAP) == pytest.approx(before + 0.31)
    page.until(AT_REST)


def test_every_control_and_picture_has_a_name(page: Page) -> None:
    assert unnamed(page, "header, #design") == []


def test_a_wrong_number_is_one_line_and_the_next_right_one_takes_it_away(page: Page) -> None:
    page.of(SET_GAP.format("-1"))
    said = page.until("document.getElementById('error').textContent")
    assert said.startswith("air_gap_mm is -1 mm; expected")
    # What was computed before is no answer to it.
    page.until("getComputedStyle(document.querySelector('#design .summary')).opacity < 0.5")
    page.of(SET_GAP.format("2"))
    page.until("document.getElementById('error').hidden")
    page.until("getComputedStyle(document.querySelector('#design .summary')).opacity === '1'")
    page.until(AT_REST)


def test_a_place_on_the_map_is_gone_to(page: Page) -> None:
    x, y = page.middle("#map-plot svg")
    for kind in ("mousePressed", "mouseReleased"):
        page.mouse(kind, x, y)
    page.until(AT_REST)
    assert 5.0 < page.of("document.querySelector('[aria-label=\"Diameter in mm\"]').valueAsNumber") < 9.0
    assert 1.0 < page.of(GAP) < 4.0


def test_a_sweep_of_the_design_is_saved(page: Page, saved: Path, client: Client) -> None:
    """At the temperature that is set; where halltwin design cannot say the mounting, its command is not offered."""
    page.of(SET_GAP.replace("Air gap in mm", "Sensor off axis, y in mm").format("0.2"))
    page.until("document.getElementById('command-note').textContent.startsWith('The options of halltwin design')")
    assert page.of("document.getElementById('command-of-design').hidden")
    command = page.of("document.getElementById('sweep-command').textContent")
    assert command.startswith("halltwin simulate twin.toml ")
    page.of("document.getElementById('save-sweep').click()")
    content = file_in(saved, "sweep.csv")
    assert content.count(b"\n") == 721
    design = client.ask("start").json["twin"]["design"]
    design["placement"]["sensor_y_mm"] = 0.2
    assert client.ask("sweep/save", design).content == content


def test_a_twin_is_saved_and_opened_by_dropping_it(page: Page, saved: Path) -> None:
    drag(page, "#side [data-part=magnet] .south", by=(0.0, -20.0), steps=3)
    page.until(AT_REST)
    gap = page.of(GAP)
    page.of("document.getElementById('save-twin').click()")
    content = file_in(saved, "twin.toml")
    assert tomllib.loads(content.decode())["magnet"]["placement"]["air_gap_mm"] == gap
    (saved / "mine.toml").write_bytes(content)
    page.of(CHOOSE.format("hall-12bit"))
    page.until(f"{GAP} === 1.5")
    page.drop(saved / "mine.toml")
    page.until(f"{GAP} === {gap} && document.getElementById('preset').value === 'mine.toml'")
    page.until(f"{COMMAND}.includes('--twin mine.toml')")
    page.of(CHOOSE.format("imc-14bit"))
    page.until("document.getElementById('preset').value === 'imc-14bit'")


def test_a_hostile_twin_is_shown_as_what_it_says_never_as_markup(page: Page, saved: Path) -> None:
    (saved / "evil.toml").write_text('schema = "halltwin.twin/1"\n[effects."<img src=x onerror=alert(1)>"]\nx = 1\n')
    page.drop(saved / "evil.toml")
    said = page.until("document.getElementById('error').textContent")
    assert "evil.toml: [effects.<img src=x onerror=alert(1)>]: no effect named" in said
    assert page.of("document.querySelector('img')") is None


def test_a_picture_is_saved_as_it_is_seen(page: Page, saved: Path) -> None:
    page.of("document.querySelector('[data-of=error]').click()")
    text = file_in(saved, "halltwin_error.svg").decode()
    assert text.startswith("<svg")
    assert "error / deg" in text
    assert "var(" not in text
    assert "class=" not in text


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [1280, 390])
def test_nothing_is_wider_than_the_screen(page: Page, width: int, dark: bool, tmp_path: Path) -> None:
    page.resize(width, dark=dark)
    assert cut_off(page, width) == []
    page.picture(tmp_path / "page.png")
    content = (tmp_path / "page.png").read_bytes()
    assert int.from_bytes(content[16:20], "big") == width
    assert len(content) > 60_000


def test_a_twin_without_a_magnet_shows_why_there_is_no_design(page: Page) -> None:
    page.of(CHOOSE.format("paper-encoder"))
    page.until("document.getElementById('no-design').textContent.includes('no [magnet]')")
    assert page.of("getComputedStyle(document.querySelector('#design .bench')).display") == "none"
    assert page.of("document.getElementById('error').hidden")
    page.of(CHOOSE.format("imc-14bit"))
    page.until("getComputedStyle(document.querySelector('#design .bench')).display === 'grid'")
    page.until(AT_REST)


def test_the_door_opens_the_page(page: Page, client: Client) -> None:
    guard = client.server.guard
    page.of("document.documentElement.dataset.ready = 'before'")
    page.call("Page.navigate", url=f"{guard.origin}{client.server.door.path}")
    page.until("document.documentElement?.dataset.ready === 'yes'")
    assert page.of("location.href").startswith(guard.url)
    page.until(AT_REST)


def test_it_asks_nobody_but_the_program(page: Page, client: Client) -> None:
    asked: list[str] = page.of("performance.getEntriesByType('resource').map((one) => one.name)")
    assert len(asked) > 8
    assert {url[: len(client.server.guard.url)] for url in asked} == {client.server.guard.url}


LATEST = """(async () => {
    const { latest } = await import("./ask.js");
    const [ends, begun, done] = [{}, [], []];
    const ask = latest(async (name, overtaken) => {
        begun.push(name);
        await new Promise((end) => { ends[name] = end; });
        if (!overtaken()) done.push(name);
    }, 2);
    const turn = () => new Promise((next) => setTimeout(next));
    for (const name of ["a", "b", "c", "d"]) ask(name);
    ends.b();
    await turn();
    ends.a();
    await turn();
    ends.d();
    await turn();
    return [begun.join(""), done.join("")];
})()"""
"""Four questions at once: b is answered before a, on which d begins, the latest of those that waited."""


def test_two_questions_are_underway_and_a_late_answer_is_not_drawn(page: Page) -> None:
    assert page.of(LATEST) == ["abd", "bd"]


def test_along_the_shaft_is_drawn_anew_where_something_is_seen_to_change(page: Page) -> None:
    """A gap is not seen along the shaft, a sensor off the axis is."""
    page.of("""document.querySelector("#top svg [data-part=sensor]").dataset.kept = "yes" """)
    page.of(SET_GAP.format("2.2"))
    assert page.of("""document.querySelector("#top svg [data-part=sensor]").dataset.kept""") == "yes"
    drag(page, "#side [data-part=sensor] .hit", by=(24.0, 0.0), steps=2)
    assert page.of("""document.querySelector("#top svg [data-part=sensor]").dataset.kept""") is None
    page.until(AT_REST)


def test_the_map_is_one_path_a_class(page: Page) -> None:
    """Of 576 squares of their own each would be laid out and painted with every move."""
    areas = page.of("[...document.querySelectorAll('#map-plot svg > g:nth-child(2) > *')].map((one) => one.tagName)")
    assert areas == ["path"] * 7
    counted = (
        "[...document.querySelectorAll('#map-plot svg > g:nth-child(2) > path')].map((one) => one.getAttribute('d'))"
    )
    assert sum(path.count("M") for path in page.of(counted)) == 24 * 24


def test_what_is_dragged_is_redrawn_while_it_is_dragged(page: Page) -> None:
    """How fast is measured by ``python -m tests.benchmarks.lab``; here every redraw follows within a glance."""
    drag(page, "#side [data-part=magnet] .south", by=(0.0, -40.0), steps=20)
    page.until(AT_REST)
    times: list[Any] = page.of(DRAG_TIMES)
    assert len(times) >= 5
    assert max(times) < 1000.0
