"""A search that is watched tells where it stands, and one that is stopped is finished with what it holds."""

from __future__ import annotations

import contextlib
import functools
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from diagnosis import Explanation, Progress, explain
from diagnosis.discovery.pipeline import PIPELINE, discover
from diagnosis.discovery.stages.held_out_selection import held_out_selection
from diagnosis.discovery.stages.stepwise import stepwise
from diagnosis.discovery.state import State, until_still
from diagnosis.discovery.watch import Stopped, Watch, ended_by_budget, stopped_by_interrupt
from diagnosis.progress import Listener
from tests.diagnosis.discovery.sweeps import ONCE, Made, before, start_of, sweep_of
from twin.errors import UserError

TWO = Made(causes=(("saturation", 0.08), ("hysteresis", 0.08)), points=96, back=True)


@functools.cache
def unwatched() -> Explanation:
    """The answer that nobody listens to."""
    return explain(sweep_of(TWO))


def when(condition: Callable[[Progress], bool], act: Callable[[], None]) -> tuple[Listener, list[Progress]]:
    """A listener that acts once, as soon as the condition holds; and what it has heard."""
    heard: list[Progress] = []

    def listen(progress: Progress) -> None:
        acted = any(map(condition, heard))
        heard.append(progress)
        if condition(progress) and not acted:
            act()

    return listen, heard


def interrupt() -> None:
    """What Ctrl-C does."""
    signal.raise_signal(signal.SIGINT)


def stop() -> None:
    """What a listener does to end the search."""
    raise StopIteration


def one_is_held(progress: Progress) -> bool:
    return len(progress.causes) == 1


def test_every_stage_is_told_in_order_with_the_causes_held() -> None:
    heard: list[Progress] = []
    found = explain(sweep_of(TWO), progress=heard.append)
    told = list(dict.fromkeys(one.stage for one in heard))
    names = [stage.__name__ for stage in ONCE]
    assert [name for name in told if name in names] == names
    assert set(told) - set(names) == {"error_model", "search"}
    assert heard[0].causes == ()
    assert {name for name in heard[-1].causes if name != "noise"} == {cause.name for cause in found.causes}
    assert [one.elapsed_s for one in heard] == sorted(one.elapsed_s for one in heard)
    assert not any(one.stopped for one in heard)
    assert found.discovery.cut_short is None


def test_nobody_who_listens_changes_the_answer() -> None:
    assert explain(sweep_of(TWO), progress=lambda progress: None).to_dict() == unwatched().to_dict()


def test_nothing_is_printed_by_default(capsys: pytest.CaptureFixture[str]) -> None:
    explain(sweep_of(TWO))
    assert capsys.readouterr() == ("", "")


def stopped_with_one() -> Iterator[tuple[str, Explanation, list[Progress]]]:
    """The search ended when it held a single cause, in either way."""
    for way, act in (("answer", interrupt), ("raise", stop)):
        listen, heard = when(one_is_held, act)
        yield way, explain(sweep_of(TWO), progress=listen, on_interrupt=way), heard  # type: ignore[arg-type]


def test_what_a_stopped_search_holds_is_finished_and_proven() -> None:
    assert len(unwatched().causes) == 2
    for way, found, heard in stopped_with_one():
        assert found.discovery.cut_short == "stepwise", way
        (cause,) = found.causes
        assert cause.heldout_rms_deg_after < cause.heldout_rms_deg_before
        assert cause.false_alarm_probability < 0.01
        assert found.verdict == "partly explained"
        assert "noise" in found.extended.values
        # Whoever has stopped the search waits for the answer: rivals would take longer than all else.
        assert found.to_dict()["causes"][0]["rivals_sought"] is False
        assert "what else it may be was not looked for, as the search was stopped" in " ".join(found.summary().split())
        after = [one.stage for one in heard if one.stopped]
        # At once in the stage that is stopped, then as what it holds is finished.
        assert after == ["stepwise", *(stage.__name__ for stage in PIPELINE[PIPELINE.index(held_out_selection) :])]


def test_a_search_stopped_before_it_began_finds_nothing_and_is_not_adequate() -> None:
    listen, _ = when(lambda progress: progress.stage == "observe", stop)
    found = explain(sweep_of(TWO), progress=listen)
    assert found.causes == ()
    assert found.verdict == "stopped"
    assert found.discovery.cut_short == "observe"


def test_a_search_that_is_over_cannot_be_cut_short() -> None:
    listen, heard = when(lambda progress: progress.stage == "held_out_selection", interrupt)
    found = explain(sweep_of(TWO), progress=listen, on_interrupt="answer")
    assert found.discovery.cut_short is None
    assert found.verdict == "explained"
    assert any(one.stopped for one in heard)


