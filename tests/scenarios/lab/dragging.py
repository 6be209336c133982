"""A pointer that drags something on the page, step by step, as a hand would."""

from __future__ import annotations

import time

from tests.scenarios.lab.browser import Page

DRAG_TIMES = "performance.getEntriesByName('drag to redraw').map((one) => one.duration)"
"""Milliseconds from each move of the pointer to the redraw that follows it, in the page's own clock."""
SWITCH_TIMES = "performance.getEntriesByName('switch to redraw').map((one) => one.duration)"
"""The same of each layer switched and each slider moved that shows in a picture of readings."""
PAINTED = """(() => { window.painted = [];
    new PerformanceObserver((list) => list.getEntriesByName("switch to redraw").forEach((one) =>
        requestAnimationFrame(() => setTimeout(() => window.painted.push(performance.now() - one.startTime)))
    )).observe({ entryTypes: ["measure"] }); })()"""
"""From here on ``window.painted`` notes the milliseconds from each of these to the end of the frame that shows it."""
_FRAME_S = 1.0 / 60.0


def drag(page: Page, selector: str, *, by: tuple[float, float], steps: int, rest_s: float = _FRAME_S) -> None:
    """Press in the middle of an element, move by so many pixels in so many steps, release."""
    x, y = page.middle(selector)
    page.mouse("mousePressed", x, y)
    for step in range(1, steps + 1):
        page.mouse("mouseMoved", x + by[0] * step / steps, y + by[1] * step / steps)
        time.sleep(rest_s)
    page.mouse("mouseReleased", x + by[0], y + by[1])
