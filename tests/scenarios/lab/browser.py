"""A headless Chromium, told what to do through two pipes (DevTools protocol): no package, no port, no network."""

from __future__ import annotations

import base64
import contextlib
import itertools
import json
import math
import os
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
WHY_SKIPPED = "no Chromium here: apt-get install chromium to see the page at work"
_FLAGS = (
    "--headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking --disable-component-update "
    "--disable-sync --hide-scrollbars --disable-extensions --mute-audio --disable-dev-shm-usage "
    "--disable-features=PreloadTopChromeWebUI --remote-debugging-pipe"
)
_ANSWER_S = 60.0


@dataclass
class Browser:
    """The process and its pipes; events that nobody waited for are kept."""

    process: subprocess.Popen[bytes]
    to: int
    back: int
    events: list[dict[str, Any]] = field(default_factory=list)
    _numbers: Iterator[int] = field(default_factory=lambda: itertools.count(1))
    _held: bytes = b""

    def call(self, method: str, session: str | None = None, **params: Any) -> dict[str, Any]:
        """The result of a command. An error fails the test."""
        number = next(self._numbers)
        command: dict[str, Any] = {"id": number, "method": method, "params": params}
        if session is not None:
            command["sessionId"] = session
        os.write(self.to, json.dumps(command).encode() + b"\0")
        while True:
            message = self._message()
            if message.get("id") == number:
                assert "error" not in message, f"{method}: {message['error']}"
                result: dict[str, Any] = message["result"]
                return result
            self.events.append(message)

    def _message(self) -> dict[str, Any]:
        end = time.monotonic() + _ANSWER_S
        while b"\0" not in self._held:
            ready, _, _ = select.select([self.back], [], [], max(end - time.monotonic(), 0.0))
            assert ready, "the browser does not answer"
            part = os.read(self.back, 1 << 20)
            assert part, "the browser has ended"
            self._held += part
        first, _, self._held = self._held.partition(b"\0")
        found: dict[str, Any] = json.loads(first)
        return found


@dataclass
class Page:
    """One page of the browser's."""

    browser: Browser
    session: str
    size: tuple[int, int] = (1280, 900)

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        """See :meth:`Browser.call`."""
        return self.browser.call(method, self.session, **params)

    def of(self, script: str) -> Any:
        """What an expression comes to; a promise is waited for. An exception fails the test."""
        found = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def until(self, script: str, *, within_s: float = 30.0) -> Any:
        """What an expression comes to as soon as that is true."""
        end = time.monotonic() + within_s
        while not (found := self.of(script)):
            assert time.monotonic() < end, f"not within {within_s:g} s: {script}; the page says {self.of(_SAID)}"
            time.sleep(0.02)
        return found

    def resize(self, width: int, height: int = 900, *, dark: bool = False) -> None:
        """A screen of this size, light or dark."""
        self.size = (width, height)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.call("Emulation.setEmulatedMedia", features=[scheme])
        self._screen(width, height)

    def _screen(self, width: int, height: int) -> None:
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.of("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))")

    def picture(self, path: Path, *, height: float | None = None) -> None:
        """The page as PNG, whole or from the top.

        On a screen as high as the picture: to capture beyond it makes the browser lay the page out one pixel wide.
        """
        high = 0
        # What comes onto the screen draws itself and may be higher then.
        while high != (high := math.ceil(height or self.call("Page.getLayoutMetrics")["cssContentSize"]["height"])):
            self._screen(self.size[0], high)
        clip = {"x": 0, "y": 0, "width": self.size[0], "height": high, "scale": 1}
        shot = self.call("Page.captureScreenshot", format="png", clip=clip)
        self._screen(*self.size)
        path.write_bytes(base64.b64decode(shot["data"]))

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Press, move or release the left button at a point."""
        held = 0 if kind == "mouseReleased" else 1
        event = {"type": kind, "x": x, "y": y, "button": "left", "buttons": held, "clickCount": 1}
        self.call("Input.dispatchMouseEvent", **event)

    def key(self, name: str) -> None:
        """Press and release a key such as ArrowRight."""
        code = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Tab": 9, "Enter": 13}[name]
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code)

    def drop(self, file: Path, x: float = 300, y: float = 300) -> None:
        """Drop a file on the page."""
        data = {"items": [], "files": [str(file)], "dragOperationsMask": 1}
        self.of("""window.dropped = false;
            document.addEventListener("drop", () => { window.dropped = true; }, { once: true, capture: true })""")
        end = time.monotonic() + _ANSWER_S
        # A busy browser may not have taken in yet that the page takes files, and then drops nothing.
        while not self.of("window.dropped"):
            assert time.monotonic() < end, f"{file.name} could not be dropped"
            for kind in ("dragEnter", "dragOver", "drop"):
                self.call("Input.dispatchDragEvent", type=kind, x=x, y=y, data=data)
                self.of("new Promise((done) => requestAnimationFrame(() => done(1)))")

    def middle(self, selector: str) -> tuple[float, float]:
        """The middle of an element on the screen, which is scrolled to it."""
        script = f"""(() => {{ const one = document.querySelector({json.dumps(selector)});
            one.scrollIntoView({{block: "center"}}); const box = one.getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2]; }})()"""
        x, y = self.of(script)
        return x, y


_SAID = "[document.getElementById('status')?.textContent, document.getElementById('error')?.textContent]"


_WITH_PIPES = """
import fcntl, os, sys
pipes = [fcntl.fcntl(int(number), fcntl.F_DUPFD, 10) for number in sys.argv[1:3]]
for own, number in zip(pipes, (3, 4)):
    os.dup2(own, number)
