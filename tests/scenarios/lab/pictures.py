"""The pictures of the guide's first walk, made by the page itself, and the steps of that walk.

    python -m tests.scenarios.lab.pictures
    python -m tests.scenarios.lab.pictures --looks FOLDER

The second makes none of them: it lays into a folder what is to be looked at, each view on a screen and on a phone,
light and dark.
"""

from __future__ import annotations

import itertools
import json
import sys
import tempfile
from pathlib import Path

from scenarios.lab.command import started
from tests.command_line import halltwin
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, browsing, opened
from tests.scenarios.lab.serving import serving

DATA = Path(__file__).parents[3] / "scenarios" / "data"
PICTURES = ("lab_installed.png", "lab_begins.png", "lab_chosen.png", "lab_explains.png", "lab_report.png")
INSTALL = "python3 -m venv .venv && .venv/bin/pip install -q . && .venv/bin/halltwin lab"
AT_REST = "!!document.querySelector('#map-plot rect') && !document.querySelector('#figures.waiting')"
HIGH = 905.0
WIDTHS = (1280, 390)
_PLACE = """(() => {
    const svg = document.querySelector("#map-plot svg");
    svg.scrollIntoView({ block: "center" });
    const along = (anchor, from, size) => [...svg.querySelectorAll(`text[text-anchor=${anchor}]`)].map((one) => {
        const box = one.getBoundingClientRect();
        return [Number(one.textContent), box[from] + box[size] / 2];
    });
    return { across: along("middle", "x", "width"), up: along("end", "y", "height") };
})()"""
"""Where the ticks of the map stand on the screen: value and pixel of each, across and up."""


_TERMINAL = """(() => {
    document.body.replaceChildren(Object.assign(document.createElement("pre"), { textContent: %s }));
    const style = { margin: 0, padding: "14px 18px", background: "#1b1f24", color: "#e8eaed", whiteSpace: "pre-wrap",
        font: "15px/1.5 ui-monospace, Menlo, Consolas, 'DejaVu Sans Mono', monospace", overflowWrap: "anywhere" };
    Object.assign(document.body.style, { margin: 0, background: style.background });
    Object.assign(document.body.firstChild.style, style);
})()"""
"""A blank page as a terminal with some text."""


def installed(page: Page, folder: Path, said: str) -> None:
    """The terminal: what installs and starts it, and what that prints."""
    page.call("Page.navigate", url="about:blank")
    page.of(_TERMINAL % json.dumps(f"$ {INSTALL}\n{said}"))
    page.picture(folder / PICTURES[0], height=150.0)


def reported(page: Page, folder: Path, report: Path) -> None:
    """The report that the command line writes of the same sweep."""
    page.call("Page.navigate", url=report.as_uri())
    page.until("location.protocol === 'file:' && document.readyState === 'complete'")
    page.picture(folder / PICTURES[4], height=HIGH)


def begins(page: Page, folder: Path) -> None:
    """The page as it begins."""
    page.until(AT_REST)
    page.picture(folder / PICTURES[1], height=HIGH)


def chosen(page: Page, folder: Path) -> None:
    """A click on the map, at 10 mm and 2.5 mm: a magnet that keeps what is asked."""
    ticks = page.of(_PLACE)
    x, y = (_pixel(ticks[axis], value) for axis, value in (("across", 10.0), ("up", 2.5)))
    for kind in ("mousePressed", "mouseReleased"):
        page.mouse(kind, x, y)
    page.until(f"document.getElementById('verdict').textContent.includes(' in 100 % ') && {AT_REST}")
    page.of("scrollTo(0, 0)")
    page.picture(folder / PICTURES[2], height=HIGH)


def _pixel(ticks: list[list[float]], value: float) -> float:
    """Where a value stands on an axis of which two ticks are known."""
    numbered = [(tick, pixel) for tick, pixel in ticks if tick is not None]
    (low, at_low), (high, at_high) = numbered[0], numbered[-1]
    return at_low + (at_high - at_low) * (value - low) / (high - low)


def explains(page: Page, folder: Path) -> None:
    """A sweep explained, its cause switched off."""
    page.drop(DATA / "bench_sweep.csv")
    page.until("!!document.querySelector('#spectrum-plot path.line')", within_s=120.0)
    page.of("document.querySelector('#layers li:nth-child(3) input').click()")
    page.until("document.getElementById('residual-title').textContent.includes('without hysteresis')")
    page.picture(folder / PICTURES[3], height=HIGH)


def looks(page: Page, folder: Path) -> None:
    """Every view as it begins and as it ends, whole, at both widths, light and dark."""
    page.until(AT_REST)
    every_look(page, folder, "design")
    page.of("document.getElementById('tab-explain').click()")
    every_look(page, folder, "explain_begins")
    page.drop(DATA / "bench_sweep.csv")
    page.until("!!document.querySelector('#spectrum-plot path.line')", within_s=120.0)
    every_look(page, folder, "explain")
    page.of("document.getElementById('tab-bench').click()")
    every_look(page, folder, "bench_begins")
    page.of("document.getElementById('loop-begin').click()")
    page.until("!!document.querySelector('#loop-figures div')", within_s=120.0)
    every_look(page, folder, "bench")


def every_look(page: Page, folder: Path, name: str) -> None:
    """What the page shows, in four pictures."""
    for width, dark in itertools.product(WIDTHS, (False, True)):
        page.resize(width, dark=dark)
        page.picture(folder / f"{name}_{width}_{'dark' if dark else 'light'}.png")
    page.resize(WIDTHS[0])


def main() -> None:
    """Make all of them, or what is to be looked at."""
    if BROWSER is None:
        raise SystemExit(WHY_SKIPPED)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "server").mkdir()
        with serving(folder / "server") as client, browsing(folder) as browser:
            page = opened(browser, client.server.guard.url, folder)
            if sys.argv[1:2] == ["--looks"]:
                looks(page, Path(sys.argv[2]))
                return
            for step in (begins, chosen, explains):
                step(page, DATA)
            installed(page, DATA, started(client.server.guard.url))
            report = folder / "report.html"
            assert halltwin("explain", DATA / "bench_sweep.csv", "--report", report).code == 0
            reported(page, DATA, report)


if __name__ == "__main__":
    main()
