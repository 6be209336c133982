"""What a person sees while a command works, and what Ctrl-C leaves."""

from __future__ import annotations

import io
import json
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from rich.console import Console

from diagnosis import Progress, diagnose_many
from diagnosis.discovery.pipeline import PIPELINE
from diagnosis.progress import Listener
from diagnosis.report.stage_words import STAGES, progress_words, stage_words
from scenarios.commands import explain as command
from scenarios.commands import progress as shown
from scenarios.commands.progress import duration, progress_line
from tests.command_line import halltwin
from tests.diagnosis.discovery.sweeps import LOOP, ONCE
from twin.chain import Chain
from twin.files import read_twin
from twin.motion import Motion

BENCH = Path(__file__).parents[2] / "scenarios" / "data" / "bench_sweep.csv"


class Clock:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


# ---- words -------------------------------------------------------------------------------------------------------


def test_every_stage_has_plain_words() -> None:
    assert {stage.__name__ for stage in (*ONCE, *LOOP, *PIPELINE)} <= set(STAGES)
    assert stage_words("of_my_own") == "of my own"


def test_a_line_says_stage_count_hint_and_causes() -> None:
    assert progress_words(Progress("stepwise", 3.0)) == "searching for causes"
    held = Progress("stepwise", 3.0, causes=("hysteresis", "saturation"))
    assert (
        progress_words(held, "Ctrl-C: stop")
        == "searching for causes; Ctrl-C: stop; held so far: hysteresis, saturation"
    )
    stopped = progress_words(Progress("final_fit", 3.0, stopped=True), "Ctrl-C: stop")
    assert stopped == "stopped (Ctrl-C again ends at once); fitting the extended twin"
    assert progress_words(Progress("reading", 1.0, done=3, total=40)) == "reading the sweeps, 3 of 40 done"
    assert [duration(s) for s in (0.4, 59.9, 61.0, 3725.0)] == ["0 s", "59 s", "1 min 01 s", "62 min 05 s"]


def test_without_a_terminal_the_word_to_stop_is_answered_at_once_and_once() -> None:
    out = io.StringIO()
    with progress_line(console=Console(file=out, force_terminal=False, soft_wrap=True)) as listener:
        for _ in range(3):
            listener(Progress("final_fit", 3.0, stopped=True))
    assert out.getvalue() == "halltwin: stopping: the answer so far follows; Ctrl-C again ends at once\n"


# ---- where it is shown -------------------------------------------------------------------------------------------


def test_where_there_is_no_terminal_nothing_is_shown() -> None:
    """However long it takes: what is on stderr of a script is an error."""
    out, clock = io.StringIO(), Clock()
    with progress_line(console=Console(file=out, force_terminal=False, soft_wrap=True), clock=clock) as listener:
        for clock.now_s in (1.0, 31.0, 3600.0):
            listener(Progress("stepwise", clock.now_s, causes=("hysteresis",)))
    assert out.getvalue() == ""


def test_a_quick_answer_shows_no_line_on_a_terminal() -> None:
    out = io.StringIO()
    with progress_line(console=Console(file=out, force_terminal=True, width=60)) as listener:
        listener(Progress("stepwise", 0.1))
    assert out.getvalue() == ""


@pytest.mark.parametrize("width", [40, 80, 160])
def test_a_live_line_comes_goes_and_stays_within_the_terminal(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shown, "SHOWN_AFTER_S", 0.0)
    out, clock = io.StringIO(), Clock()
    console = Console(file=out, force_terminal=True, width=width, color_system=None, legacy_windows=False)
    with progress_line("Ctrl-C: the answer so far", console=console, clock=clock) as listener:
        clock.now_s = 75.0
        listener(Progress("held_out_selection", 75.0, causes=("hysteresis",) * 12))
        line = next(iter(console.render_lines(listener.__self__.line())))  # type: ignore[attr-defined]
    text = "".join(segment.text for segment in line)
    assert len(text) == width
    assert text.startswith("1 min 15 s  proving the causes")
    assert ("Ctrl-C" in text) == (width > 40)
    # Its own line is wiped, and the cursor is back.
    assert out.getvalue().endswith("\x1b[?25h\r\x1b[1A\x1b[2K") or out.getvalue() == ""


# ---- many sweeps -------------------------------------------------------------------------------------------------


def test_many_sweeps_are_counted() -> None:
    sensor = Chain().with_effect("noise", rms_deg=0.02)
    turns = [Motion.from_angle(range_rad) for range_rad in ([0.1 * k for k in range(n)] for n in (63, 70, 63))]
    heard: list[Progress] = []
    sweeps = [sensor.simulate(motion, seed=1) for motion in turns]
    found = diagnose_many(sweeps, progress=heard.append)
    assert [(one.stage, one.done) for one in heard] == [
        *(("reading", k) for k in (1, 2, 3)),
        *(("error_model", k) for k in (2, 3)),
        *(("judging", k) for k in (1, 2, 3)),
    ]
    assert {one.total for one in heard} == {3}
    assert found.to_dict() == diagnose_many(sweeps).to_dict()


# ---- Ctrl-C ------------------------------------------------------------------------------------------------------


def interrupting(times: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command gets so many interrupts: as soon as a cause is held, and then at each stage."""

    @contextmanager
    def line(hint: str = "") -> Iterator[Listener]:
        left = [times]

        def listen(progress: Progress) -> None:
            if progress.causes and left[0]:
                left[0] -= 1
                signal.raise_signal(signal.SIGINT)

        yield listen

    monkeypatch.setattr(command, "progress_line", line)


def test_the_first_interrupt_gives_the_answer_so_far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupting(1, monkeypatch)
    paths = {ending: tmp_path / f"a.{ending}" for ending in ("json", "html", "toml")}
    ended = halltwin("explain", BENCH, "--json", paths["json"], "--report", paths["html"], "--extended", paths["toml"])
    assert ended.code == 130
    answer = json.loads(paths["json"].read_text())
    assert answer["cut_short"]["stage"] == "stepwise"
    left = answer["cut_short"]["left_open"]
    assert "further causes" in left
    assert [cause["name"] for cause in answer["causes"]] == ["hysteresis"]
    assert answer["verdict"] == "partly explained"
    assert "hysteresis" in read_twin(paths["toml"]).values
    for said in (" ".join(ended.out.split()), paths["html"].read_text()):
        assert f"The search was stopped before its end, which leaves open {left}." in said
        assert "structure without a name" not in said


def test_a_second_interrupt_ends_at_once_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    interrupting(2, monkeypatch)
    ended = halltwin("explain", BENCH, "--json", tmp_path / "a.json")
    assert (ended.code, ended.out, ended.err) == (130, "", "halltwin: interrupted; nothing was written\n")
    assert list(tmp_path.iterdir()) == []


def test_a_search_that_ends_by_itself_is_not_cut_short(tmp_path: Path) -> None:
    ended = halltwin("explain", BENCH, "--json", tmp_path / "a.json")
    assert (ended.code, ended.err) == (0, "")
    assert json.loads((tmp_path / "a.json").read_text())["cut_short"] is None
    assert "stopped" not in ended.out
