"""A sweep on the page: dropped, its search watched, its layers switched, its numbers moved, its answer saved."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np
import pytest

from tests.command_line import csv_text, halltwin, sweep_angles
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, complaints, cut_off, file_in, unnamed
from tests.scenarios.lab.dragging import PAINTED, SWITCH_TIMES
from tests.scenarios.lab.test_explain import TWIN

pytestmark = pytest.mark.skipif(BROWSER is None, reason=WHY_SKIPPED)
NAME = "sweep one.csv"
EXAMPLE = Path(__file__).parents[3] / "scenarios" / "data" / "bench_sweep.csv"
DONE = "!document.getElementById('answer').hidden && !!document.querySelector('#spectrum-plot path.line')"
LEFT = "parseFloat(document.querySelector('#layers .total span:last-child').textContent)"
MOVE = """(() => {{ const one = document.getElementById("number-{}"); one.value = {};
    one.dispatchEvent(new Event("input")); }})()"""


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Path:
    here = tmp_path_factory.mktemp("sweeps")
    (here / "twin.toml").write_text(TWIN)
    options = ("--points", "120", "--both-directions", "--no-channels", "--seed", "3")
    assert halltwin("simulate", here / "twin.toml", "-o", here / NAME, *options).code == 0
    return here / NAME


@pytest.fixture(scope="module")
def example(page: Page) -> str:
    """The command line of the example's answer, on a page without a sweep."""
    page.of("document.getElementById('tab-explain').click()")
    page.of("document.getElementById('example').click()")
    page.until("document.getElementById('sweep-name').textContent === 'bench_sweep.csv'")
    page.until(DONE, within_s=120.0)
    command: str = page.of("document.getElementById('explain-command').textContent")
    return command


def test_who_has_no_sweep_takes_the_example(example: str, page: Page) -> None:
    """It comes with the program; the command line names where it lies."""
    assert page.of("document.getElementById('example').hidden")
    *words, name, seed, number = shlex.split(example)
    assert (words, seed, number) == (["halltwin", "explain"], "--seed", "0")
    assert Path(name).samefile(EXAMPLE)
    assert page.of("document.getElementById('answer-verdict').textContent") == "Explained: hysteresis"


@pytest.fixture(scope="module")
def explained(page: Page, sweep: Path) -> Page:
    """The page with the sweep dropped on it and explained."""
    page.drop(sweep)
    # In one question: so short a search may end between two.
    shown = page.until(
        """(({ textContent }, { max }, { hidden }) => textContent && [textContent, max, hidden])(
            ...["seconds", "elapsed", "stop"].map((id) => document.getElementById(id)))""",
        within_s=60.0,
    )
    assert (shown[0][-3:], shown[1:]) == (" s:", [120.0, False])
    page.until(DONE, within_s=120.0)
    return page


def test_it_says_what_was_found(explained: Page) -> None:
    assert explained.of("document.getElementById('answer-verdict').textContent") == "Explained: hysteresis"
    assert NAME in explained.of("document.getElementById('answer-words').textContent")
    assert explained.of("document.getElementById('tab-explain').ariaSelected") == "true"
    # Both directions, in the picture and in its legend.
    assert explained.of("document.querySelectorAll('#residual-plot path.dots').length") == 4
    assert complaints(explained.browser) == []


def test_a_cause_is_switched_off_and_on(explained: Page) -> None:
    on = explained.of(LEFT)
    curve = "document.querySelector('#residual-plot svg').innerHTML"
    before = explained.of(curve)
    box = "#layers li:nth-child(3) input"
    x, y = explained.middle(box)
    for kind in ("mousePressed", "mouseReleased"):
        explained.mouse(kind, x, y)
    explained.until(f"{LEFT} > {2 * on}")
    assert explained.of(curve) != before
    assert explained.of("document.getElementById('residual-title').textContent") == "What is left without hysteresis"
    explained.of(f"document.querySelector('{box}').click()")
    explained.until(f"{LEFT} === {on}")


def test_a_number_is_moved_and_put_back(explained: Page) -> None:
    on = explained.of(LEFT)
    explained.of(MOVE.format("offset-x_percent", 1.2))
    explained.until(f"{LEFT} > {5 * on}")
    explained.of("[...document.querySelectorAll('#factors .reset')].find((one) => !one.hidden).click()")
    explained.until(f"{LEFT} === {on}")
    assert explained.of("[...document.querySelectorAll('#factors .reset')].every((one) => one.hidden)")


