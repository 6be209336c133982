"""A short run of ``python -m tests.fuzz``: inputs broken at random end in an answer or in one line."""

from __future__ import annotations

import functools
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.fuzz.batch import Failure, batch, plain_mb
from tests.fuzz.calls import content
from tests.fuzz.trial import ANSWERED, FAILED, REFUSED, Ended, MemoryWatch, peak_mb, tried
from twin.errors import UserError

SHORT = {
    "sweeps": range(100),
    "explain": range(4),
    "doctor": range(60),
    "export": range(2),
    "twins": range(100),
    "logs": range(20),
    "options": range(8),
}
SEED = 13


def _in_a_process(call: Callable[..., Any], *given: Any, **named: Any) -> Any:
    """What a call returns in a fresh process, whose memory is not that of the tests before it."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(call, *given, **named).result()


@functools.cache
def plain_run_mb() -> float:
    """What a plain run takes, asked for once."""
    return float(_in_a_process(plain_mb))


@pytest.mark.parametrize("kind", SHORT)
def test_whatever_is_handed_in_is_answered_or_refused_in_one_line(kind: str) -> None:
    if kind == "logs":
        pytest.importorskip("can")
        pytest.importorskip("cantools")
    how, failures = _in_a_process(batch, kind, SHORT[kind], seed=SEED, plain=plain_run_mb())
    assert [(one.number, one.said[-500:]) for one in failures] == []
    # A bank of inputs that are all refused at the door would try the door alone.
    assert ANSWERED in how
    assert kind in ("explain", "export") or REFUSED in how or kind == "options"


def test_inputs_are_the_same_for_the_same_seed() -> None:
    for kind in ("sweeps", "twins"):
        first = [content(kind, number, SEED) for number in range(20)]
        assert first == [content(kind, number, SEED) for number in range(20)]
        assert len(set(first)) > 15
        assert first[7] != content(kind, 7, SEED + 1)


def _raise(error: BaseException) -> None:
    raise error


def _spin() -> None:
    while True:
        pass


def test_what_is_neither_is_a_failure() -> None:
    assert tried(lambda: None) == Ended(ANSWERED)
    assert tried(lambda: _raise(UserError("no"))) == Ended(REFUSED, "no")
    for error in (ValueError("no"), SystemExit(0), MemoryError(), RecursionError(), UserError("x" * 10_000)):
        assert tried(lambda error=error: _raise(error)).how == FAILED
    late = tried(_spin, seconds=0.2)
    assert late.how == FAILED
    assert "took more than 0.2 s" in late.said


def test_memory_beyond_ten_times_a_plain_run_is_a_failure() -> None:
    assert MemoryWatch(plain_mb=1.0).judged(Ended(ANSWERED)).how == FAILED
    assert MemoryWatch(plain_mb=1e6).judged(Ended(ANSWERED)).how == ANSWERED


def blown_up() -> str:
    """How a trial is judged before and after the process has doubled, from eight times a plain run's memory."""
    watch = MemoryWatch(plain_mb=peak_mb() / 8.0)
    calm = watch.judged(Ended(ANSWERED)).how
    much = np.ones(int(8.0 * watch.plain_mb) << 17)
    return f"{calm} {watch.judged(Ended(ANSWERED)).how} {much.size > 0}"


def test_memory_is_that_of_the_process_and_a_blow_up_is_a_failure() -> None:
    """Whatever the process that starts it has held."""
    large = np.ones(2**25)
    assert _in_a_process(blown_up) == f"{ANSWERED} {FAILED} True"
    assert large.size > 0


def test_an_input_that_fails_is_kept(tmp_path: Path) -> None:
    kept = Failure("sweeps", 7, "Traceback\nValueError: no", ".csv", b"1,2\n").keep(tmp_path / "failures")
    assert kept.name == "sweeps_000007.csv"
    assert kept.read_bytes() == b"1,2\n"
    assert "ValueError" in kept.with_name("sweeps_000007.csv.said").read_text()
