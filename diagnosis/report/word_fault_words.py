"""Faults of the words of a link in sentences: what they do, what sends the same words, how far these were off."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from diagnosis.report.wording import parameter_line, plain, with_unit
from twin.catalogue import CATALOGUE


def instance_line(name: str, parameters: Mapping[str, Any]) -> str:
    """One instance of a cause on one line: as a sentence where its effect has one, else its parameters."""
    ways = (effect.in_words for effect in CATALOGUE if effect.name == name and effect.footprint == "sequence")
    way = next(ways, None)
    if way is None or way.line is None:
        return parameter_line(parameters)
    values = {key: one["value"] for key, one in parameters.items()}
    return way.line(values, {key: with_unit(one) for key, one in parameters.items()})


def as_sent_words(baseline: Mapping[str, Any]) -> tuple[str, str]:
    """What the words as sent err by, and that the figure beside is of the decoded ones; empty where none is."""
    rms = baseline.get("as_sent_error_rms_deg")
    if rms is None:
        return "", ""
    return f". Before the decoding the words as sent err by {plain(rms)} deg RMS", " of the decoded readings"


def same_words(cause: Mapping[str, Any]) -> list[str]:
    """What sends the very same words as a cause, each with what it would mean for the zero and the factors."""
    return [
        f"{one['what']}, which sends the very same words: the zero would then be about {_by(one['zero_by_deg'])}, and "
        "the offset, the gain ratio and the phase, which are counted from it, others too"
        for one in cause.get("same_words", ())
    ]


def _by(deg: float) -> str:
    return f"{plain(abs(deg))} deg {'larger' if deg > 0.0 else 'smaller'}"