def test_only_structure_without_a_name_stays_unnamed_when_stopped() -> None:
    made = Made(structure=("order_9_to_19", 0.1), points=96, turns=2)
    listen, _ = when(one_is_held, stop)
    found = explain(sweep_of(made), progress=listen)
    assert found.discovery.cut_short == "stepwise"
    assert found.verdict == "unnamed"


def test_a_second_interrupt_ends_at_once() -> None:
    listen, heard = when(one_is_held, interrupt)

    def again(progress: Progress) -> None:
        listen(progress)
        if progress.stopped:
            interrupt()

    with pytest.raises(KeyboardInterrupt):
        explain(sweep_of(TWO), progress=again, on_interrupt="answer")
    assert [one.stage for one in heard if one.stopped] == ["stepwise"]


def test_an_interrupt_raises_unless_the_answer_is_asked_for() -> None:
    listen, _ = when(one_is_held, interrupt)
    with pytest.raises(KeyboardInterrupt):
        explain(sweep_of(TWO), progress=listen)
    with pytest.raises(UserError, match="on_interrupt is 'stop'; expected 'raise' or 'answer'"):
        explain(sweep_of(TWO), on_interrupt="stop")  # type: ignore[arg-type]


def test_the_handler_is_put_back_and_an_ignored_interrupt_stays_ignored() -> None:
    handler = signal.getsignal(signal.SIGINT)
    explain(sweep_of(Made(points=72)), on_interrupt="answer")
    assert signal.getsignal(signal.SIGINT) is handler
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        watch = Watch()
        with stopped_by_interrupt(watch):
            os.kill(os.getpid(), signal.SIGINT)
        assert watch.stopped_in is None
    finally:
        signal.signal(signal.SIGINT, handler)


def test_in_a_thread_the_search_runs_as_ever() -> None:
    """Python lets only the main thread set a handler."""
    found: list[Explanation] = []
    thread = threading.Thread(
        target=lambda: found.append(explain(sweep_of(Made(points=72)), on_interrupt="answer")), daemon=True
    )
    thread.start()
    thread.join()
    assert found[0].verdict == "adequate"


def test_an_effect_that_catches_every_exception_does_not_keep_the_search_going() -> None:
    """Stopped from within a stage that swallows exceptions, the loop still ends, with the state it was told last."""
    watch = Watch()

    def stubborn(state: State) -> State:
        with contextlib.suppress(Exception):
            watch.stop()
        return state.with_(looked_at=99)

    start = start_of(TWO).with_(watch=watch)
    after = until_still(lambda state: state.with_(looked_at=1), stubborn)(start)
    assert after.looked_at == 1
    assert not issubclass(Stopped, Exception)


def test_an_effect_that_swallows_the_word_to_stop_keeps_the_search_going_no_longer_than_the_stage() -> None:
    watch = Watch()
    held: list[State] = []

    def stubborn(state: State) -> State:
        with contextlib.suppress(BaseException):
            watch.stop()
        held.append(state)
        watch.told("next", (), lambda: held[0])
        raise AssertionError("the search goes on")

    start = start_of(TWO)
    assert watch.until_stopped(stubborn, start) is start


def test_what_rests_on_a_trusted_radius_does_not_stand_when_stopped() -> None:
    """The search that trusts the radius is given up where it leaves some of it; stopped, it was never asked."""
    made = Made(causes=(("cardan_coupling", 0.1), ("saturation", 0.08)), points=96, turns=2, channels=True)
    listen, _ = when(one_is_held, stop)
    state = before(stepwise, made).with_(watch=Watch(listen))
    after = state.watch.until_stopped(stepwise, state)
    assert len(after.keys) == 1
    assert not after.fit.weighting.radius_trusted


def test_what_a_stopped_search_leaves_is_likened_behind_the_stairs_of_the_output() -> None:
    """On a coarse grid the noise ahead of it is known only once the cause is: it is smaller than what that makes."""
    made = Made(causes=(("saturation", 0.08), ("output_quantisation", 0.08)), points=120, turns=2)
    listen, heard = when(one_is_held, stop)
    found = explain(sweep_of(made), progress=listen)
    assert found.discovery.cut_short == "stepwise"
    assert any(one.stopped for one in heard)
    assert found.to_dict()["extended"]["likeness_p"] is not None


def test_a_pipeline_of_ones_own_is_watched_too() -> None:
    heard: list[Progress] = []

    def of_my_own(state: State) -> State:
        return state

    start = start_of(Made(points=72))
    discover(start.with_(watch=Watch(heard.append)), (*PIPELINE, of_my_own))
    assert heard[-1].stage == "of_my_own"


