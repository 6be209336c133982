"""The closed loop on the page: that of the command line, its readings as they come."""

from __future__ import annotations

import json
import shlex
import time
from pathlib import Path
from typing import Any

import pytest

from tests.command_line import halltwin
from tests.pages import words
from tests.scenarios.lab.browser import BROWSER, WHY_SKIPPED, Page, complaints, cut_off, unnamed
from tests.scenarios.lab.serving import Client

pytest.importorskip("can")
pytest.importorskip("cantools")
HIDDEN = "saturation:k_percent=2"


def ended(client: Client) -> tuple[dict[str, Any], list[int]]:
    """How the loop ended, and how many readings of its first sweep were shown meanwhile."""
    end, seen = time.monotonic() + 180.0, []
    while (stand := client.ask("bench").json)["state"] == "working":
        assert time.monotonic() < end, stand
        seen.append(len(stand["curves"].get("before", {"at_deg": []})["at_deg"]))
        time.sleep(0.03)
    return stand, seen


def test_the_loop_is_the_command_lines(client: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """To its words and its figures: on a busy machine a node may be asked twice, and then draws other noise."""
    monkeypatch.chdir(tmp_path)
    begun = client.ask("bench/begin", {"hide": [HIDDEN], "points": 90}).json
    stand, seen = ended(client)
    assert stand["state"] == "done", stand["words"]
    assert begun["command"] == f"halltwin bench --closed-loop --twin imc-14bit --hide {HIDDEN} --points 90 --seed 0"
    done = halltwin(*shlex.split(begun["command"])[1:])
    assert done.code == 0, done.err
    written, report = json.loads(Path("bench-report.json").read_text()), stand["answer"]
    assert set(report) == set(written)
    assert report["command"] == written["command"]
    assert [one["name"] for one in report["causes"]] == [one["name"] for one in written["causes"]]
    assert report["reached"]
    assert written["reached"]
    for part in ("before", "after"):
        assert report[part]["rms_deg"] == pytest.approx(written[part]["rms_deg"], rel=0.05)
    said = [line for line in done.out.splitlines() if not line.startswith("wrote ")]
    assert words("\n".join(stand["said"])) == words("\n".join(said))
    # The curves grew while it measured, and end as what the report says of them.
    assert len({count for count in seen if 0 < count < 180}) > 3
    for part in ("before", "after"):
        curve = stand["curves"][part]
        assert len(curve["at_deg"]) == len(curve["error_deg"]) == curve["total"] == 180
        assert max(map(abs, curve["error_deg"])) == pytest.approx(report[part]["largest_deg"], abs=2e-5)


def test_a_loop_is_stopped(client: Client) -> None:
    client.ask("bench/begin", {"hide": [], "points": 360})
    stand = client.ask("bench/stop", {}).json
    assert stand["state"] == "failed"
    assert "stopped" in stand["words"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"hide": "x", "points": 90}, "hide is 'x'"),
        ({"hide": ["x" * 300], "points": 90}, "hide is"),
        ({"hide": [HIDDEN] * 20, "points": 90}, "hide is"),
        ({"hide": [], "points": 1e9}, "points is"),
        ({"hide": [], "points": 4}, "points is 4"),
        ({"points": 90}, "a loop is"),
    ],
)
def test_a_loop_that_cannot_be_is_one_line(content: dict[str, Any], said: str, client: Client) -> None:
    got = client.ask("bench/begin", content)
    assert got.status == 400
    assert said in got.error


@pytest.mark.parametrize("hide", ["luck:x=1", "saturation:k_percent=1e9", "../../etc", "<b>:x=1"])
def test_what_cannot_be_hidden_is_told_in_the_commands_words(hide: str, client: Client) -> None:
    client.ask("bench/begin", {"hide": [hide], "points": 90})
    stand, _ = ended(client)
    assert stand["state"] == "failed"
    refused = halltwin("bench", "--closed-loop", "--hide", hide, "--twin", "imc-14bit", "-o", "nowhere.csv")
    assert refused.code == 2
    assert stand["words"] == refused.err.removeprefix("halltwin: ").rstrip()


@pytest.mark.skipif(BROWSER is None, reason=WHY_SKIPPED)
def test_the_page_shows_the_loop_as_it_runs(page: Page) -> None:
    page.of("document.getElementById('tab-bench').click(); document.getElementById('loop-points').value = '90'")
    x, y = page.middle("#loop-begin")
    for kind in ("mousePressed", "mouseReleased"):
        page.mouse(kind, x, y)
    page.until("document.getElementById('before-plot').textContent.includes('of 180 readings')", within_s=60.0)
    page.until("document.getElementById('loop-figures').children.length === 4", within_s=180.0)
    assert page.of("document.getElementById('loop-verdict').textContent").startswith("The aim is reached")
    assert "saturation" in page.of("document.getElementById('loop-figures').textContent")
    assert unnamed(page, "#bench") == []
    for width in (1280, 390):
        page.resize(width)
        assert cut_off(page, width) == []
    assert complaints(page.browser) == []
