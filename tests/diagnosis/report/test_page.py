"""The report: one file that needs nothing else, says what the JSON says, and can be drawn by a browser."""

from __future__ import annotations

import functools
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from diagnosis import Diagnoses, diagnose, explain
from diagnosis.discovery.result import Discovery
from diagnosis.report.data import noise_level, spectrum
from diagnosis.report.explain_plot import residual_figure
from diagnosis.report.page import page, write_report
from diagnosis.report.svg import MOST_POINTS, Axis, Layer, Plot, thinned
from scenarios.commands.protocol import Protocol
from twin.chain import Chain
from twin.motion import Motion

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
BASE: dict[str, dict[str, float]] = {
    "zero": {"zero_deg": 30.0},
    "offset": {"x_percent": 0.6, "y_percent": -0.4},
    "gain_mismatch": {"ratio": 1.01},
    "noise": {"rms_deg": 0.02},
}
CASES: dict[str, dict[str, dict[str, float]]] = {
    "clean": {},
    "hysteresis": {"hysteresis": {"lag_deg": 0.12, "memory_deg": 8.0}},
    "unnamed": {"unnamed_order": {"order": 13.0, "amplitude_deg": 0.08}},
    "glitches": {"bus_glitch": {"count": 5.0}},
}


@functools.cache
def explained_case(name: str) -> tuple[Discovery, dict[str, Any], str]:
    """What was found about a sweep with a hidden effect, the answer, and its page."""
    motion = Protocol(turns=1, points=120, both_directions=True).motion()
    chain = Chain().with_values({**BASE, **CASES[name]})
    found = explain(chain.simulate(motion, seed=3))
    answer = found.to_dict()
    return found.discovery, answer, page(found.discovery, answer)


@pytest.fixture(params=CASES)
def explained(request: pytest.FixtureRequest) -> tuple[Discovery, dict[str, Any], str]:
    """Each of the cases in turn."""
    return explained_case(request.param)


def test_it_needs_nothing_from_elsewhere(explained: tuple[Discovery, dict[str, Any], str]) -> None:
    html = explained[2]
    assert not re.search(r"https?:|//[a-z]|<script|<link|<img|@import|url\(|src=", html)
    assert 'name="viewport"' in html
    assert "@media print" in html


@pytest.mark.parametrize(("name", "twice"), [("clean", False), ("hysteresis", True)])
def test_what_no_cause_changes_is_drawn_once(name: str, twice: bool) -> None:
    """Points of two colours on one another are grey."""
    html = explained_case(name)[2]
    for title in ("In the order of the readings", "Spectrum of the residual"):
        picture = html.split(title)[1].split("</figure>")[0]
        assert "c-before" in picture
        assert ("c-after" in picture) == twice


def test_it_names_every_cause_and_draws_each(explained: tuple[Discovery, dict[str, Any], str]) -> None:
    _, answer, html = explained
    assert answer["verdict"] in html
    for place, cause in enumerate(answer["causes"], 1):
        section = html.split(f'<h3 id="cause-{place}">')[1].split("</section>")[0]
        assert cause["name"] in section
        assert "<svg" in section
        for rival in cause["indistinguishable_from"]:
            assert rival in section
    for name in answer["not_visible"]:
        assert f">{name}<" in html


def test_every_number_is_the_answers(explained: tuple[Discovery, dict[str, Any], str]) -> None:
    _, answer, html = explained
    known = set(numbers_of(answer))
    told = re.findall(r'<data value="([^"]+)">([^<]+)</data>', html)
    assert len(told) > 20
    for value, text in told:
        assert float(value) in known
        if "1e-6" in text:
            assert float(value) < 1e-6
            continue
        # What is read is the value to the digits shown; the offsets are shown in percent.
        read = float(text.replace("−", "-"))
        digits = 0.5000001 * 10.0 ** -len(text.partition(".")[2]) if "e" not in text else 0.5 * abs(read)
        assert min(abs(read - float(value) * scale) for scale in (1.0, 100.0)) <= digits, (value, text)


def numbers_of(value: Any) -> list[float]:
    """All numbers of a JSON value."""
    if isinstance(value, dict):
        return [number for item in value.values() for number in numbers_of(item)]
    if isinstance(value, list):
        return [number for item in value for number in numbers_of(item)]
    return [float(value)] if isinstance(value, int | float) else []


def test_every_parameter_of_the_answer_is_told(explained: tuple[Discovery, dict[str, Any], str]) -> None:
    _, answer, html = explained
    told = {float(value) for value in re.findall(r'<data value="([^"]+)">', html)}
    for holder in (answer["baseline"], *answer["causes"]):
        assert {parameter["value"] for parameter in holder["parameters"].values()} <= told


def test_pictures_have_units_and_stay_inside(explained: tuple[Discovery, dict[str, Any], str]) -> None:
    html = explained[2]
    pictures = re.findall(r'<svg viewBox="0 0 520 290".*?</svg>', html, flags=re.DOTALL)
    assert len(pictures) >= 4
    for picture in pictures:
        labels = re.findall(r'<text class="label"[^>]*>([^<]+)<', picture)
        assert len(labels) == 2
        assert all(" / " in text or text == "reading number" for text in labels)
        assert "nan" not in picture
        assert "inf" not in picture