os.execvp(sys.argv[3], sys.argv[3:])
"""
"""The browser reads its pipe 3 and writes its pipe 4, whatever numbers they have here."""


@contextlib.contextmanager
def browsing(folder: Path) -> Iterator[Browser]:
    """A browser with a profile of its own in a folder, ended at the end."""
    read_by_it, to = os.pipe()
    back, written_by_it = os.pipe()
    # Every name but this machine's own address leads nowhere.
    nowhere = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
    words = [str(BROWSER), *_FLAGS.split(), nowhere, f"--user-data-dir={folder / 'profile'}", "about:blank"]
    command = [sys.executable, "-c", _WITH_PIPES, str(read_by_it), str(written_by_it), *words]
    process = subprocess.Popen(
        command, pass_fds=(read_by_it, written_by_it), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    os.close(read_by_it)
    os.close(written_by_it)
    browser = Browser(process, to, back)
    try:
        yield browser
        browser.call("Browser.close")
        process.wait(10.0)
    finally:
        os.close(to)
        os.close(back)
        if process.poll() is None:
            process.terminate()
            process.wait(10.0)


def opened(browser: Browser, url: str, downloads: Path) -> Page:
    """A page at an address; what it saves goes to a folder."""
    target = browser.call("Target.createTarget", url="about:blank")["targetId"]
    session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
    page = Page(browser, session)
    browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(downloads))
    for domain in ("Page", "Runtime", "Log"):
        page.call(f"{domain}.enable")
    page.resize(1280)
    page.call("Page.navigate", url=url)
    page.until("document.documentElement?.dataset.ready === 'yes'")
    return page


def complaints(browser: Browser) -> list[str]:
    """What scripts threw and the browser itself found wrong, such as a breach of the page's policy.

    That the program has refused a question (status 400) is an answer and no fault.
    """
    found = []
    for event in browser.events:
        if event.get("method") == "Runtime.exceptionThrown":
            found.append(str(event["params"]["exceptionDetails"]))
        entry = event["params"]["entry"] if event.get("method") == "Log.entryAdded" else {}
        if entry.get("level") == "error" and "status of 400" not in entry["text"]:
            found.append(entry["text"])
    return found


def file_in(folder: Path, name: str) -> bytes:
    """What the browser has saved there; a download takes its time."""
    for _ in range(400):
        if (folder / name).is_file() and not list(folder.glob("*.crdownload")):
            content = (folder / name).read_bytes()
            (folder / name).unlink()
            return content
        time.sleep(0.05)
    raise AssertionError(f"{name} was not saved; there is {[path.name for path in folder.iterdir()]}")


def cut_off(page: Page, width: int) -> list[str]:
    """What of the page lies beyond the sides of the screen: the page itself, and words in its pictures."""
    script = """[...document.querySelectorAll("svg text")].filter((one) => { const own = one.getBoundingClientRect();
        return own.width && (own.right > innerWidth + 1 || own.left < -1); }).map((one) => one.textContent)"""
    found: list[str] = page.of(script)
    reach = page.of("document.documentElement.scrollWidth")
    return found + ([f"the page, {reach} wide"] if reach > width else [])


def unnamed(page: Page, within: str) -> list[str]:
    """Controls and pictures within some parts of the page of which a screen reader has nothing to say."""
    script = """[...document.querySelectorAll("%s")].flatMap((part) => [...part.querySelectorAll(
        "input:not([hidden]), select, button, svg:not([aria-hidden]), [tabindex]")])
        .filter((one) => !(one.labels?.length || one.ariaLabel || one.textContent.trim()))
        .map((one) => one.outerHTML)"""
    found: list[str] = page.of(script % within)
    return found