def test_nothing_is_wrong_where_all_went_well(explained: Page) -> None:
    """Neither at once nor when all rests, after which the spectrum is asked for."""
    explained.of(MOVE.format("offset-x_percent", 1.1))
    explained.of("document.getElementById('all-on').click()")
    explained.of("new Promise((done) => setTimeout(done, 600))")
    assert explained.of("[document.getElementById('error').hidden, document.body.className]") == [True, ""]


def test_switches_and_moves_are_timed_to_the_frame_that_shows_them(explained: Page) -> None:
    """What the benchmark of a long sweep reads."""
    explained.of(f"{PAINTED}; performance.clearMeasures()")
    box = "document.querySelector('#layers li:nth-child(3) input').click()"
    for done, doing in enumerate(
        (box, box, MOVE.format("offset-x_percent", 1.2), "document.getElementById('all-on').click()")
    ):
        explained.of(doing)
        explained.until(f"{SWITCH_TIMES}.length === {done + 1} && window.painted.length === {done + 1}")
    drawn, painted = explained.of(f"[{SWITCH_TIMES}, window.painted]")
    assert all(0.0 < first < then for first, then in zip(drawn, painted, strict=True))


def test_it_is_drawn_over_time(explained: Page) -> None:
    choose = """(() => {{ const one = document.getElementById("over"); one.value = "{}";
        one.dispatchEvent(new Event("change")); }})()"""
    explained.of(choose.format("clock"))
    explained.until("document.getElementById('residual-plot').textContent.includes('time / s')")
    explained.of(choose.format("angle"))
    explained.until("document.getElementById('residual-plot').textContent.includes('shaft angle / deg')")


def test_the_saved_answer_is_the_command_lines_byte_for_byte(
    explained: Page, sweep: Path, saved: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(sweep.parent)
    assert halltwin("explain", NAME, "--json", tmp_path / "answer.json").code == 0
    explained.of("document.getElementById('save-json').click()")
    assert file_in(saved, "answer.json") == (tmp_path / "answer.json").read_bytes()
    assert (
        explained.of("document.getElementById('explain-command').textContent") == f"halltwin explain '{NAME}' --seed 0"
    )


def test_every_control_and_picture_has_a_name(explained: Page) -> None:
    assert unnamed(explained, "#explain") == []


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [1280, 390])
def test_nothing_is_wider_than_the_screen(explained: Page, width: int, dark: bool) -> None:
    explained.resize(width, dark=dark)
    assert cut_off(explained, width) == []


def test_a_hostile_sweep_is_shown_as_what_it_says(explained: Page, saved: Path) -> None:
    (saved / "evil.csv").write_text("reference_deg,measured_deg\n<img src=x>,<img src=x onerror=alert(1)>\n" * 3)
    explained.drop(saved / "evil.csv")
    said = explained.until("document.getElementById('error').textContent", within_s=60.0)
    assert said.startswith("evil.csv: ")
    assert explained.of("document.querySelector('img')") is None
    assert explained.of("document.getElementById('answer').hidden")
    assert explained.of("document.getElementById('answer-verdict').textContent") == "evil.csv was not explained"
    # Once, and with a way out.
    words = explained.of("document.getElementById('answer-words').textContent")
    assert "halltwin import" in words
    assert said not in words
    ways = explained.of("[...document.querySelectorAll('#answer-words a')].map((one) => one.getAttribute('href'))")
    assert ways == ["guide/logs.html", "guide/explain_sweep.html"]
    assert complaints(explained.browser) == []


def test_a_search_is_stopped_on_the_page_and_says_what_becomes_of_it(explained: Page, saved: Path) -> None:
    """Once for the answer so far, twice for none; the bar shows computing, not the clock."""
    angle = np.concatenate([np.arange(0.0, 7200.0, 0.5), np.arange(7200.0, 0.0, -0.5)])
    reading = sweep_angles(angle, noise_deg=0.01, seed=2) + 0.05 * np.sin(np.radians(7.3 * angle))
    (saved / "long.csv").write_text(csv_text({"reference_deg": angle, "measured_deg": reading % 360.0}))
    explained.drop(saved / "long.csv")
    explained.until("document.getElementById('progress').textContent.includes('search')", within_s=60.0)
    computed, clock = explained.of(
        "[document.getElementById('elapsed').value, parseFloat(document.getElementById('seconds').textContent)]"
    )
    assert 0.0 < computed < clock + 1.0
    explained.of("document.getElementById('stop').click()")
    explained.until("document.getElementById('progress').textContent.includes('the answer so far follows')")
    explained.of("document.getElementById('stop').click()")
    explained.until("document.getElementById('answer-verdict').textContent === 'long.csv was not explained'")
    assert explained.of("document.getElementById('answer-words').textContent") == "Stopped; nothing is kept."
    assert explained.of("document.getElementById('elapsed').hidden && document.getElementById('stop').hidden")