def test_it_is_written_whole_and_the_same_each_time(
    explained: tuple[Discovery, dict[str, Any], str], tmp_path: Path
) -> None:
    found, answer, html = explained
    write_report(tmp_path / "r.html", found, answer)
    assert (tmp_path / "r.html").read_text() == html
    assert [path.name for path in tmp_path.iterdir()] == ["r.html"]


def test_a_million_points_are_thinned_to_what_can_be_seen() -> None:
    rng = np.random.default_rng(0)
    x, y = rng.uniform(0.0, 360.0, 1_000_000), rng.standard_normal(1_000_000)
    y[1234] = 9.0
    plot = Plot(Axis("x / deg"), Axis("y / deg", (-10.0, 10.0)), [Layer("points", x, y, "all", "c-after")], "test")
    assert len(plot.svg()) < 60_000
    kept = thinned(x, y)
    assert len(kept) < 2 * MOST_POINTS
    assert max(b for _, b in kept) == 9.0


def test_points_far_off_are_counted_at_the_edge() -> None:
    x = np.linspace(0.0, 360.0, 200)
    y = np.sin(x)
    y[7] = 90.0
    picture = Plot(Axis("x"), Axis("y"), [Layer("points", x, y, "", "c-after")], "test").svg()
    assert "1 beyond the axis" in picture


def test_the_spectrum_gives_a_lines_amplitude_and_order_0_the_step_between_directions() -> None:
    way = np.repeat([1.0, -1.0], 720)
    angle = np.radians(np.concatenate([np.arange(720.0), np.arange(720.0)[::-1]])).astype(np.float64)
    motion = Motion.from_angle(angle, direction=way)
    values = 0.05 * np.cos(13.0 * angle + 0.3) - 0.1 * way
    orders, amplitude = spectrum(motion, values, np.ones(1440, dtype=bool), 90.0)
    assert amplitude[np.argmin(np.abs(orders - 13.0))] == pytest.approx(0.05, rel=0.02)
    assert amplitude[0] == pytest.approx(0.1, rel=0.02)
    rest = amplitude[(orders > 14.0) | ((orders > 1.0) & (orders < 12.0))]
    assert rest.max() < 2e-3


def test_noise_passes_its_level_at_one_order_in_twenty() -> None:
    rng = np.random.default_rng(1)
    angle = np.arange(20_000.0) * (2.0 * np.pi / 1000.0)
    motion = Motion.from_angle(angle)
    orders, amplitude = spectrum(motion, rng.standard_normal(angle.size), np.ones(angle.size, dtype=bool), 400.0)
    share = np.mean(amplitude > noise_level(orders, amplitude, both=False))
    assert share == pytest.approx(0.05, abs=0.015)


@pytest.mark.skipif(BROWSER is None, reason="no Chromium here: apt-get install chromium to see the report drawn")
def test_a_browser_draws_it(tmp_path: Path) -> None:
    """On a wide screen and on a narrow one."""
    source, picture = tmp_path / "r.html", tmp_path / "r.png"
    source.write_text(explained_case("hysteresis")[2])
    for width in (1280, 390):
        _drawn(source, picture, width)


def _drawn(source: Path, picture: Path, width: int) -> None:
    flags = [
        "--headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking",
        "--disable-component-update --disable-sync --hide-scrollbars --run-all-compositor-stages-before-draw",
    ]
    command = [str(BROWSER), *" ".join(flags).split(), f"--user-data-dir={source.parent / 'profile'}"]
    command += [f"--window-size={width},1600", f"--screenshot={picture}", source.as_uri()]
    subprocess.run(command, check=True, capture_output=True, timeout=60)
    content = picture.read_bytes()
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    assert int.from_bytes(content[16:20], "big") == width
    # A blank page compresses to a few kB.
    assert len(content) > 30_000


@pytest.mark.parametrize(("both", "ways"), [(True, {"forward", "backward"}), (False, {"forward"})])
def test_direction_is_marked_in_every_picture_of_an_error(both: bool, ways: set[str]) -> None:
    """By a symbol and in the legend; a spectrum alone has no readings in it."""
    motion = Protocol(turns=2, points=120, both_directions=both).motion()
    values = {**BASE, **CASES["glitches"], "saturation": {"k_percent": 1.0}}
    found = explain(Chain().with_values(values).simulate(motion, seed=3))
    html = page(found.discovery, found.to_dict())
    figures = re.findall(r"<figure>.*?</figure>", html, flags=re.DOTALL)
    assert len(figures) > 6
    for figure in figures:
        if "Spectrum" in figure:
            continue
        legend = re.search(r'<div class="legend">.*?</div>', figure)
        assert legend, figure[:200]
        assert set(re.findall("forward|backward", legend[0])) == ways
        assert ("crosses" in figure) == both


def test_direction_is_marked_in_the_pictures_of_matplotlib() -> None:
    pytest.importorskip("matplotlib")
    found = explained_case("hysteresis")[0]
    axis = residual_figure(found).axes[0]
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["forward", "backward"]
    assert len({line.get_marker() for line in axis.get_lines()}) == 2
    one, both = (
        diagnose(Chain().with_values(BASE).simulate(Protocol(turns=1, points=72, both_directions=way).motion()))
        for way in (False, True)
    )
    (legend,) = Diagnoses((*one._alone.items, *both._alone.items), one.made).plot().legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said == ["measured, forward", "fitted factors", "measured, backward"]
