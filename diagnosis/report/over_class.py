"""Intervals of the factors over all that explains the readings as well, which have moved, and what is said of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from diagnosis.report.factor_names import LABELS
from diagnosis.report.wording import listed

Interval = tuple[float, float]
_MUCH = 2.0
"""An interval that is so many times wider over the class is told as a range, with what widens it."""


def over_class(named: Mapping[str, Any], others: Sequence[tuple[str, Mapping[str, Any]]]) -> dict[str, dict[str, Any]]:
    """The factors of the answer with 95 % intervals that hold those of every other explanation.

    Whichever of them is true, its own interval holds the true value with 95 %; so then does what spans them all. Of
    an effect that may stand beside the causes it is one for both, with it and without, by how likely each is.

    Parameters
    ----------
    named, others : mappings
        The factors as the answer's causes leave them, and by name with another cause in the place of one of these.

    Returns
    -------
    dict
        The factors; of one whose interval is wider than that of the causes named, this one as ``as_named`` and the
        names of the causes that widen it as ``open_by``.
    """
    found = {}
    for key, factor in named.items():
        own = (factor["low"], factor["high"])
        wider = [(name, (one[key]["low"], one[key]["high"])) for name, one in others]
        low, high = min([own[0], *(ends[0] for _, ends in wider)]), max([own[1], *(ends[1] for _, ends in wider)])
        names = dict.fromkeys(name for name, ends in wider if _much(own, ends))
        more = {"as_named": list(own), "open_by": list(names)} if (low, high) != own else {}
        found[key] = {**factor, "low": low, "high": high, **more}
    return found


def _much(own: Interval, ends: Interval) -> bool:
    """Whether an interval that spans both is much wider than one's own."""
    return max(own[1], ends[1]) - min(own[0], ends[0]) > _MUCH * (own[1] - own[0])


def moved(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[str]:
    """Factors that stand elsewhere once the causes are known: outside of the 95 % interval that they had before."""
    return [
        name
        for name, known in before.items()
        if known["low"] is not None
        and known["high"] is not None
        and not known["low"] <= after[name]["value"] <= known["high"]
        # A factor that the causes leave hardly known has not moved.
        and not _holds(after[name], known)
    ]


def _holds(wide: Mapping[str, Any], known: Mapping[str, Any]) -> bool:
    """Whether an interval holds another one whole; one without ends holds any."""
    if wide["low"] is None or wide["high"] is None:
        return True
    return bool(wide["low"] <= known["low"] and known["high"] <= wide["high"])


def open_words(answer: Mapping[str, Any]) -> str:
    """Which factors are told as ranges, and what would put them elsewhere there; empty where none are."""
    rivals = {name for cause in answer["causes"] for name in cause.get("indistinguishable_from", ())}
    groups: dict[str, list[str]] = {}
    for key, factor in answer["extended"]["parameters"].items():
        names = factor.get("open_by", ())
        in_place, beside = [name for name in names if name in rivals], [name for name in names if name not in rivals]
        ways = [f"{listed(in_place, 'or')} in its cause's place"] if in_place else []
        ways += [f"{listed(beside, 'or')} beside"] if beside else []
        if ways:
            groups.setdefault(" or ".join(ways), []).append(LABELS[key])
    said = [f"{ways} may put {listed(factors)} anywhere there" for ways, factors in groups.items()]
    return f"Ranges: {'; '.join(said)}" if said else ""


def in_factors_words(answer: Mapping[str, Any]) -> str:
    """Which causes stand in the factors, as an angle never tells them apart; empty where there are none."""
    names = answer["in_factors"]
    return f"What {listed(names, 'or')} may do to the angle stands in the factors above" if names else ""
