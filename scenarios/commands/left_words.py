"""What a correction leaves, in words."""

from __future__ import annotations

from collections.abc import Iterator

from diagnosis.correction.left_of_readings import ELSE
from diagnosis.correction.not_removed import NotRemoved
from diagnosis.report.wording import plain

_DIGITS = 2


def left_words(left: NotRemoved) -> str:
    """One thing that stays, in words."""
    causes = f" ({', '.join(left.causes)})" if left.causes not in ((), (left.what,)) else ""
    sizes = list(_sizes(left))
    what = "all else" if left.what == ELSE else left.what
    return f"{what}{causes}{': ' if sizes else ''}{', '.join(sizes)}{f', {left.at}' if left.at else ''}"


def _sizes(left: NotRemoved) -> Iterator[str]:
    if left.rms_deg is not None:
        yield f"{plain(left.rms_deg, _DIGITS)} deg RMS"
    if left.largest_deg is not None:
        yield f"{plain(left.largest_deg, _DIGITS)} deg at most"
