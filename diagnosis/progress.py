"""What a long call tells of itself while it runs: where it stands, for a ``progress=`` of the caller's."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias, TypeVar


@dataclass(frozen=True)
class Progress:
    """Where a call stands.

    Attributes
    ----------
    stage : str
        Name of the step that runs: a stage of the discovery, ``"search"`` where its loop begins, ``"error_model"``,
        ``"estimated_motion"`` where a log has no reference; of several sweeps ``"reading"``, ``"error_model"`` and
        ``"judging"``.
    elapsed_s : float
        Seconds since the call began.
    causes : tuple of str
        The causes held so far, not yet proven; empty where none is looked for.
    done, total : int
        Sweeps that the step has dealt with, and sweeps in all; 0 where there is but one.
    stopped : bool
        Whether the search was stopped, and what it holds is being finished.
    """

    stage: str
    elapsed_s: float
    causes: tuple[str, ...] = ()
    done: int = 0
    total: int = 0
    stopped: bool = False


Listener: TypeAlias = Callable[[Progress], object]
"""What is called with each :class:`Progress`; what it returns is not looked at."""
_T = TypeVar("_T")


class Count:
    """Tells a listener how many of so many sweeps a step has dealt with."""

    def __init__(self, total: int, listener: Listener | None = None) -> None:
        self._total, self._listener = total, listener
        self._began_s = time.monotonic()

    def of(self, stage: str, done: int, what: _T) -> _T:
        """What is handed in, once the listener has heard that so many are done."""
        if self._listener is not None:
            self._listener(Progress(stage, time.monotonic() - self._began_s, done=done, total=self._total))
        return what