def compute(seconds: float) -> None:
    """Busy for so much computing time of this thread."""
    until_s = time.thread_time() + seconds
    while time.thread_time() < until_s:
        pass


def test_a_search_that_has_spent_its_budget_is_finished_and_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = 0.0
    monkeypatch.setattr(time, "thread_time", lambda: now_s)

    def spend() -> None:
        nonlocal now_s
        now_s = 61.0

    listen, heard = when(one_is_held, spend)
    found = explain(sweep_of(TWO), progress=listen, budget_s=60.0)
    cut = found.to_dict()["cut_short"]
    assert (cut["stage"], cut["by"]) == ("stepwise", "budget")
    (cause,) = found.causes
    assert cause.heldout_rms_deg_after < cause.heldout_rms_deg_before
    assert found.verdict == "partly explained"
    assert "its budget of computing time was spent (--budget, budget_s)" in " ".join(found.summary().split())
    # Nobody has asked for it, so nobody is told that the word was heard.
    assert not any(one.stopped for one in heard)


def test_a_budget_ends_a_stage_that_says_nothing() -> None:
    """A stage may compute for long without a word: the process' own timer looks, and the state told last is kept."""
    watch = Watch(budget_s=0.2)
    start = start_of(TWO)
    began_s = time.thread_time()

    def long(state: State) -> State:
        compute(60.0)
        raise AssertionError("the stage ran to its end")

    with ended_by_budget(watch):
        assert watch.until_stopped(long, start) is start
    assert watch.ended_by == "budget"
    # The timer of the process ticks every few milliseconds; a twentieth of the 60 s is far beyond any of them.
    assert time.thread_time() - began_s < 3.0
    assert signal.getsignal(signal.SIGPROF) is signal.SIG_DFL
    assert signal.getitimer(signal.ITIMER_PROF)[0] == 0.0


def test_a_budget_counts_what_its_own_thread_computes() -> None:
    """What another thread computes meanwhile sets off the timer of the process, and ends nothing."""
    busy = threading.Thread(target=lambda: compute(0.4), daemon=True)
    watch = Watch(budget_s=0.3)
    start = start_of(TWO)

    def waits(state: State) -> State:
        busy.start()
        busy.join()
        return state.with_(looked_at=99)

    with ended_by_budget(watch):
        assert watch.until_stopped(waits, start).looked_at == 99
    assert watch.ended_by is None


def test_a_budget_that_is_not_spent_changes_nothing() -> None:
    assert explain(sweep_of(TWO), budget_s=600.0).to_dict() == unwatched().to_dict()


@pytest.mark.parametrize("budget_s", [0.0, -1.0, float("nan"), "10", True])
def test_what_is_no_budget_is_refused(budget_s: object) -> None:
    with pytest.raises(UserError, match="expected a number of seconds of computing, above 0"):
        explain(sweep_of(TWO), budget_s=budget_s)  # type: ignore[arg-type]


@pytest.mark.parametrize("budget_s", [1e12, 10**400, float("inf"), np.int64(600)])
def test_a_budget_beyond_what_a_timer_takes_is_one(budget_s: float) -> None:
    assert explain(sweep_of(Made(points=72)), budget_s=budget_s).verdict == "adequate"
    assert signal.getsignal(signal.SIGPROF) is signal.SIG_DFL


def test_a_tick_as_the_timer_goes_does_not_set_it_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that has struck is handled just behind the call that disarms the timer."""
    disarmed = signal.setitimer

    def late(which: int, seconds: float) -> object:
        found = disarmed(which, seconds)
        handler = signal.getsignal(signal.SIGPROF)
        if seconds == 0.0 and callable(handler):
            handler(int(signal.SIGPROF), None)
        return found

    monkeypatch.setattr(signal, "setitimer", late)
    with ended_by_budget(Watch(budget_s=5.0)):
        pass
    assert signal.getitimer(signal.ITIMER_PROF)[0] == 0.0


def test_a_word_to_stop_after_the_budget_is_heard(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever presses Ctrl-C while a cut search is being proven wants no further sweep."""
    now_s = 0.0
    monkeypatch.setattr(time, "thread_time", lambda: now_s)

    def spend_then_interrupt(progress: Progress) -> None:
        nonlocal now_s
        if one_is_held(progress):
            now_s = 61.0
        if progress.stage == "held_out_selection" and not progress.stopped:
            interrupt()

    found = explain(sweep_of(TWO), progress=spend_then_interrupt, on_interrupt="answer", budget_s=60.0)
    assert found.to_dict()["cut_short"]["by"] == "interrupt"
