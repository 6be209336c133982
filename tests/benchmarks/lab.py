"""How fast the page follows a hand: from a move of the pointer to the redraw, the whole chain at 360 angles between.

    python -m tests.benchmarks.lab [moves]

A headless Chromium drags the magnet of the page; the page itself notes when the pointer moved and when everything that
follows from it was drawn. A sweep of 100,080 readings is dropped and explained there, its layers are switched and one
of its numbers is dragged; of these it is noted, too, when the frame with the redraw was painted. Beside it, the time
that the program alone takes for an answer, and for the picture of that sweep with one of its causes off, spectrum
included.
"""

from __future__ import annotations

import json
import math
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from diagnosis import explain
from scenarios.commands.protocol import Protocol
from scenarios.lab.layers import Layers, Look
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, browsing, opened
from tests.scenarios.lab.dragging import DRAG_TIMES, PAINTED, SWITCH_TIMES
from tests.scenarios.lab.serving import Client, serving
from twin.files import read_twin
from twin.sweep import Sweep

DATA = Path(__file__).parents[2] / "scenarios" / "data"
_FRAME_S = 1.0 / 60.0
_READY = "document.querySelector('#map-plot rect') && !document.querySelector('#figures.waiting')"
_SEARCH_S = 300.0
_SWITCHED_EVERY_S = 0.4
"""Longer than a rest, after which the spectrum is drawn too: each switch is timed by itself."""


def dragged(client: Client, folder: Path, moves: int) -> list[float]:
    """Milliseconds from move to redraw, of so many moves at sixty a second."""
    with browsing(folder) as browser:
        page = opened(browser, client.server.guard.url, folder)
        page.until(_READY)
        x, y = page.middle("#side [data-part=magnet] .south")
        page.mouse("mousePressed", x, y)
        for step in range(moves):
            due = time.monotonic() + _FRAME_S
            turn = 2.0 * math.pi * step / 60.0
            page.mouse("mouseMoved", x + 12.0 * math.sin(turn), y + 20.0 * math.sin(0.7 * turn))
            time.sleep(max(due - time.monotonic(), 0.0))
        page.mouse("mouseReleased", x, y)
        time.sleep(0.5)
        times: list[float] = page.of(DRAG_TIMES)
        return times


def answered(client: Client, times: int) -> list[float]:
    """Milliseconds that the program takes for an answer, connection and JSON included."""
    design = client.ask("start").json["twin"]["design"]
    taken = []
    for step in range(times):
        design["placement"]["air_gap_mm"] = 1.0 + 2.0 * step / times
        start = time.perf_counter()
        json.loads(client.ask("design/at-once", design).content)
        taken.append(1e3 * (time.perf_counter() - start))
    return taken


def long_sweep() -> Sweep:
    """100,080 readings with a cause in them."""
    motion = Protocol(turns=139, points=360, both_directions=True, channels=False).motion()
    return read_twin(DATA / "bench_twin.toml").simulate(motion, seed=1)


def long_sweep_in_browser(client: Client, folder: Path, *, switches: int, moves: int) -> dict[str, list[float]]:
    """Milliseconds from a switch, and from a move of a slider at sixty a second, to redraw and paint."""
    long_sweep().write(folder / "long.csv")
    with browsing(folder) as browser:
        page = opened(browser, client.server.guard.url, folder)
        page.until(_READY)
        dropped = time.monotonic()
        page.drop(folder / "long.csv")
        page.until("!!document.querySelector('#spectrum-plot path.line')", within_s=_SEARCH_S)
        print(f"100,080 readings dropped: answered after {time.monotonic() - dropped:.0f} s")
        page.of(PAINTED)
        switched = _switched(page, switches)
        moved = _moved(page, moves)
    return {
        **{f"a layer of 100,080 readings switched, to {what}": taken for what, taken in switched.items()},
        **{f"a slider moved, to {what}": taken for what, taken in moved.items()},
    }


def _switched(page: Page, times: int) -> dict[str, list[float]]:
    """Its last layer clicked off and on."""
    x, y = page.middle("#layers li:nth-child(3) input")
    for _ in range(times):
        for kind in ("mousePressed", "mouseReleased"):
            page.mouse(kind, x, y)
        time.sleep(_SWITCHED_EVERY_S)
    return _taken(page, at_least=times)


def _moved(page: Page, moves: int) -> dict[str, list[float]]:
    """The thumb of the first slider dragged to and fro."""
    x, y = page.middle("#factors input[type=range]")
    page.mouse("mousePressed", x, y)
    for step in range(moves):
        due = time.monotonic() + _FRAME_S
        page.mouse("mouseMoved", x + 40.0 * math.sin(2.0 * math.pi * step / 60.0), y)
        time.sleep(max(due - time.monotonic(), 0.0))
    page.mouse("mouseReleased", x, y)
    time.sleep(_SWITCHED_EVERY_S)
    # Of moves that come while one is drawn only the latest is asked for.
    return _taken(page, at_least=moves // 4)


def _taken(page: Page, *, at_least: int) -> dict[str, list[float]]:
    """What has been timed since the last call."""
    drawn, painted = page.of(f"[{SWITCH_TIMES}, window.painted.splice(0)]")
    page.of("performance.clearMeasures()")
    assert min(len(drawn), len(painted)) >= at_least, (len(drawn), len(painted))
    return {"the redraw": drawn, "the frame painted": painted}


def looked(times: int) -> list[float]:
    """Milliseconds for the picture of a long sweep, whose search is stopped once it holds its cause."""
    layers = Layers(explain(long_sweep(), budget_s=60.0))
    print(f"of 100,080 readings {len(layers.read.error_deg):,} are drawn")
    taken = []
    for step in range(times):
        off = frozenset(list(layers.causes)[: step % 2])
        look = Look(off=off, values={}, over="angle", width=800, with_spectrum=True)
        start = time.perf_counter()
        json.dumps(layers.look(look))
        taken.append(1e3 * (time.perf_counter() - start))
    return taken


def main() -> None:
    """Measure and tell."""
    moves = int(sys.argv[1]) if len(sys.argv) > 1 else 300
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "server").mkdir()
        with serving(folder / "server") as client:
            rows = {"the program alone": answered(client, moves)}
            if BROWSER is None:
                print(WHY_SKIPPED)
            else:
                rows["drag to redraw"] = dragged(client, folder, moves)
                rows |= long_sweep_in_browser(client, folder, switches=40, moves=moves)
    rows["a look at 100,080 readings"] = looked(40)
    for what, taken in rows.items():
        median, high = np.quantile(taken, [0.5, 0.95])
        print(f"{what}: median {median:.1f} ms, 95 % within {high:.1f} ms, {len(taken)} times")


if __name__ == "__main__":
    main()
