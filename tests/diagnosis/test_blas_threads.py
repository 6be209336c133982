"""Linear algebra on one thread while a diagnosis runs, and afterwards on as many as before."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from diagnosis import diagnose_many, explain
from diagnosis.blas_threads import one_blas_thread
from twin.chain import Chain
from twin.motion import Motion
from twin.sweep import Sweep


def threads() -> set[int]:
    """The numbers of threads that the loaded BLAS libraries use."""
    return {library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas"}


@pytest.fixture(autouse=True)
def two_threads() -> Iterator[None]:
    """As many as a user's Python may have set."""
    import scipy.special  # noqa: F401  (with it SciPy's own BLAS is loaded)

    with threadpool_limits(2, user_api="blas"):
        assert threads() == {2}
        yield


def test_one_thread_within_and_as_many_as_before_afterwards() -> None:
    with one_blas_thread():
        assert threads() == {1}
    assert threads() == {2}


def test_an_error_within_restores_them_too() -> None:
    with pytest.raises(RuntimeError), one_blas_thread():
        raise RuntimeError
    assert threads() == {2}


def test_calls_that_overlap_keep_one_thread_until_the_last_ends() -> None:
    """As two threads of Python have it: the first call ends while the second is still at work."""
    first, second = ExitStack(), ExitStack()
    first.enter_context(one_blas_thread())
    second.enter_context(one_blas_thread())
    first.close()
    assert threads() == {1}
    second.close()
    assert threads() == {2}


@pytest.mark.parametrize(
    ("call", "inner"),
    [
        (lambda sweep: explain(sweep), "diagnosis.discovery.pipeline.discover"),
        (lambda sweep: diagnose_many([sweep]), "diagnosis.factors.findings.quantify_many"),
    ],
    ids=["explain", "diagnose"],
)
def test_the_public_calls_work_on_one_thread(
    call: Callable[[Sweep], Any], inner: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    within: list[set[int]] = []

    def probe(*_: Any, **__: Any) -> list[Any]:
        within.append(threads())
        return []

    monkeypatch.setattr(inner, probe)
    # The probe gives back nothing of any sweep, with which no answer can be made.
    with contextlib.suppress(ValueError, AttributeError):
        call(Chain().simulate(Motion.from_angle(np.radians(np.arange(0.0, 360.0, 10.0)))))
    assert within == [{1}]
    assert threads() == {2}


def test_an_answer_does_not_depend_on_what_the_caller_has_numpy_do_about_underflow() -> None:
    motion = Motion.from_angle(np.linspace(0.0, 12.0, 96))
    sweep = Chain().with_effect("saturation", k_percent=0.8).with_effect("noise", rms_deg=0.02).simulate(motion, seed=1)
    calm = explain(sweep).to_dict()
    with np.errstate(all="raise"):
        assert explain(sweep).to_dict() == calm
