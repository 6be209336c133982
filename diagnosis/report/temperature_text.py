"""The laws of the factors over temperature as a person reads them, from the JSON's values alone."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from typing import Any

from diagnosis.report.factor_names import LABELS, SCALES, UNITS
from diagnosis.report.temperature_answer import POWERS
from diagnosis.report.wording import figure, plain

_LONG_GAP_K = 65.0
"""Wider apart than cold, room and hot of a usual part, -40, 25 and 85 C, readings leave the law between open."""
_VERDICTS = ("sensitive", "immune", "not told")


def lines(answer: Mapping[str, Any], width: int) -> list[str]:
    """The table of the laws, and what stands behind it in sentences, in lines of at most this many characters."""
    return [*_wrapped(_head(answer), width), *_table(answer, width), *_listed(sentences(answer), width)]


def _head(answer: Mapping[str, Any]) -> str:
    count = len(answer["levels_c"])
    levels = ", ".join(f"{level:.0f}" for level in answer["levels_c"])
    at = f"{count} levels, {levels} C" if count > 1 else "no two of them apart"
    return (
        f"temperature {answer['low_c']:.1f} .. {answer['high_c']:.1f} C ({at}), {answer['readings']} readings, "
        f"noise floor {plain(answer['noise_floor_deg'])} deg"
    )


def _table(answer: Mapping[str, Any], width: int) -> list[str]:
    """One line a factor: verdict, value at 25 C, coefficients, and by how much it moves the angle over the span.

    The coefficient of the square stands below that of the temperature.
    """
    rows = [["", "", f"at {answer['from_c']:g} C", "per kelvin", "moves, deg"]]
    for key, law in answer["factors"].items():
        named = f"{LABELS[key]}, {UNITS[key]}" if UNITS[key] else LABELS[key]
        first, *others = [" ".join(figure(law[name], SCALES[key])) for name in POWERS if name in law] or [""]
        moves = plain(law["drift_deg"], 2) if law["verdict"] == "sensitive" else _below(law["drift_below_deg"])
        at_25 = " ".join(figure(law["at_25"], SCALES[key]))
        rows.append([named, law["verdict"], at_25, first, moves if first else ""])
        rows += [["", "", "per kelvin squared", other, ""] for other in others if law["verdict"] == "sensitive"]
    sizes = [max(map(len, column)) for column in zip(*rows, strict=True)]
    gap = "  " if sum(sizes) + 2 * (len(sizes) - 1) <= width else " "
    return [gap.join(f"{cell:{size}}" for cell, size in zip(row, sizes, strict=True)).rstrip() for row in rows]


def _below(limit: float | None) -> str:
    return "" if limit is None else f"< {plain(limit, 2)}"


def sentences(answer: Mapping[str, Any]) -> list[str]:
    """Which factors are sensitive and which immune, and what the laws rest on."""
    factors = answer["factors"]
    by = {word: [LABELS[key] for key, law in factors.items() if law["verdict"] == word] for word in _VERDICTS}
    said = ["; ".join(f"{word}: {', '.join(names)}" for word, names in by.items() if names)]
    if answer["highest_power"] == 0:
        said.append("no second temperature has readings all round the turn: no factor's law can be told")
    if answer["own_zeros"]:
        said.append("the reference was set anew on the way: what the zero does with temperature cannot be told")
    if not answer["low_c"] <= answer["from_c"] <= answer["high_c"]:
        said.append(f"no reading was taken about {answer['from_c']:g} C: the values there are those of the laws")
    cold, warm = answer["widest_gap_c"]
    if warm - cold > _LONG_GAP_K:
        said.append(f"no reading was taken between {cold:.0f} and {warm:.0f} C: there the laws are an interpolation")
    bent = [LABELS[key] for key, law in factors.items() if law["verdict"] == "sensitive" and POWERS[1] in law]
    if bent and len(answer["levels_c"]) <= answer["highest_power"] + 1:
        said.append(
            f"{', '.join(bent)}: the law goes through all {len(answer['levels_c'])} temperatures, so that none is left "
            "to test it; measure at one more"
        )
    scattered = [LABELS[key] for key, law in factors.items() if law["scatters"]]
    if scattered:
        said.append(
            f"{', '.join(scattered)}: the values stand farther from any law than their noise allows; the intervals "
            "follow that scatter"
        )
    if not answer["senses"]["decided"]:
        said.append(
            "which way the output counts is open: counted the other way offset y, phase and zero have the opposite "
            "sign, at 25 C and per kelvin, and all else stays; vx and vy decide, or halltwin diagnose with --twin or "
            "--output-sense"
        )
    if answer["recordings"] > 1:
        said.append(
            f"all {answer['recordings']} sweeps count as recordings of one sensor; a mount that was touched between "
            "them looks like temperature"
        )
    return said


def _wrapped(words: str, width: int, indent: int = 2) -> list[str]:
    return textwrap.wrap(words, width, subsequent_indent=" " * indent, break_long_words=False, break_on_hyphens=False)


def _listed(said: Iterable[str], width: int) -> list[str]:
    return [line for sentence in said for line in _wrapped(f"- {sentence}", width)]
