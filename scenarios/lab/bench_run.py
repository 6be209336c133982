"""The closed loop that the page has asked for, with its curves as they build up."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenarios.lab.bench_worker import Loop, work
from scenarios.lab.process_job import ProcessJob
from twin.errors import UserError
from twin.limits import require_within
from twin.shown import shown

SEED, USUAL_POINTS, MOST_POINTS = 0, 360, 3600
_MOST_HIDDEN, _LONGEST = 8, 200


class BenchRun(ProcessJob):
    """One loop at a time."""

    def __init__(self) -> None:
        super().__init__(work)
        self._curves: dict[str, Any] = {}
        self._said: list[str] = []

    def _begun(self, question: Any) -> None:
        self._curves, self._said = {}, []

    def _heard(self, kind: str, found: Any) -> None:
        if kind == "curve":
            self._curves[found["part"]] = found
            done = f"{len(found['at_deg'])} of {found['total']} readings"
            self._words = f"measuring {'again, corrected' if found['part'] == 'after' else 'as it is'}: {done}"
            if found["part"] == "before" and len(found["at_deg"]) == found["total"]:
                self._words = "explaining what was measured"
        elif kind == "said":
            self._said.append(found)
        else:
            super()._heard(kind, found)

    def _more(self) -> dict[str, Any]:
        # Files lie in a folder that goes with the page: which ones is no news.
        said = [words for words in self._said if not words.startswith("wrote ")]
        return {"curves": self._curves, "said": said}


def loop_of(content: Any, *, twin: tuple[str, str], folder: Path) -> Loop:
    """The loop that the page asks for; ``twin``: where it is read from, and how a command line names it.

    Raises UserError.
    """
    if not isinstance(content, Mapping) or set(content) != {"hide", "points"}:
        raise UserError(f"a loop is {shown(content)}; expected hide, points")
    hide, points = content["hide"], content["points"]
    texts = isinstance(hide, list) and all(isinstance(one, str) and 0 < len(one) <= _LONGEST for one in hide)
    if not texts or len(hide) > _MOST_HIDDEN:
        raise UserError(f"hide is {shown(hide)}; expected up to {_MOST_HIDDEN} texts, e.g. saturation:k_percent=2")
    if isinstance(points, bool) or not isinstance(points, int):
        raise UserError(f"points is {shown(points)}; expected a whole number")
    require_within("points", points, 8, MOST_POINTS, whole=True)
    source, name = twin
    words = ["halltwin", "bench", "--closed-loop", "--twin", name]
    words += [word for one in hide for word in ("--hide", one)]
    words += [] if points == USUAL_POINTS else ["--points", str(points)]
    return Loop(
        twin=source,
        hide=tuple(hide),
        points=points,
        seed=SEED,
        command=shlex.join([*words, "--seed", str(SEED)]),
        folder=folder,
    )
