"""The pictures of the guide's page about the page, made by the page itself.

python -m tests.scenarios.lab.pictures
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, browsing, opened
from tests.scenarios.lab.serving import serving

DATA = Path(__file__).parents[3] / "scenarios" / "data"
_AT_REST = "!!document.querySelector('#map-plot rect') && !document.querySelector('#figures.waiting')"
_SET = """(() => {{ const one = document.querySelector('[aria-label="{}"]'); one.value = "{}";
    one.dispatchEvent(new Event("change")); }})()"""
_HIGH = 905.0


def design(page: Page, folder: Path) -> None:
    """As it begins, and with a magnet that keeps what is asked."""
    page.until(_AT_REST)
    page.picture(folder / "lab_begins.png", height=_HIGH)
    for name, value in (("Diameter in mm", 10), ("Air gap in mm", 2.5)):
        page.of(_SET.format(name, value))
    page.until(f"document.getElementById('verdict').textContent.includes(' in 100 % ') && {_AT_REST}")
    page.picture(folder / "lab_chosen.png", height=_HIGH)


def explain(page: Page, folder: Path) -> None:
    """A sweep explained, its cause switched off."""
    page.drop(DATA / "bench_sweep.csv")
    page.until("!!document.querySelector('#spectrum-plot path.line')", within_s=120.0)
    page.of("document.querySelector('#layers li:nth-child(3) input').click()")
    page.until("document.getElementById('residual-title').textContent.includes('without hysteresis')")
    page.picture(folder / "lab_explains.png", height=_HIGH)


def main() -> None:
    """Make all of them."""
    if BROWSER is None:
        raise SystemExit(WHY_SKIPPED)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "server").mkdir()
        with serving(folder / "server") as client, browsing(folder) as browser:
            page = opened(browser, client.server.guard.url, folder)
            design(page, DATA)
            explain(page, DATA)


if __name__ == "__main__":
    main()
